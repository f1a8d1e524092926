"""Corrupt, mitigate, measure and ship hardened navigation agents."""
