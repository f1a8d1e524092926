"""Language models for the safeguard, from a folder, a package or an endpoint."""
