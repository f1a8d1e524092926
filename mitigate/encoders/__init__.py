"""Encoders of users: loading them, frames to train on, measuring their features, adapters."""
