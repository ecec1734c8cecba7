"""ψ: Pick and Place, their parameters k and the samplers that draw them."""
