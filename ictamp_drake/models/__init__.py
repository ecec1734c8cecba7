"""Robot, supports and boxes: SDF files written by `python -m tools.panda.write`, and their constants."""
