"""Tests that every kind of shipped agent can be exported and reloaded."""

from __future__ import annotations

import pytest

import mitigate
from mitigate.agents.building import agent_option
from mitigate.agents.frontier import FrontierAgent
from mitigate.agents.recurrent import RecurrentAgent
from mitigate.core import conf
from mitigate.core.checkpoint import weights_sha
from mitigate.shipping import export, export_command
from mitigate.shipping.export import finished
from mitigate.training import train

SMALL = ["agent.size=16", "env.size=16", "init=null", "trainer.steps=1", "workers=0"]
SMALL += ["evaluation.enabled=false", "rollouts=1"]
KINDS = {
    "frontier": (FrontierAgent, ["stages.imitation=null", "agent.width=8"]),
    "recurrent_rgb": (RecurrentAgent, ["agent.rgb_width=8", "stages.perception_rgb=null"]),
}


@pytest.mark.slow  # tests/test_methods.py has a quicker test, which exports the frontier agent
@pytest.mark.parametrize("kind", KINDS)
def test_run_is_exported_and_loads_again(tmp_path, kind, monkeypatch):
    monkeypatch.setattr(export, "WALKS", 1)
    output, own_value = KINDS[kind]
    options = [f"agent={kind}", *SMALL, *own_value]
    cfg = conf.load_config("train", ["recipe=imitation", "debug=smoke", *options])
    cfg.runs = str(tmp_path)
    run = train.run(cfg)
    (option,) = agent_option([], str(run / "agent"))  # the command's default
    assert option == f"agent={kind.partition('_')[0]}"
    with pytest.raises(ValueError, match=option):
        export.export(run, "mine", out=tmp_path)
    walks = export_command._walks_of(run, [option, "env.size=16"], None)
    folder = export.export(run, "mine", out=tmp_path, walks=walks)
    assert f'load_hardened("{tmp_path}/mine")' in (folder / "README.md").read_text()
    loaded = mitigate.load_hardened(folder)
    assert isinstance(loaded, output)
    assert weights_sha(loaded) == weights_sha(finished(run, walks)[1])


def test_options_may_follow_rows_and_wrong_ones_are_explained(monkeypatch, tmp_path):
    options = {}

    def read(run, overrides, configs):
        options["options"] = overrides
        raise ValueError("enough")

    command = ["export", "runs/a", "mine", "--rows", "rows.jsonl", "agent=policy", "env=corridor"]
    monkeypatch.setattr("sys.argv", command)
    monkeypatch.setattr(export_command, "_walks_of", read)
    with pytest.raises(SystemExit, match="enough"):
        export_command.main()
    assert options["options"] == ["agent=policy", "env=corridor"]
    monkeypatch.undo()
    monkeypatch.setattr("sys.argv", ["export", "runs/a", "mine", "agent=recurent"])
    with pytest.raises(SystemExit, match="Did you mean recurrent?"):
        export_command.main()
