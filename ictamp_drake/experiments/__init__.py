"""Programs that reproduce the experiments of the paper."""
