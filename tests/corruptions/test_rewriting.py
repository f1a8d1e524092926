"""Tests of rewriting by a model: prompts, cached answers, and a truncated cache."""

from __future__ import annotations

import json

import pytest

from mitigate.corruptions import Key, corrupt_instruction
from mitigate.corruptions.language.rewriting import PROMPT, TONES, Rewriter
from mitigate.corruptions.language.style import MANNERS

TEXT = "Turn left at the sofa\u2028 and stop."


class Model:
    """A model that returns a fixed rewrite and counts its calls."""

    def __init__(self, answer: str = "Hang a left at the couch, friend, and stop.") -> None:
        self.asked: list[tuple[str, str]] = []
        self.answer = answer

    def __call__(self, prompt: str, text: str) -> str:
        self.asked.append((prompt, text))
        return self.answer


def test_answer_is_asked_once_and_cached(tmp_path):
    model, cache = Model(), tmp_path / "sub/cache.jsonl"
    rewriter = Rewriter(model, "m", cache)
    texts = [rewriter(TEXT, "friendly") for _ in range(2)]
    assert texts == [model.answer] * 2
    assert model.asked == [(PROMPT.format(tone=TONES["friendly"]), TEXT)]
    silent = Model("never asked")
    assert Rewriter(silent, "m", cache)(TEXT, "friendly") == model.answer and not silent.asked


@pytest.mark.parametrize("change", [{"model": "other"}, {"seed": 1}])
def test_changed_model_seed_style_or_text_is_asked_again(tmp_path, change):
    cache = tmp_path / "cache.jsonl"
    Rewriter(Model(), "m", cache)(TEXT, "friendly")
    model = Model()
    rewriter = Rewriter(model, **{"model": "m", "cache": cache, "seed": 0} | change)
    rewriter(TEXT, "friendly")
    rewriter(TEXT, "formal")
    rewriter(TEXT + "!", "formal")
    assert len(model.asked) == 3


def test_cut_last_line_is_skipped_and_fixed(tmp_path):
    cache = tmp_path / "cache.jsonl"
    rewriter = Rewriter(Model(), "m", cache)
    rewriter(TEXT, "friendly")
    rewriter(TEXT, "formal")
    cache.write_bytes(cache.read_bytes()[:-20])
    model = Model()
    for _ in range(2):
        rewriter = Rewriter(model, "m", cache)
        assert rewriter(TEXT, "friendly") == rewriter(TEXT, "formal") == model.answer
    assert len(model.asked) == 1


@pytest.mark.parametrize("answer", [None, "", " \n", 7, "half \ud83d"])
def test_non_text_answer_is_reported_and_asked_again(tmp_path, answer):
    cache, model = tmp_path / "cache.jsonl", Model(answer)
    rewriter = Rewriter(model, "m", cache)
    for _ in range(2):
        with pytest.raises(ValueError, match="The model 'm' answered .* was not cached"):
            rewriter(TEXT, "friendly")
    assert len(model.asked) == 2 and not cache.exists()
    model.answer = "Hang a left."
    assert rewriter(TEXT, "friendly") == "Hang a left."


def test_cache_lines_without_answer_are_skipped(tmp_path):
    cache, model = tmp_path / "cache.jsonl", Model()
    Rewriter(model, "m", cache)(TEXT, "friendly")
    whole = json.loads(cache.read_text())
    bad = [json.dumps(whole | {"answer": answer}) for answer in (None, "", "\ud800", ["x"])]
    cache.write_bytes(b"\xff\xfe{\n" + b"[" * 100_000 + b"\n" + "\n".join(bad).encode() + b"\n")
    assert Rewriter(model, "m", cache)(TEXT, "friendly") == model.answer
    assert len(model.asked) == 2
    with pytest.raises(ValueError, match="got the folder"):
        Rewriter(model, "m", tmp_path)


def test_gate_checks_the_model(tmp_path):
    liar = Rewriter(Model("Turn right and walk 5 metres."), "liar", tmp_path / "cache.jsonl")
    message = corrupt_instruction(TEXT, "formal", 1.0, Key(0, "1"), rewrite=liar)
    assert "left" in message and "right" not in message
    with pytest.raises(ValueError, match="friendly, novice"):
        liar(TEXT, "rude")
    assert set(TONES) == set(MANNERS)
