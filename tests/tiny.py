"""A tiny objective and agent for tests of the trainer; a training step takes a millisecond."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import torch
from torch import nn

from mitigate.training.objective import Objective, split_arguments
from mitigate.training.trainer import Trainer


class TinyAgent(nn.Module):
    """A network with dropout, so that its output depends on random state. Its layer ``frozen`` must
    not change."""

    def __init__(self, width: int = 8) -> None:
        super().__init__()
        self.body = nn.Sequential(nn.Linear(4, width), nn.Dropout(0.5), nn.Linear(width, 1))
        self.frozen = nn.Linear(4, 4)


class TinyRecipe(Objective):
    """A regression with random inputs from the global generator.

    ``count`` is an example of state that is not a tensor.
    """

    def __init__(self, agent: nn.Module | None = None, *, bad_step: int = -1, pause: float = 0.0):
        super().__init__()
        self.agent = agent or TinyAgent()
        self.agent.frozen.requires_grad_(False)
        self.count, self.bad_step, self.pause = 0, bad_step, pause

    def batch(self, step: int) -> dict:
        if self.pause:
            time.sleep(self.pause)
        inputs = torch.randn(8, 4)
        if step == self.bad_step:
            inputs[0, 0] = float("nan")
        return {"inputs": inputs, "episode_ids": [f"episode-{step}"]}

    def forward(self, batch: dict) -> dict:
        self.count += self.training
        error = self.agent.body(batch["inputs"]) - batch["inputs"].sum(1, keepdim=True)
        return {"loss": error.square().mean(), "error": error.abs().mean()}

    def evaluate(self, step: int) -> dict:
        return {"weight": float(torch.rand(()))}  # deliberately consumes global random numbers

    def figures(self, step: int) -> dict:
        return {"noise": torch.randint(0, 255, (8, 8, 3), dtype=torch.uint8).numpy()}

    def get_extra_state(self) -> dict:
        return {"count": self.count}

    def set_extra_state(self, state: dict) -> None:
        self.count = state["count"]


def assemble(kind: type[Objective], agent: Any, **arguments: Any) -> Any:
    """Build an objective and its data source; each gets its own part of the arguments, as in a
    recipe.
    """
    parameter = next((name for name in kind.sources if name not in arguments), "")
    own_value, others = split_arguments(kind, parameter, arguments, kind.__qualname__)
    if parameter:
        own_value[parameter] = kind.sources[parameter](agent=agent, **others)
    return kind(agent=agent, **own_value)


def fit(objective: Any, folder: Path, steps: int, *, stop: int | None = None, lr: float) -> Any:
    """Train on the CPU in fp32, save at every step, and return the agent.

    With ``stop``, training ends after this step, as if it was interrupted.
    """
    trainer = Trainer(
        objective, steps=steps, folder=folder, lr=lr, device="cpu", precision="fp32", save_every=1
    )
    trainer.steps = stop or steps
    trainer.fit()
    return objective.agent.eval()
