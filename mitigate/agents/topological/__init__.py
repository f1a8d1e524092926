"""The reference agent: ETPNav's structure, small."""

from mitigate.agents.topological.agent import TopologicalAgent

__all__ = ["TopologicalAgent"]
