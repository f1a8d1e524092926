"""Tests of training on recorded conversations."""

from __future__ import annotations

import json
import sys
import time
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from mitigate.agents.vlm.answers import ANSWERS
from mitigate.agents.vlm.conversation import TASK
from mitigate.agents.vlm.dataset import CONVERSATIONS, write_conversations
from mitigate.agents.vlm.rollout import join_pieces
from mitigate.corruptions import Schedule
from mitigate.recipes.conversations import Conversations
from mitigate.training import train
from tests.agents.vlm.corridor import Corridor, episode
from tests.agents.vlm.tiny_models import write_model

TEXT = "Go to the {answers} mark."


@pytest.fixture
def folder(tmp_path):
    write_conversations(Corridor(), [episode(1, 6, TEXT), episode(3, 2)], tmp_path, history=1)
    return tmp_path


def agent(task: str = TASK) -> SimpleNamespace:
    answers = ANSWERS["navid"]
    return SimpleNamespace(
        answers=answers, task=task, join=lambda pieces: join_pieces(pieces, len(answers))
    )


def source(folder, task: str = TASK, **options) -> Conversations:
    return Conversations(agent(task), str(folder), **{"decisions": 6, **options})


def batch(made: Conversations, step: int = 0):
    return made.collate([made.work(job) for job in made.jobs(step)])


def rewrite(folder, change) -> None:
    """Apply ``change`` to the first entry of the file."""
    file = folder / CONVERSATIONS
    first, *others = file.read_text("utf-8").splitlines()
    entry = json.loads(first)
    change(entry)
    file.write_text("\n".join([json.dumps(entry), *others]) + "\n", "utf-8")


def test_entries_are_read_as_they_were_written(folder):
    entries = source(folder).entries
    texts = [ANSWERS["navid"][entry.answer].text for entry in entries]
    assert texts == ["forward 75 cm", "forward 50 cm", "stop", "turn left 15 degrees", "stop"]
    assert [entry.instruction for entry in entries] == [TEXT] * 3 + ["Go to the red mark."] * 2
    assert [len(entry.images) for entry in entries] == [1, 2, 2, 1, 2]


def test_batch_holds_each_entrys_own_frames(folder):
    made = source(folder)
    decisions = batch(made)
    assert len(decisions.texts) == len(decisions.views) == len(decisions.target) == 6
    by_answer = {entry.answer: entry for entry in made.entries[:3]}
    for text, views, target in zip(decisions.texts, decisions.views, decisions.target, strict=True):
        if text != TEXT:
            continue
        entry = by_answer[int(target.argmax())]
        assert len(views) == len(entry.images)
        for view, file in zip(views, entry.images, strict=True):
            stored = cv2.imread(str(file))[..., ::-1]
            assert np.array_equal(decisions.frames[view].numpy(), stored)


def test_images_of_a_batch_are_corrupted_and_repeatable(folder):
    schedule = Schedule("per_episode", 1.0, names=("low_light",), clean_share=0.0)
    clean, dark = batch(source(folder)), batch(source(folder, schedule=schedule))
    assert dark.frames.float().mean() < clean.frames.float().mean() / 2
    again = batch(source(folder, schedule=schedule))
    assert np.array_equal(dark.frames, again.frames)
    assert not np.array_equal(batch(source(folder), step=1).target, clean.target)


def test_questions_of_another_project_need_its_task(folder):
    def change(entry):
        entry["image"] = entry.pop("images")[0]
        entry["conversations"][0]["value"] = "<image>\nThe task is: Go on. What next?"

    rewrite(folder, change)
    with pytest.raises(ValueError, match=r"line 1: .*does not fit agent\.task.*The task is"):
        source(folder)
    file = folder / CONVERSATIONS
    file.write_text(file.read_text("utf-8").splitlines()[0], "utf-8")
    (entry,) = source(folder, task="The task is: {instruction} What next?").entries
    assert entry.instruction == "Go on." and len(entry.images) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda e: e.update(images=[]), "'images' must list at least one"),
        (lambda e: e.update(images=["../secret.png"]), "must be a path below the folder"),
        (lambda e: e.update(images=["/etc/passwd"]), "must be a path below the folder"),
        (lambda e: e.update(images=["a/" + "b" * 300]), "must be a path below the folder"),
        (lambda e: e.update(images=["a.png"] * 66), "at most 65 paths, got 66"),
        (lambda e: e.update(images=["frames/a.png", "b.png"]), "1 times <image> for 2 images"),
        (lambda e: e["conversations"].append({"from": "human"}), "one question .* one answer"),
        (lambda e: e.update(conversations=5), "one question .* one answer"),
        (lambda e: e["conversations"][1].update(value="go on"), "'go on' must be one of stop, "),
    ],
)
def test_invalid_entry_is_named_by_its_line(folder, change, words):
    rewrite(folder, change)
    with pytest.raises(ValueError, match=f"conversations.jsonl, line 1: .*{words}"):
        source(folder)


