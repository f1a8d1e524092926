"""Training data of the safeguard: routes, texts in many styles, attacks and pairs of these."""
