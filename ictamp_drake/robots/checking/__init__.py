"""Checks of a robot file against its models: everything that is wrong with it, and measures of the robot."""
