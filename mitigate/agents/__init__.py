"""Agents: modules with ``reset``, ``needs_frames`` and ``act``; the reference one is ``topological``."""
