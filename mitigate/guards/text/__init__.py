"""The safeguard, which converts a corrupted instruction to a plain one before an episode."""
