"""The library itself: a scene, how it is solved, and the plan."""
