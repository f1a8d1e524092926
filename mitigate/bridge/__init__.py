"""Agents of other projects, unchanged, under the suite: ``mitigate run -- COMMAND``."""
