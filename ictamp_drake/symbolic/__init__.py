"""Symbolic planning: the PDDL domain grounded for a scene, goals, and streams of high-level plans."""
