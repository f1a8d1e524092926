"""Guards between a world and an agent: they change what an agent hears and sees at run time."""
