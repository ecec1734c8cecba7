"""Task and motion planning on Drake with an infinite completion tree and learned skills."""
