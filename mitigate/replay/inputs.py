"""What a replay reads: agents from their weights, and recorded drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from omegaconf import DictConfig

from mitigate.guards.guard import NO_GUARDS, Guards


def load_agents(weights: Sequence[str]) -> dict[str, Any]:
    """The agents of folders of weights, by names that differ."""
    from mitigate.agents.loading import load
    from mitigate.core.names import name_of

    if len(set(weights)) < len(weights):
        raise ValueError(f"agents=[{','.join(weights)}] names one folder twice.")
    names = [name_of(folder) for folder in weights]
    if len(set(names)) < len(names):
        names = [folder.rstrip("/") for folder in weights]
    return {name: load(folder) for name, folder in zip(names, weights, strict=True)}


def load_recordings(
    cfg: DictConfig, paths: Sequence[str], views: set[int], guards: Guards = NO_GUARDS
) -> dict[int, list[Any]]:
    """Every drive, for agents with a panorama (12) and for those with one camera (1). Raises
    ValueError for a drive of which ``guards`` change no frame, before any frame is read."""
    from mitigate.worlds.recorded import Step, Topics, kinds, load, open_recording

    topics, step = Topics(**cfg.topics), Step(**cfg.step)
    how = {"topics": topics, "hfov": cfg.hfov, "unit": cfg.unit, "yaw": cfg.yaw}
    how["cameras"] = None if cfg.cameras is None else list(cfg.cameras)
    found: dict[int, list[Any]] = {count: [] for count in views}
    sources = [source for path in paths for source in open_recording(path, **how)]
    for source, count in product(sources if guards else [], views):
        guards.check_shown(kinds(source, count), source.name)
    for source, count in product(sources, views):
        drive = load(source, views=count, size=cfg.size, step=step)
        words = cfg.instruction or drive.instruction
        if not words:
            raise ValueError(
                f"{drive.name} says no instruction: give instruction='\"walk to the door\"'."
            )
        found[count].append(replace(drive, instruction=words))
    for drives in found.values():
        twice = {drive.name for drive in drives if sum(d.name == drive.name for d in drives) > 1}
        if twice:
            raise ValueError(f"Two drives are called {twice.pop()!r}: rename one.")
    return found
