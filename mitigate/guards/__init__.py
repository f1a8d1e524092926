"""Guards, which change the instruction and the frames that an agent receives at run time."""
