"""Worlds: the interface, episode files, the generated apartments, and wrappers for other
environments.
"""
