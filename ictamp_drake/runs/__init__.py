"""What every program does: options, one problem solved, a sweep over many, and the folder that a run leaves."""
