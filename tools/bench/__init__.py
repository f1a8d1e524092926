"""Benchmarks of corruptions, training, evaluation, renderer and bridge, and of memory growth."""
