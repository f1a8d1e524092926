"""Data and tools of the text safeguard: train the classifier, measure a safeguard."""
