"""Scenes as YAML files, and the packing problems of the three levels."""
