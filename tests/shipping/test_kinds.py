"""Every kind of agent of ours is exported, and reloads without being built by the user."""

from __future__ import annotations

import pytest

import mitigate
from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.recurrent import RecurrentAgent
from mitigate.core import conf
from mitigate.core.checkpoint import weights_sha
from mitigate.shipping import export
from mitigate.training import train

SMALL = ["agent.size=16", "env.size=16", "init=null", "trainer.steps=1", "workers=0"]
SMALL.append("evaluation.enabled=false")
KINDS = {
    "frontier": (FrontierAgent, ["stages.imitation=null", "agent.width=8"]),
    "recurrent_rgb": (RecurrentAgent, ["agent.rgb_width=8", "stages.perception_rgb=null"]),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_is_exported_and_loads_again(tmp_path, kind):
    made, own = KINDS[kind]
    options = [f"agent={kind}", *SMALL, *own]
    cfg = conf.load_config("train", ["recipe=imitation", "debug=smoke", *options])
    cfg.runs = str(tmp_path)
    run = train.run(cfg)
    with pytest.raises(ValueError, match=r"agent=recurrent behind"):
        export.export(run, "mine", out=tmp_path)
    walks = export._walks_of(run, [f"agent={kind}", "env.size=16"], None)
    folder = export.export(run, "mine", out=tmp_path, walks=walks)
    loaded = mitigate.load_hardened(folder)
    assert isinstance(loaded, made)
    assert weights_sha(loaded) == weights_sha(export._finished(run, walks)[1])
