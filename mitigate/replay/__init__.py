"""Agents on recorded drives: what they would decide, and what a corruption changes of it."""
