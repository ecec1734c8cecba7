"""Types, protocols, failures, errors and seeds that every other room may import."""
