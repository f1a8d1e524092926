"""What all packages share: observations, files, seeds, checkpoints, processes."""
