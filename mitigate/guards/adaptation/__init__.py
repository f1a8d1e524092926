"""Guards that adapt an agent to the frames of its episode: test-time adaptation."""
