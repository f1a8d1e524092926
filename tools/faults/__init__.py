"""Faults: ``python -m tools.faults``."""
