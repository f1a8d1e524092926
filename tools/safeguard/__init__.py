"""Data and tools for training the classifier of the text safeguard, and for measuring a
safeguard.
"""
