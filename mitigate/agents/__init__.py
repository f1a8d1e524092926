"""Navigation agents, which have ``reset`` and ``act``; the reference agent is ``topological``."""
