"""The networks' view of a configuration and an action, without Drake."""
