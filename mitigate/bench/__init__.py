"""What things cost: the corruptions beside their peers, their share of training, the renderer."""
