"""Robots: their files and models, the kinematics of their arms, and the measures and forces of their hands."""
