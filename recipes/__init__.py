"""Training methods, one file each; ``README.md`` is the menu."""
