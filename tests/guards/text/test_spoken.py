"""Tests of hand-written texts in different styles."""

from __future__ import annotations

import numpy as np

from mitigate.core.files import find
from mitigate.guards.text.learning import spoken


def whole(parts: spoken.Parts) -> tuple[str, str]:
    """Return a text in its original style, and its plain translation."""
    return " ".join(said for said, _ in parts), " ".join(plain for _, plain in parts if plain)


def test_spoken_texts_leave_out_eight_styles():
    read = {whole(parts)[0] for parts in spoken.texts()}
    assert len(read) >= 1200
    for style in spoken.EXCLUDED:
        lines = (find(spoken.FOLDER) / f"{style}.jsonl").read_text(encoding="utf-8").splitlines()
        assert len(lines) > 10 and not any(said in line for line in lines for said in read)


def test_spoken_texts_have_plain_parts():
    for parts in spoken.texts():
        original, plain = whole(parts)
        assert plain and original != plain, parts
        assert all(said.strip() for said, _ in parts), parts


def test_passage_returns_neighbouring_parts_of_a_text():
    texts = [whole(parts) for parts in spoken.texts()]
    for seed in range(200):
        message, plain = spoken.passage(np.random.default_rng(seed))
        assert message and len(message.split()) <= 250
        full = next(translation for original, translation in texts if message in original)
        assert all(part in full for part in plain.split(". ")[:1] if part)
