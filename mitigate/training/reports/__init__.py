"""Reports at the end of training, which compare the model before and after training."""
