"""What in an instruction is no part of a route: its pieces, and how probably each is foreign."""
