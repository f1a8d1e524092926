"""Corruptions of three authors who did not know the training augmentations of mitigate."""
