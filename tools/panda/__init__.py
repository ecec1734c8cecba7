"""Scripts that write the committed model files of the Panda. They are not installed."""
