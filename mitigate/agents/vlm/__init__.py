"""Vision-language agents: a local model with LoRA, and a model behind an HTTP endpoint."""

from mitigate.agents.vlm.agent import VLMAgent
from mitigate.agents.vlm.remote import RemoteAgent

__all__ = ["RemoteAgent", "VLMAgent"]
