"""Environments: the embedded ``apartments`` world and the field's episode files."""
