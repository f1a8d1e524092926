"""What things cost and whether they grow: corruptions beside their peers, training, evaluation, the
renderer, the bridge, one process and two, an hour under load."""
