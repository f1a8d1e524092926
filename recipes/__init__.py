"""Training methods, with one file per method. ``README.md`` lists them."""
