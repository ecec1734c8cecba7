"""Scripts that write the committed model files of the LBR iiwa 14 and the WSG 50. They are not installed."""
