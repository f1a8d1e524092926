"""Tests of the text report, and of the safeguard in an evaluation."""

from __future__ import annotations

import json

import pytest
import torch

from mitigate.core import conf
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation import evaluate, evaluator
from mitigate.guards.guard import Guards
from mitigate.guards.opening import TextGuard
from mitigate.guards.text.guard import Safeguard
from mitigate.guards.text.language_models.model import LanguageModel
from mitigate.training.config import read
from mitigate.training.reports import safeguard as report
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.guards.text.conftest import LORA

TEXTS = ["Walk past the sofa and turn left at the door.", "Leave the pantry. Stop by the piano."]


@pytest.mark.slow
def test_report_tries_every_text_in_every_family():
    hurt = report.corrupted(TEXTS, 1.0, "validation")
    assert len(hurt) == len(TEXTS) * len(report.FAMILIES)
    assert all(r.injected for r in hurt if r.family == "black_box")
    loud = [
        r for r in report.repaired(hurt, report.choose("classifier")) if r.family == "capitalize"
    ]
    assert [r.repaired for r in loud] == TEXTS and all(r.heard != r.clean for r in loud)


@pytest.mark.slow
def test_report_command_writes_tables_and_repairs(tmp_path, capsys):
    (tmp_path / "texts.txt").write_text("# two\n" + "\n".join(TEXTS) + "\n")
    arguments = ["none", "classifier", "--texts", str(tmp_path / "texts.txt")]
    report.main([*arguments, "--out", str(tmp_path)])
    assert "| classifier |" in capsys.readouterr().out
    lines = [json.loads(line) for line in (tmp_path / "repairs.jsonl").open()]
    assert len(lines) == 2 * len(TEXTS) * len(report.FAMILIES)


@pytest.mark.parametrize("count", ["0", "-1", "2.5"])
def test_report_accepts_only_positive_counts(count, capsys):
    with pytest.raises(SystemExit):
        report.main(["classifier", "--texts", "texts.txt", "--count", count])
    assert f"must be a whole number >= 1, got '{count}'" in capsys.readouterr().err


def test_report_names_a_file_without_instructions(tmp_path):
    (tmp_path / "texts.txt").write_text("# none\n")
    with pytest.raises(ValueError, match="no instructions in .*texts.txt"):
        report.main(["classifier", "--texts", str(tmp_path / "texts.txt"), "--out", str(tmp_path)])


@pytest.mark.slow
def test_training_reports_before_and_after(tiny_base, tmp_path, capsys):
    torch.manual_seed(0)
    cfg = read(conf.load_config("train", ["recipe=safeguard_lora", "evaluation.episodes=4"]))
    assert cfg.report == "mitigate.training.reports.safeguard.before_after"
    report.before_after(cfg, None, LanguageModel(tiny_base, "fp32", LORA), tmp_path)
    printed = capsys.readouterr().out
    for name in ("none", "classifier", "before, alone", "after, alone", "after, guarded"):
        assert f"## {name}" in printed


class Listener(torch.nn.Module):
    """An agent that records the instructions and stops at once."""

    heard: list[str] = []  # shared on purpose

    def reset(self, instruction):
        self.heard.append(instruction)

    def act(self, observation):
        return 0


def test_evaluation_records_the_repaired_instruction(tmp_path):
    cfg = conf.load_config("evaluate")
    episodes = evaluate.episodes(cfg.env, "val_unseen", 2)
    Listener.heard.clear()
    rows = evaluator.evaluate(
        Listener(),
        ApartmentsWorld,
        episodes,
        [CLEAN, Corruption("capitalize", 1.0), Corruption("black_box", 0.1)],
        name="listener+classifier",
        out=tmp_path / "rows.jsonl",
        split="val_unseen",
        guards=Guards([TextGuard(Safeguard(log=tmp_path / "log.jsonl"), "classifier")]),
    )
    assert {row["name"] for row in rows} == {"listener+classifier"} and len(rows) == 6
    for index, episode in enumerate(episodes):
        clean, quiet, _ = Listener.heard[3 * index : 3 * index + 3]
        assert clean == episode.instruction.text and quiet.lower() == clean.lower()
        assert quiet == clean
    assert len((tmp_path / "log.jsonl").read_text().splitlines()) == 6
