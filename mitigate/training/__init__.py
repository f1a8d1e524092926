"""The trainer, its interface for objectives, and the program of ``mitigate train``."""
