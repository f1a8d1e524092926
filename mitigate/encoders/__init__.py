"""Encoders that are not ours: loading, frames, the measurement of their features, adapters."""
