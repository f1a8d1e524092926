"""The trainer, the interface of objectives, and the command ``mitigate train``."""
