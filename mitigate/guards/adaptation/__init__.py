"""Guards for test-time adaptation, which adapt an agent to the frames of the current episode."""
