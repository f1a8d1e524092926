"""Agent that searches for an object with a frontier map, after VLFM and L3MVN."""

from mitigate.agents.frontier.agent import FrontierAgent

__all__ = ["FrontierAgent"]
