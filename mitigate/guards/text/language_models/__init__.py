"""Language models for the safeguard, which come from a folder, a package or an endpoint."""
