"""Guards for frames. They replace a corrupted frame by an estimate of the clean frame."""
