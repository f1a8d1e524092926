"""Agent with one forward camera and a recurrent memory, like VLN-CE's cross-modal agent."""

from mitigate.agents.recurrent.agent import RecurrentAgent

__all__ = ["RecurrentAgent"]
