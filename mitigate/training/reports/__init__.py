"""What a training ends with: the trained model, measured before and after."""
