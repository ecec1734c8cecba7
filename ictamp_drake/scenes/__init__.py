"""Scenes as YAML files, and the packing problems of each level."""
