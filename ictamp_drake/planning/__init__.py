"""The search: an infinite completion tree, rules that choose in it, and the loop that runs them. No Drake, no torch."""
