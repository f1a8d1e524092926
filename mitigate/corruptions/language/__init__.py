"""English language rules for the instruction corruptions and their fidelity gate."""
