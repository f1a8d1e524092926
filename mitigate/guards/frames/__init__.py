"""Guards for frames, which estimate the clean frame before an agent reads it."""
