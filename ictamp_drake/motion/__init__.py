"""Inverse kinematics, collision checks, trajectories and paths of the arm."""
