"""Pictures of scenes, searches and plans."""
