"""Data and tools of the text safeguard, for training the classifier and measuring a safeguard."""
