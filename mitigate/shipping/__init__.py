"""Hardened checkpoints: exported, described, checked and loaded."""
