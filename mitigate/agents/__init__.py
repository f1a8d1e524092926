"""Agents: modules with ``reset`` and ``act``; the reference one is ``topological``."""
