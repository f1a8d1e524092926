"""The reference agent: a small agent with the structure of ETPNav."""

from mitigate.agents.topological.agent import TopologicalAgent

__all__ = ["TopologicalAgent"]