def test_missing_files_and_bad_images_are_errors(folder, tmp_path):
    with pytest.raises(FileNotFoundError, match="conversations.jsonl"):
        source(tmp_path / "nowhere")
    with pytest.raises(ValueError, match="folder of the conversations is missing"):
        Conversations(agent(), "")
    image = source(folder).entries[0].images[0]
    image.write_bytes(b"no image")
    with pytest.raises(ValueError, match=r"0000\.png is not a PNG file"):
        batch(source(folder, decisions=40))
    cv2.imwrite(str(image), np.zeros((9, 9, 3), np.uint8))
    with pytest.raises(ValueError, match="must have the same size"):
        batch(source(folder, decisions=40))
    image.unlink()
    with pytest.raises(FileNotFoundError, match="There is no image"):
        source(folder)
    (folder / CONVERSATIONS).write_text("\n", "utf-8")
    with pytest.raises(ValueError, match="at least one conversation"):
        source(folder)


def test_images_of_all_steps_have_one_size(folder):
    """One image differs, so most steps do not contain it."""
    image = source(folder).entries[0].images[0]
    cv2.imwrite(str(image), np.zeros((9, 9, 3), np.uint8))
    made = source(folder, decisions=1)
    with pytest.raises(ValueError, match="must have the same size"):
        for step in range(30):
            batch(made, step)


def test_question_is_compared_quickly_and_exactly(folder):
    def set_question(text):
        rewrite(folder, lambda e: e["conversations"][0].update(value=text))

    start, end = TASK.split("{instruction}")
    set_question(start + " " * 200_000 + "!")
    began = time.monotonic()
    with pytest.raises(ValueError, match="does not fit"):
        source(folder)
    assert time.monotonic() - began < 2
    with pytest.raises(ValueError, match="exactly once"):
        source(folder, task="A {instruction} B {instruction} C")
    filled = end.replace("{answers}", ", ".join(f'"{a.text}"' for a in ANSWERS["navid"]))
    set_question(start + "go \ud83d on" + filled)
    with pytest.raises(ValueError, match="line 1: .*surrogates not allowed"):
        source(folder)
    set_question(start + "x" * 100_001 + filled)
    with pytest.raises(ValueError, match="at most 100,000 characters"):
        source(folder)


def test_unreadable_file_is_named(folder):
    file = folder / CONVERSATIONS
    file.write_bytes(b"\xff\xfe{}\n")
    with pytest.raises(ValueError, match="conversations.jsonl, line 1: .*can't decode"):
        source(folder)
    file.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n", "utf-8")
    with pytest.raises(ValueError, match="lfs"):
        source(folder)


@pytest.mark.slow
def test_recipe_trains_on_conversations(folder, tmp_path, monkeypatch):
    model = write_model(tmp_path / "model", "idefics3")
    options = [
        "recipe=conversations",
        f"agent.model={model}",
        f"stages.imitation.recipe.folder={folder}",
    ]
    options += ["agent.lora.r=2", "agent.lora.language=[q_proj]", "rollouts=4", "workers=0"]
    options += ["trainer.steps=2", "evaluation.enabled=false", f"folder={tmp_path / 'run'}"]
    monkeypatch.setattr(sys, "argv", ["mitigate", *options])
    train.main()
    assert (tmp_path / "run/agent/adapter_config.json").is_file()
    other = ["recipe=conversations", "agent=recurrent", options[2], "evaluation.enabled=false"]
    monkeypatch.setattr(sys, "argv", ["mitigate", *other, f"folder={tmp_path / 'other'}"])
    with pytest.raises(SystemExit, match="Only vision-language agents learn from conversations"):
        train.main()
