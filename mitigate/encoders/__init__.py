"""Load users' encoders, read frames for their training, measure features, and save adapters."""
