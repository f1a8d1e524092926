"""Reports at the end of training, which measure the model before and after."""
