"""``mitigate.harden(policy, world)``: make a trained policy robust, without an expert.

A copy of the policy is trained. The copy learns from the original policy as its teacher
(``recipes/self_distil.py``), or from the reward of the world (``recipes/ppo.py``). Then the
policies before and after training are compared, on episodes that are not used for training.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn

from mitigate.agents.adapters import (
    adapter_parameters,
    insert_adapters,
    save_adapters,
    trainable_share,
)
from mitigate.agents.policies.module import Forward
from mitigate.agents.policies.policy import Policy, copied, last_convolution
from mitigate.agents.policies.wrapping import as_policy
from mitigate.agents.sites import find_sites
from mitigate.core import checkpoint, conf, seeding
from mitigate.core.locks import FolderLock
from mitigate.core.names import counted, file_name, unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.progress import duration, say
from mitigate.core.seeding import digest, generator
from mitigate.core.workers import packed
from mitigate.corruptions import CLEAN, Corruption, Schedule
from mitigate.corruptions.registry import family, modality
from mitigate.corruptions.suite import check_name
from mitigate.evaluation import provenance
from mitigate.evaluation.benchmark import checked_world, seconds_per_episode
from mitigate.evaluation.comparison import RANDOM, Comparison, RandomPolicy, compare
from mitigate.evaluation.episode_lists import episode_list
from mitigate.evaluation.evaluator import evaluate
from mitigate.evaluation.rows import ROWS, Row
from mitigate.recipes.ppo import Ppo
from mitigate.recipes.self_distil import SelfDistil
from mitigate.shipping import selection
from mitigate.training import states
from mitigate.training.objective import Objective
from mitigate.training.trainer import Trainer
from mitigate.worlds.episodes import Episode
from mitigate.worlds.seeded import FIRST_TRAINING_SEED, seeded_episodes
from mitigate.worlds.world import World

OUT = Path("runs/harden")
# default number of episodes of the comparison (heuristic); SR is then accurate to about 10 points
EPISODES = 50
TUNE = ("all", "adapters")
# These are the default learning rates, by method and ``tune`` (docs/results/third-party.md).
# Adapters start at zero and need a higher learning rate.
RATES = {
    ("self_distil", "all"): 1e-3,
    ("self_distil", "adapters"): 2e-3,
    ("ppo", "all"): 3e-4,
    ("ppo", "adapters"): 2e-3,
}
SPLIT, VALIDATION = "compared", "validation"
METHODS: dict[str, type[Objective]] = {"self_distil": SelfDistil, "ppo": Ppo}
SCHEDULES = ("per_episode", "per_frame")
# harden() itself sets these arguments of the objectives
OWN = ("agent", "world", "training", "schedule", "folder", "steps", "seed")


@dataclass(frozen=True)
class Hardened:
    """The result of :func:`harden`.

    Attributes:
        policy: a copy of the given policy with hardened weights, of the same class.
        agent: the hardened policy as an agent, for ``mitigate.benchmark``.
        report: success rate, return and retention before and after training. ``str(report)`` is a
            Markdown table.
        rows: the result rows of both policies, with the names "before" and "after".
        folder: folder of the run. The subfolder ``agent`` holds the weights, which
            ``mitigate.load_policy`` loads.
        chosen: name of the weights that validation chose: "trained", "averaged" or "given".
    """

    policy: Any
    agent: Policy
    report: Comparison
    rows: list[Row]
    folder: Path
    chosen: str

    def __str__(self) -> str:
        return f"{self.report}\n\nWeights: {self.folder / 'agent'}"


def harden(
    policy: Any,
    world: Callable[[], World],
    *,
    forward: Forward | None = None,
    recurrent: bool = False,
    method: str = "self_distil",
    listed: Sequence[Episode] | None = None,
    training: Sequence[Episode] | None = None,
    suite: str | Sequence[str] = "full",
    severity: float = 0.6,
    tune: str = "all",
    targets: Sequence[str] | None = None,
    steps: int = 1500,
    lr: float | None = None,
    broad_share: float = 0.5,
    schedule: str = "per_episode",
    validation: int = 16,
    seed: int = 0,
    workers: int | None = 1,
    version: str | None = None,
    out: Path | str | None = None,
    **settings: Any,
) -> Hardened:
    """Train a copy of ``policy`` to act under corruptions as ``policy`` acts on clean frames.

    No expert and no labels are needed. A reward is needed only for ``method="ppo"``. If a run was
    interrupted, the same call continues it.

    Args:
        policy: a trained policy of stable-baselines3 or torchrl, or an ``nn.Module``
            (``agents/policies/``). The policy is not changed.
        world: function that constructs a world, such as ``lambda: GymWorld(gymnasium.make(...))``.
            It is called several times. Environments are not closed.
        forward: function that calls an ``nn.Module``
            (:class:`~mitigate.agents.policies.module.ModulePolicy`).
        recurrent: whether ``policy`` is an ``nn.Module`` that keeps state between steps.
        method: with "self_distil", the policy is the teacher of its copy. With "ppo", the copy
            learns from the reward of the world.
        listed: episodes of the comparison. The default is seeds 0 to 49 of the environment.
        training: training episodes. The default is other seeds of the environment.
        suite: corruptions for training and comparison: a name in ``conf/suite``, or a list.
            Corruptions of sensors that the policy does not read are left out.
        severity: severity of the comparison, from 0 to 1. Training uses severities from 0.3 to 1.
        tune: "all" to train all weights, or "adapters" to insert adapters into the frozen policy
            and train only these.
        targets: regular expressions for the names of modules after which adapters are inserted. The
            default is every convolution, or the first layer if there is no convolution.
        steps: number of training steps.
        lr: learning rate. The default is 1e-3 for all weights (with "ppo", 3e-4) and 2e-3 for
            adapters.
        broad_share: fraction of corrupted frames that have random compositions instead of
            corruptions of the suite. Random compositions prepare the policy for corruptions that
            the suite does not contain.
        schedule: how often the corruption changes in training, "per_episode" or "per_frame".
        validation: number of training episodes on which the trained weights, the given weights and
            an average of both are compared under each corruption, to choose the best
            (``shipping/selection.py``). With 0, the trained weights are used.
        seed: seed of training and corruptions.
        workers: number of processes for the comparison. With None, one process per core is used if
            there is enough work.
        version: label for state of the policy, or of the world's classes, that mitigate cannot
            inspect. Choose a new one, and a new ``out``, whenever this state changes.
        out: folder of the run. The default is a folder in runs/harden.
        **settings: other arguments of the method's class, such as ``episodes=16``. The classes are
            :class:`~mitigate.recipes.self_distil.SelfDistil` and
            :class:`~mitigate.recipes.ppo.Ppo`.

    Raises:
        TypeError: If the policy has an unsupported type.
        ValueError: If an argument is invalid, or the folder contains a different run.
    """
    seeding.check(seed)
    _check_choices(method=method, tune=tune, schedule=schedule)
    _check_counts(steps=steps, validation=validation)
    default = seeded_episodes(range(EPISODES))
    compared = default if listed is None else episode_list("listed", listed)
    if not compared:
        raise ValueError("listed must hold at least one episode, or be None.")
    _check_settings(method, settings)
    first, made_by = checked_world(world, [], version)
    before = as_policy(policy, first, forward=forward, recurrent=recurrent)
    after = copied(before)
    names = _corruptions(suite, before, first)
    suffix = "" if method == "self_distil" else f"-{method}"
    folder = Path(out or OUT / f"{file_name(before.name)}-s{severity:g}-seed{seed}{suffix}")
    conditions = [CLEAN, *(Corruption(name, severity) for name in names)]
    if workers != 1:
        packed((before, world), "The policy or its world", "give workers=1")
    if tune == "adapters":
        _insert_adapters(after, first, compared[0], targets, seed)
    start = {name: value.clone() for name, value in after.network.state_dict().items()}
    episodes = _Training(training, compared)
    available = {
        "agent": after,
        "world": world,
        "training": episodes,
        "schedule": Schedule(schedule, (0.3, 1.0), names=tuple(names), broad_share=broad_share),
        "folder": folder / "frames",
        "steps": steps,
        "seed": seed,
    }
    parameters = signature(METHODS[method]).parameters
    arguments: dict[str, Any] = {name: available[name] for name in OWN if name in parameters}
    objective = METHODS[method](**arguments, **settings)
    identity: dict[str, Any] = {
        "policy": before.version,
        "settings_of_policy": before.settings(),
        "names": list(names),
        "broad_share": broad_share,
        "tune": tune,
        "settings": {name: str(value) for name, value in settings.items()},
        "method": method,
        "schedule": schedule,
        "training": episodes.name,
        # validation compares the weights at this severity
        "severity": severity,
        "validation": validation,
    }
    label = ""
    if version is not None:
        identity["version"] = version
        label = f"-{version}"
    trainer = Trainer(
        objective,
        steps=steps,
        folder=folder / "training",
        lr=RATES[method, tune] if lr is None else lr,
        warmup=min(50, steps // 10),
        seed=seed,
        precision="fp32",
        save_every=max(1, steps // 5),
        name="harden",
        config=identity,
    )
    with FolderLock(folder):
        if newest := states.load_newest(trainer.folder):
            recorded = states.as_json(newest[1]["config"])
            states.check_same(
                folder, recorded, trainer.config, "Or choose another folder (out=...)."
            )
        provenance.keep(folder, first, made_by, SPLIT, compared)
        episode_seconds = seconds_per_episode(before, first, compared)
        count = len(compared) * len(conditions)
        say(
            f"harden: {counted(count, 'episode')} with the policy (about "
            f"{duration(episode_seconds * count)}), {counted(steps, 'step')} of training, "
            f"{counted(count, 'episode')} with the hardened policy; in {folder}"
        )
        measure = partial(
            evaluate, world=world, episodes=compared, out=folder / ROWS, split=SPLIT, seed=seed
        )
        measure_all = partial(measure, conditions=conditions, workers=workers)
        rows = measure_all(before, name="before", version=before.version + label)
        rows += measure(RandomPolicy(before.space, seed), conditions=[CLEAN], name=RANDOM)
        # raises an error, before any training, if the policy is not better than random actions
        compare(rows)
        try:
            trainer.fit()
        except KeyboardInterrupt:
            say("harden: interrupted. The same call continues.")
            raise
        after.requires_grad_(True)
        chosen = "trained"
        if validation:
            measure_validation = partial(
                measure_all,
                episodes=episodes.several(validation, seed),
                out=folder / "validation.jsonl",
                split=VALIDATION,
            )
            chosen = selection.choose(after, start, measure_validation)
        if tune == "adapters":
            save_adapters(after.network, folder / "agent")
        else:
            checkpoint.save_weights(after.network, folder / "agent")
        rows += measure_all(after, name="after", version=after.version + label)
    report = compare(rows)
    _advise(report, chosen, tune)
    return Hardened(_like(policy, after), after, report, rows, folder, chosen)


def _check_choices(*, method: str, tune: str, schedule: str) -> None:
    """Raise ValueError for an argument of :func:`harden` that is not one of its allowed values."""
    for argument, value, allowed in (
        ("method", method, tuple(METHODS)),
        ("tune", tune, TUNE),
        ("schedule", schedule, SCHEDULES),
    ):
        if value not in allowed:
            raise ValueError(f"{argument} must be one of {', '.join(allowed)}, got {value!r:.80}.")


def _check_counts(*, steps: int, validation: int) -> None:
    """Raise ValueError for a number of :func:`harden` that is too small."""
    for argument, number, least in (("steps", steps, 1), ("validation", validation, 0)):
        if type(number) is not int or number < least:
            raise ValueError(f"{argument} must be a whole number >= {least}, got {number!r:.80}.")


def _check_settings(method: str, settings: Iterable[str]) -> None:
    """Raise ValueError for a name in ``settings`` that the class of ``method`` does not take."""
    known = [name for name in signature(METHODS[method]).parameters if name not in OWN]
    if others := sorted(set(settings) - set(known)):
        shared = [name for name in signature(harden).parameters if name != "settings"]
        raise ValueError(
            unknown(f"argument of harden(method={method!r})", others[0], shared + known)
        )


def _advise(report: Comparison, chosen: str, tune: str) -> None:
    """Print advice if the hardened policy is worse than the given one, or if it is unchanged."""
    corrupted = next(line for line in report.lines if not line.title.endswith(": Clean"))
    # change of the mean over all corruptions, or of the single corruption if there is just one
    change = corrupted.changes["after"]
    if change.excludes_zero and change.value < 0:
        say(
            "harden: the hardened policy is worse than the given one under these corruptions. Keep "
            "the given policy, or train with other settings (suite=, severity=, steps=, seed=)."
        )
    elif chosen == "given":
        other = "longer training (steps=)" + ("" if tune == "adapters" else ' or tune="adapters"')
        say(
            "harden: no trained weights were clearly better than the given ones in validation, so "
            f"the policy is unchanged. If it is not robust yet, try {other}, or more validation "
            "episodes (validation=)."
        )


class _Training:
    """Episodes for training, from a list or from seeds that the comparison does not use."""

    def __init__(self, listed: Iterable[Episode] | None, compared: Sequence[Episode]) -> None:
        self.listed = None if listed is None else episode_list("training", listed)
        shared = {e.episode_id for e in self.listed or ()} & {e.episode_id for e in compared}
        if shared:
            raise ValueError(
                f"Training and comparison share {counted(len(shared), 'episode')} "
                f"({', '.join(sorted(shared)[:3])}). Choose other episodes for one of them, so "
                "that the comparison is fair."
            )
        if self.listed == []:
            raise ValueError("training must hold at least one episode, or be None.")

    @property
    def name(self) -> str:
        """Name of this source, which differs between lists of different episodes."""
        if self.listed is None:
            return "generated seeds"
        number = digest("training", *(episode.episode_id for episode in self.listed))
        return f"{counted(len(self.listed), 'episode')} ({number:032x})"

    def draw(self, rng: np.random.Generator, share: tuple[int, int]) -> Episode:
        if self.listed is None:
            return seeded_episodes([int(rng.integers(FIRST_TRAINING_SEED, 2**31 - 1))])[0]
        return self.listed[int(rng.integers(len(self.listed)))]

    def several(self, count: int, seed: int) -> list[Episode]:
        """Return ``count`` different episodes; if the list is shorter, return all its episodes."""
        rng = generator(seed, "harden validation")
        if self.listed is not None:
            chosen = rng.permutation(len(self.listed))[:count]
            return [self.listed[place] for place in chosen]
        episodes: dict[str, Episode] = {}
        while len(episodes) < count:
            episode = self.draw(rng, (0, 1))
            episodes[episode.episode_id] = episode
        return list(episodes.values())


def _corruptions(suite: str | Sequence[str], policy: Policy, world: World) -> list[str]:
    """Return the corruptions of a suite that change a sensor which the policy reads."""
    if isinstance(suite, str):
        listed = list(conf.composed("evaluate", [f"suite={suite}"]).suite.conditions)
    else:
        listed = [check_name(name) for name in suite if name != "clean"]
    if faults := [name for name in listed if family(name)]:
        raise ValueError(
            f"suite={suite} contains {faults[0]}, a {family(faults[0])} fault, but training "
            "supports only corruptions of single frames. Leave out all faults, and measure them "
            "with mitigate.benchmark."
        )
    kinds = {name: modality(name) for name in listed if name != "clean"}
    sensors = [sensor for sensor in (RGB, DEPTH) if sensor in policy.sensors]
    names = [name for name, kind in kinds.items() if kind in sensors]
    if not names:
        raise ValueError(
            f"No corruption of suite={suite} changes {' or '.join(sensors) or 'what it reads'}. "
            "Name another suite, or a list of corruptions."
        )
    # a suite may name corruptions of sensors that the world lacks; a list of the user should not
    absent = {RGB, DEPTH} - {*world.sensors} if isinstance(suite, str) else set()
    if left := [name for name, kind in kinds.items() if kind not in {*sensors} | absent]:
        say(f"{policy.name} reads only {' and '.join(sensors)}: left out {', '.join(left)}")
    return names


def _insert_adapters(
    policy: Policy, world: World, episode: Episode, targets: Sequence[str] | None, seed: int
) -> None:
    """Insert adapters after the modules that ``targets`` match, or after every convolution."""
    observation = world.reset(episode)
    frames = {name: np.asarray(observation[name]) for name in policy.sensors}

    def run(count: int) -> Any:
        return policy.answer(policy.native({n: np.stack([f] * count) for n, f in frames.items()}))

    if targets is None:
        called = find_sites(policy.network, run)
        convolutions = [
            name
            for name, module in policy.network.named_modules()
            if isinstance(module, nn.Conv2d) and name in called
        ]
        targets = [re.escape(name) for name in convolutions or [last_convolution(policy)]]
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(digest("harden adapters", seed) & (2**63 - 1))
        adapted = insert_adapters(policy.network, targets, run=run, reduction=2)
    for parameter in adapter_parameters(policy.network):
        parameter.requires_grad_(True)
    share = trainable_share(policy.network)
    say(f"adapters after {', '.join(adapted)}: {share:.1%} of the policy's weights")


def _like(policy: Any, hardened: Policy) -> Any:
    """Return the hardened policy as an object of the class of ``policy``."""
    if isinstance(policy, Policy):
        return hardened
    if isinstance(policy, nn.Module):
        return hardened.network
    # a model of stable-baselines3 holds its network in the attribute ``policy``
    twin = copy.copy(policy)
    twin.policy = hardened.network
    return twin
