"""What networks see of a configuration and an action; without Drake."""
