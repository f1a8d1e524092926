"""Jobs on this machine, on a Ray cluster or under SLURM; the engines are theirs."""
