"""Training data of the safeguard: routes, texts in many styles, attacks, and training pairs."""
