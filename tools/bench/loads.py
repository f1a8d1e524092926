"""Endless loads for ``tools.bench.soak``: ``python -m tools.bench.loads NAME FOLDER``.

- training: rollouts and training steps of the shipped agent in 64 apartments, with a checkpoint
every 20 steps. The caches are full after a few minutes.
- evaluation: 20 episodes under the suite with two workers, again and again with new seeds.
- bridge: episodes of 20 steps with RGB and depth. The conditions of the suite are run in turn, each
with a new server.
"""

from __future__ import annotations

import itertools
import os
import shutil
import sys
from pathlib import Path

import numpy as np

ENDLESS = 10_000_000  # steps
EPISODES = 20  # number of episodes per round of evaluation or bridge traffic (heuristic)
STEPS = 20  # number of steps per episode of bridge traffic (heuristic)
SEVERITY = 0.6


def training(folder: Path) -> None:
    """Train until the process is ended; at most two checkpoints are kept."""
    from mitigate.core import conf
    from mitigate.training.train import run

    options = [
        "recipe=da_per_episode",
        "experiment=frozen",
        "rollouts=4",
        "env.layouts=64",
        f"trainer.steps={ENDLESS}",
        "trainer.save_every=20",
        "evaluation.enabled=false",
        f"folder={folder}",
        f"runs={folder.parent}",
    ]
    run(conf.load_config("train", options))


def evaluation(folder: Path) -> None:
    """Evaluate with one seed after another in this process."""
    from mitigate.core import conf
    from mitigate.evaluation.evaluate import run

    for seed in itertools.count():
        out = folder / f"seed-{seed}"
        options = ["checkpoint=checkpoints/base", f"episodes={EPISODES}", f"seed={seed}"]
        run(conf.load_config("evaluate", [*options, "workers=2", f"out={out}"]))
        shutil.rmtree(out)


def bridge(folder: Path) -> None:
    """Run episodes over the bridge, with one server per condition."""
    from mitigate.bridge.condition import Condition, Words
    from mitigate.bridge.hook import mitigate_hook
    from mitigate.bridge.server import Listener
    from mitigate.corruptions import CLEAN, NAMES, Corruption

    corruptions = [CLEAN, *(Corruption(name, SEVERITY) for name in NAMES)]
    rgb = np.full((128, 128, 3), 90, np.uint8)
    depth = np.full((128, 128, 1), 2.0, np.float32)
    for number, corruption in enumerate(itertools.cycle(corruptions)):
        events = folder / f"{number}"
        with Listener(Condition(corruption, 0, Words()), events) as listener:
            os.environ.update(listener.environment())
            session = mitigate_hook.Session()  # a session opens its own connection
            for name in map(str, range(EPISODES)):
                episode = mitigate_hook.Episode(session, name, "soak", None)
                for _ in range(STEPS):
                    episode.corrupt({"rgb": rgb.copy(), "depth": depth.copy()})
                episode.finish(success=True, spl=1.0)
        shutil.rmtree(events)


LOADS = {"training": training, "evaluation": evaluation, "bridge": bridge}

if __name__ == "__main__":
    LOADS[sys.argv[1]](Path(sys.argv[2]))
