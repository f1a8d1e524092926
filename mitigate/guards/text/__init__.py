"""The safeguard, which repairs a corrupted instruction before the episode starts."""
