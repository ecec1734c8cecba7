"""Scripts that make the committed model files of the Panda; they are not installed."""
