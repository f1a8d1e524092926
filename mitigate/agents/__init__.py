"""Navigation agents with the methods ``reset`` and ``act``; ``topological`` is the reference."""
