"""An agent with one forward camera and a memory, after VLN-CE's cross-modal attention agent."""

from mitigate.agents.recurrent.agent import RecurrentAgent

__all__ = ["RecurrentAgent"]
