"""Language models behind the safeguard: weights on disk, of packages, and behind an endpoint."""
