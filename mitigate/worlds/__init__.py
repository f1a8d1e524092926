"""Worlds: the contract, episode files, the embedded apartments, and the bridges to others."""
