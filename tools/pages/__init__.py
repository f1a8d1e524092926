"""Generators of documentation pages and their pictures."""
