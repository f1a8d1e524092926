"""Guards for frames. Such a guard replaces a corrupted frame by an estimate of the clean frame."""
