"""Code that all packages use: observations, files, seeds, checkpoints and processes."""
