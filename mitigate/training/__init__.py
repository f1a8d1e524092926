"""The trainer, what it asks of a recipe, and the run of ``mitigate train``."""
