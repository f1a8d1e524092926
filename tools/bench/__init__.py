"""Benchmarks: time of corruptions, training, evaluation, renderer and bridge; growth of memory."""
