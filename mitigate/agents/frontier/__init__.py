"""An agent that searches for an object on a map of frontiers, after VLFM and L3MVN."""

from mitigate.agents.frontier.agent import FrontierAgent

__all__ = ["FrontierAgent"]
