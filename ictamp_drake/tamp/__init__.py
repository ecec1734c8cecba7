"""The library itself: tasks, the method that solves them, and plans."""
