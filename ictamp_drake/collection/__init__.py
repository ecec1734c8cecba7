"""Data for learning: walks through scenes and the shards that they fill."""
