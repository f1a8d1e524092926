"""Language models for the safeguard. They come from a folder, a package or an endpoint."""
