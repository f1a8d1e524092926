"""Hardened folders of agents that are not ours: weights, config and card, checked by walking.

Such an agent has a class of its own, which no folder may name: who exports or loads it builds it.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from torch import nn

from mitigate.agents import adapters, hardened
from mitigate.core import checkpoint, checksums
from mitigate.corruptions import CLEAN
from mitigate.evaluation.episode import run_episode
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

WALKS = 2  # episodes that the reloaded agent must walk alike (ours)
_CHECK = "import sys; from mitigate.shipping.others import check; check(*sys.argv[1:])"


class Walks:
    """What an exported folder is checked by: ``episodes`` walked clean, in a fresh process, by the
    agent that ``make_agent`` makes and the folder fills, in what ``make_world`` makes."""

    def __init__(
        self,
        make_agent: Callable[[], nn.Module],
        make_world: Callable[[], World],
        episodes: Sequence[Episode],
    ) -> None:
        self.make_agent, self.make_world = make_agent, make_world
        self.episodes = list(episodes)[:WALKS]

    def measures(self, agent: Any) -> list[dict[str, Any]]:
        """How ``agent`` walks, the hash of its weights first."""
        world = self.make_world()
        walked = [run_episode(agent.eval(), world, e, CLEAN, 0) for e in self.episodes]
        return [{"weights": checkpoint.weights_sha(agent)}, *walked]


def write(draft: Path, agent: nn.Module, only_adapters: bool, *, half: bool) -> None:
    """Write the weights of ``agent``, with ``half`` in float16, or its adapters alone."""
    if only_adapters:
        adapters.save_adapters(agent, draft)
    else:
        checkpoint.save_weights(agent, draft, half=half)
    checksums.delete_sidecars(draft, "*")  # the card has all sums


def reload(draft: Path, agent: nn.Module, walks: Walks) -> None:
    """Raise ValueError unless a fresh process reloads ``draft`` to an agent that walks as ``agent``
    does."""
    with tempfile.TemporaryDirectory() as folder:
        given, expected = Path(folder, "walks"), Path(folder, "expected.json")
        given.write_bytes(pickle.dumps((sys.path, walks)))  # ours, for the process started here
        expected.write_text(json.dumps(walks.measures(agent)), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-c", _CHECK, str(draft), str(given), str(expected)],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            capture_output=True,
            text=True,
        )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise ValueError(f"The folder does not reload to the same agent ({last}); nothing written")


def check(draft: str, given: str, expected: str) -> None:
    """Raise ValueError if the agent in ``draft`` walks otherwise than ``expected`` says. Run by
    :func:`reload` in a fresh process."""
    path, walks = pickle.loads(Path(given).read_bytes())
    sys.path[:] = path
    agent = hardened.load_hardened(draft, agent=walks.make_agent())
    found = json.loads(json.dumps(walks.measures(agent)))
    wanted = json.loads(Path(expected).read_text(encoding="utf-8"))
    if found != wanted:
        raise ValueError(f"it walks {found}, and walked {wanted}")
