"""Guards for frames: estimate the clean frame of a corrupted camera, before any agent reads it."""
