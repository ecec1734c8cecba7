"""Scripts that write the committed model files of the KUKA LBR iiwa 14 and the Schunk WSG 50. They are not installed."""
