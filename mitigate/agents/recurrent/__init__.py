"""Agent with one forward camera and a recurrent memory, modelled on VLN-CE's cross-modal attention."""

from mitigate.agents.recurrent.agent import RecurrentAgent

__all__ = ["RecurrentAgent"]
