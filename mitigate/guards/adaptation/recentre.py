"""``adapt=recentre``: shift features back to the mean that they have on clean frames.

A corruption shifts the mean of features. Before the evaluation, this guard measures the mean on
clean frames. During an episode, it estimates the current mean, and subtracts the difference between
the two means from the features. The method needs no normalisation layers and no gradients.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

import torch
from torch import Tensor, nn

from mitigate.agents.agent import as_agent
from mitigate.agents.networks import in_eval_mode
from mitigate.agents.policies.policy import Policy, last_convolution
from mitigate.core.precision import computing
from mitigate.guards.adaptation.adaptation import Adaptation
from mitigate.guards.adaptation.choices import EPISODE
from mitigate.worlds.episodes import Episode

# number of clean episodes, and maximum number of steps per episode (heuristic)
EPISODES, STEPS = 8, 100


class Recentre(Adaptation):
    """Shift the features of some modules to their clean mean.

    Args:
        modules: names of the modules whose outputs are shifted. The modules belong to the agent, or
            to the network of a policy. The default is the agent's image encoders, or the last
            convolution of a policy.
        prior: number of observations that the clean mean counts as when it is averaged with the
            observations of the episode. A larger value shifts the first frames less.
        reset: see :class:`Adaptation`.

    Attributes:
        means: the clean mean [C] of each module's output, in order. :meth:`calibrate` sets these
            means.

    Raises:
        ValueError: If ``prior`` or ``reset`` is invalid.
    """

    kind = "recentre"

    def __init__(
        self, modules: Sequence[str] | None = None, prior: float = 10.0, reset: str = EPISODE
    ) -> None:
        super().__init__(reset)
        if not 0 < prior < math.inf:
            raise ValueError(f"prior must be a number above 0, got {prior!r:.80}.")
        self.modules = None if modules is None else tuple(modules)
        self.prior = prior
        self.means: list[Tensor] = []
        # for each module: the episode's mean [C] and the number of observations [1]
        self._now: list[Tensor] = []

    def settings(self) -> dict[str, Any]:
        digest = hashlib.sha256(b"".join(mean.numpy().tobytes() for mean in self.means))
        modules = None if self.modules is None else list(self.modules)
        entries = {"modules": modules, "prior": self.prior, "means": digest.hexdigest()}
        return {**super().settings(), **entries}

    def check_agent(self, agent: Any) -> None:
        _modules(agent, self.modules)
        if not self.means:
            raise ValueError(
                "Recentre does not know the clean means. Call calibrate(agent, world, episode) "
                "first; mitigate.benchmark and mitigate evaluate do this themselves."
            )

    def calibrate(self, agent: Any, world: Any, episode: Callable[[int], Episode]) -> None:
        """Run clean episodes with the agent to measure the means, unless they are already known.

        Args:
            agent: the agent.
            world: a world.
            episode: function that returns a training episode, given its number.
        """
        modules = _modules(agent, self.modules)
        if self.means:
            return
        sums: list[Any] = [0.0] * len(modules)
        counts = [0] * len(modules)

        def record(place: int) -> Callable:
            def hook(module: nn.Module, inputs: Any, output: Any) -> None:
                sums[place] = sums[place] + _means(output).cpu()
                counts[place] += 1

            return hook

        device = next(modules[0].parameters(), torch.empty(0)).device
        with ExitStack() as stack, computing("fp32", device), in_eval_mode(agent):
            # one thread, as in evaluations, makes rounding errors of sums reproducible
            stack.callback(torch.set_num_threads, torch.get_num_threads())
            torch.set_num_threads(1)
            for i, module in enumerate(modules):
                stack.enter_context(module.register_forward_hook(record(i)))
            for number in range(EPISODES):
                chosen = episode(number)
                observation = world.reset(chosen)
                agent.reset(chosen.instruction.text)
                steps = 0
                while not world.done and steps < STEPS:
                    observation = world.step(agent.act(observation))
                    steps += 1
        if not all(counts):
            raise ValueError(
                f"{type(agent).__name__} did not call all modules that Recentre shifts. Name other "
                "modules: Recentre(modules=[...])."
            )
        self.means = [s / n for s, n in zip(sums, counts, strict=True)]

    def tensors(self, agent: Any) -> list[Tensor]:
        """Return the means of the episode, which belong to this guard and not to the agent."""
        self._now = [t for mean in self.means for t in (mean.clone(), torch.zeros(1))]
        return self._now

    @contextmanager
    def adapting(self, agent: Any) -> Iterator[None]:
        with ExitStack() as hooks:
            for i, module in enumerate(_modules(agent, self.modules)):
                hooks.enter_context(module.register_forward_hook(self._shift(i)))
            yield

    def _shift(self, place: int) -> Callable:
        def hook(module: nn.Module, inputs: Any, output: Any) -> Any:
            mean, count = self._now[2 * place : 2 * place + 2]
            # Tent runs the network a second time with gradients; do not count a frame twice
            if not torch.is_grad_enabled():
                mean.lerp_(_means(output).cpu(), 1.0 / (self.prior + float(count) + 1.0))
                count.add_(1.0)
            features = output[0] if isinstance(output, (tuple, list)) else output
            axis = _axis(features)
            shape = [-1 if i == axis else 1 for i in range(features.dim())]
            shift = (mean - self.means[place]).to(features).view(shape)
            shifted = features - shift
            return shifted if isinstance(output, Tensor) else type(output)((shifted, *output[1:]))

        return hook


def _modules(agent: Any, names: Sequence[str] | None) -> list[nn.Module]:
    """Return the modules with these names.

    If ``names`` is None, return the image encoders of the agent.

    Raises:
        ValueError: If a module does not exist, or the agent declares no encoders.
    """
    root: Any = agent.network if isinstance(agent, Policy) else agent
    if names is None and isinstance(agent, Policy):
        names = [last_convolution(agent)]
    if names is None:
        names = [parts[0] for parts in as_agent(agent).encoders.values()]
    if not names or not hasattr(root, "get_submodule"):
        raise ValueError(
            f"adapt=recentre does not know the features of {type(agent).__name__}, which declares "
            "no encoders (mitigate/agents/agent.py). Name modules of the network: "
            "adapt=Recentre(modules=[...]) of mitigate.guards.adaptation.recentre."
        )
    try:
        return [root.get_submodule(name) for name in names]
    except AttributeError as error:
        known = [name for name, _ in root.named_modules() if name]
        raise ValueError(
            f"Recentre(modules=...): {error}. Names of modules are {', '.join(known[:12])}."
        ) from None


def _axis(features: Tensor) -> int:
    """Return the channel axis: 1 for feature maps [B, C, h, w], and otherwise the last axis."""
    return 1 if features.dim() == 4 else features.dim() - 1


def _means(output: Any) -> Tensor:
    """Return the mean of each channel over all other axes."""
    features = output[0] if isinstance(output, (tuple, list)) else output
    return features.detach().float().movedim(_axis(features), 0).flatten(1).mean(1)
