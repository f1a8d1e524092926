"""Tests that the example recipe in recipes/README.md works from a folder outside the package."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from mitigate.core import conf
from mitigate.training import states, train

PAGE = (Path(__file__).parents[2] / "recipes/README.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_readme_example_of_a_recipe_trains(tmp_path, monkeypatch):
    (tmp_path / "recipe").mkdir()
    for kind, name in (("python", "steady.py"), ("yaml", "recipe/steady.yaml")):
        text = re.search(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)[1]
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    options = ["recipe=steady", "debug=smoke", "workers=0", "evaluation.enabled=false"]
    options += [f"folder={tmp_path / 'run'}", f"--config-dir={tmp_path}"]
    cfg = conf.load_config("train", options)
    train.run(cfg)
    assert states.checkpoints(tmp_path / "run/views")[-1].name == "step-00000002.pt"
    del sys.modules["steady"]
