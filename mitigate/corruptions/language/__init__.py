"""English language rules for corrupting instructions and checking rewrites."""
