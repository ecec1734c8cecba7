"""Robots, supports and boxes: SDF files written by `python -m tools.write`, and their constants."""
