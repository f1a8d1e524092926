"""Run jobs on this machine, on a Ray cluster or under SLURM."""
