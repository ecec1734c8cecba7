"""Common parts of all programs: options, solving one problem, sweeps over many, and the folder of a run."""
