"""What the networks and the rules learn from: routes, voices, attacks and lessons made of them."""
