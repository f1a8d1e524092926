"""What the instruction families and their fidelity gate know about English."""
