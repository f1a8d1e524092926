"""Evaluate agents: result rows, metrics, paired bootstrap intervals and reports."""
