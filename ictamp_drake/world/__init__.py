"""The scene in Drake: plants, conversion between c and Context, physics, predicates and H."""
