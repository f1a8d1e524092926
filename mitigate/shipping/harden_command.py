"""Harden a trained policy: ``mitigate harden policy=my_policy:load world=my_policy:make_world``.

The options are the arguments of ``mitigate.harden``, except test_episodes, conditions and settings.
The modules are imported from the working directory or from installed packages. If a run was
interrupted, the same command continues it. With ``-m seed=0,1,2``, the command runs several seeds.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import Any

from omegaconf import MISSING

from mitigate.core import conf
from mitigate.core.build import imported
from mitigate.evaluation.conditions import suite_conditions


@dataclass
class HardenConfig:
    """Types of the options in ``conf/harden.yaml``, which documents each of them."""

    policy: str | None = None
    world: str | None = None
    forward: str | None = None
    recurrent: bool = False
    method: str = "self_distil"
    test_episodes: int = 50
    suite: Any = MISSING
    conditions: list[str] | None = None
    severity: float = 0.6
    tune: str = "all"
    targets: list[str] | None = None
    steps: int = 1500
    lr: float | None = None
    broad_share: float = 0.5
    schedule: str = "per_episode"
    validation: int = 16
    settings: dict[str, Any] = field(default_factory=dict)
    seed: int = 0
    workers: int | None = 1
    version: str | None = None
    out: str | None = None


conf.register("harden", HardenConfig)


def run(config: HardenConfig) -> Any:
    """Harden the policy of ``config`` and return the result of ``mitigate.harden``.

    Raises ValueError if an option is invalid.
    """
    if config.test_episodes < 1:
        raise ValueError(f"test_episodes must be a whole number >= 1, got {config.test_episodes}.")
    options = dict(vars(config))
    load_policy = imported(options.pop("policy"), "policy")
    world = imported(options.pop("world"), "world")
    suite, conditions = options.pop("suite"), options.pop("conditions")
    names = suite_conditions(suite) if conditions is None else conditions
    forward = options.pop("forward")
    episodes = options.pop("test_episodes")
    settings = options.pop("settings")
    if shared := sorted(set(settings) & set(vars(config))):
        raise ValueError(f"settings.{shared[0]} is not a setting. Write {shared[0]}=VALUE.")
    # these imports are slow, so they follow the checks of the options
    from mitigate.shipping.harden import harden
    from mitigate.worlds.seeded import seeded_episodes

    return harden(
        load_policy(),
        world,
        forward=None if forward is None else imported(forward, "forward"),
        listed=seeded_episodes(range(episodes)),
        suite=names,
        **options,
        **settings,
    )


def main() -> None:
    """Run from the command line."""
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    program = conf.hydra_program("harden", lambda cfg: print(run(conf.typed(cfg, "harden"))))
    conf.main(program, "harden")
