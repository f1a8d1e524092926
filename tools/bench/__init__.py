"""Benchmarks of corruptions, training, evaluation and the renderer."""
