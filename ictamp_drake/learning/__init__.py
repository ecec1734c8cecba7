"""Networks, data, checkpoints and training: torch, and no robot."""
