"""The safeguard: what turns a corrupted instruction back into a plain one before an episode."""
