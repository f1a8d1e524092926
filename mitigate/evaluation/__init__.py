"""Evaluation: result rows, metrics, paired bootstrap intervals and the report."""
