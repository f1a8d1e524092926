"""Tests of episodes that are written as conversations."""

from __future__ import annotations

import json

import cv2
import numpy as np

from mitigate.agents.vlm.dataset import CONVERSATIONS, write_conversations
from tests.agents.vlm.corridor import Corridor, episode


def test_conversations_hold_the_experts_answers_and_its_frames(tmp_path):
    text = 'Walk to "{answers}".'
    count = write_conversations(
        Corridor(), [episode(1, 6, text), episode(3, 2)], tmp_path, history=1
    )
    lines = [
        json.loads(line) for line in (tmp_path / CONVERSATIONS).read_text("utf-8").splitlines()
    ]
    assert count == len(lines) == 5
    assert [line["conversations"][1]["value"] for line in lines] == [
        "forward 75 cm", "forward 50 cm", "stop", "turn left 15 degrees", "stop",
    ]  # fmt: skip
    assert [len(line["images"]) for line in lines] == [1, 2, 2, 1, 2]
    question = lines[2]["conversations"][0]
    assert question["from"] == "human" and text in question["value"]
    assert question["value"].count("<image>") == 2
    world = Corridor()
    world.reset(episode(1, 6))
    world.cell = 4
    stored = cv2.imread(str(tmp_path / lines[2]["images"][0]))[..., ::-1]
    assert np.array_equal(stored, world.render())
