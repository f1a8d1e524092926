"""What a column of a table is called: the weights, and all that its agent has other than they say.

Rows are told apart by this name and the weights' hash, so what the hash does not cover must be in
the name: settings, the size of a view, the safeguard in front.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from omegaconf import DictConfig, OmegaConf

from mitigate.core import build
from mitigate.core.files import sha256
from mitigate.safeguard import adapter_folder


def agent_and_name(cfg: DictConfig, overrides: Sequence[str] = ()) -> tuple[DictConfig, str]:
    """Return the settings of the agent that ``cfg`` (``conf/evaluate.yaml``) evaluates, and its
    column's name. ``overrides``: those of the command line, as for :func:`settings`."""
    node, changed = settings(cfg.agent, cfg.checkpoint, overrides)
    parts = [cfg.name or name_of(cfg.checkpoint)]
    parts += [_plain(f"{setting}={node[setting]}").strip("-") for setting in changed]
    if cfg.safeguard != "none":
        parts.append(safeguard_label(cfg.safeguard))
    if cfg.env.size != node.get("size", cfg.env.size):
        parts.append(f"env.size-{cfg.env.size}")
    return node, "+".join(parts)


def settings(
    agent: DictConfig, weights: str, overrides: Sequence[str]
) -> tuple[DictConfig, list[str]]:
    """Return ``agent`` with the settings that ``weights`` carry, and which of these differ.

    What the command line names counts more than what the weights carry: ``agent.blind=[rgb]``, and
    of a config chosen by ``agent=mine`` what is not the class's default. Where the weights carry
    nothing, those named differ.
    """
    keys = [override.lstrip("+").partition("=")[0].split(".") for override in overrides]
    named = {key[1] for key in keys if key[0] == "agent" and len(key) > 1}
    plain, own = build.defaults(agent), build.carried(agent, weights)
    if ["agent"] in keys:
        named |= {name for name in plain if agent[name] != plain[name]}
    node = build.merged(agent, own)
    for setting in named:
        node[setting] = agent[setting]
    known = plain | dict(OmegaConf.create(own).items())
    return node, [s for s in plain if (node[s] != known[s] if own else s in named)]


def name_of(weights: str) -> str:
    """Return the name of weights by their path: of the run, for a run's ``agent`` folder."""
    path = Path(weights.removesuffix(".safetensors"))
    while path.name in ("model", "agent", "run"):
        path = path.parent
    return path.name or "agent"


def of_run(cfg: DictConfig, folder: Path) -> str:
    """Return the column of a training (``conf/train.yaml``): the recipe, and the options that its
    folder's name holds, so that other settings are no other seeds of it."""
    options = folder.name.partition(f"-seed{cfg.seed}-")[2]
    return f"{cfg.name}+{options}" if options else cfg.name


def safeguard_label(choice: str) -> str:
    """Return a safeguard's part of a column's name: an adapter's folder with a hash of its weights,
    an endpoint's host and model; the names of ours as they are."""
    if choice.startswith(("http://", "https://")):
        return _plain(choice.partition("://")[2])
    weights = Path(choice) / adapter_folder.ADAPTER
    if not weights.is_file():
        return Path(choice).name
    return f"{name_of(choice)}-{sha256(weights)[:6]}"


def _plain(text: str) -> str:
    """Return ``text`` with a dash for all that a file's name should not hold."""
    return re.sub(r"[^A-Za-z0-9.@-]+", "-", text)
