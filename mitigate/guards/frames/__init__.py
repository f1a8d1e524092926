"""Frames restored in front of any agent: what a corrupted camera shows, as a clean one would."""
