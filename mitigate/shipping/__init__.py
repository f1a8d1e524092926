"""Export, describe, check and load hardened checkpoints."""
