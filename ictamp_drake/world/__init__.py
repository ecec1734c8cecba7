"""The scene in Drake: plants, c <-> Context, physics, predicates and H."""
