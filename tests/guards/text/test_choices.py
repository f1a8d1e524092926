"""Safeguards are told apart in tables and in rows of results."""

from __future__ import annotations

import hashlib
import json

import pytest

from mitigate.core.files import find
from mitigate.corruptions.instruction import Key, corrupt_instruction
from mitigate.corruptions.suite import INSTRUCTION
from mitigate.guards.text import choices
from mitigate.guards.text.choices import VERSION, identity, label
from mitigate.guards.text.guard import open_safeguard
from mitigate.guards.text.language_models import adapter_folder
from mitigate.guards.text.texts import weights

SAID = "42c1ff6b2ef1"  # hash of what the rules of VERSION make of the texts below
TEXTS = (
    "Turn left at the red sofa, go through the door and stop in front of the sink.",
    "Look for the bed and wait next to it.",
    "Walk up the stairs, pass the paintings on your right, then wait by the second window.",
    "Find a chair.",
)


def _adapter(folder, weights):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "adapter_model.safetensors").write_bytes(weights)
    return str(folder)


def test_columns_tell_safeguards_apart(tmp_path):
    """Every trained adapter lies in a folder called agent."""
    first, second = (_adapter(tmp_path / run / "agent", b"a") for run in ("first", "second"))
    assert label(first).startswith("first-") and label(second).startswith("second-")
    before = label(first)
    _adapter(tmp_path / "first" / "agent", b"c")
    assert label(first) != before
    assert label("http://one:80/v1@m") == label("HTTP://one:80/v1@m") == "one-80-v1@m"
    assert [label(choice) for choice in ("rules", "lora")] == ["rules", "lora"]


def test_rows_tell_weights_of_the_rules_and_of_networks_apart(tmp_path, monkeypatch):
    names = ["rules", "tagger", "reader", "tagger+lora", _adapter(tmp_path / "mine", b"a")]
    before = [identity(name) for name in names]
    assert len(set(before)) == len(names) and identity("none") == "none"
    assert [identity(name) for name in names] == before
    _adapter(tmp_path / "mine", b"b")
    assert identity(names[-1]) != before[-1]
    rules = tmp_path / "rules.json"
    rules.write_text(weights.FILE.read_text() + " ")
    monkeypatch.setattr(weights, "USED", rules)
    assert not set(before) & {identity(name) for name in names}


def test_rows_tell_apart_how_answers_are_judged_where_a_language_model_gives_them(monkeypatch):
    names = ["rules", "tagger", "reader", "lora", "reader+lora", "http://one:80/v1@m"]
    before = [identity(name) for name in names]
    monkeypatch.setattr(choices, "ANSWERS", "another")
    assert [identity(name) == old for name, old in zip(names, before, strict=True)] == [
        *[True] * 3,
        *[False] * 3,
    ]


def test_an_opened_safeguard_says_what_it_is():
    assert open_safeguard("rules").identity == identity("rules")


def test_rules_that_say_something_else_have_another_version():
    """If this fails, and what the rules say was meant to change: raise VERSION, and put the new
    hash here, so that results of older rules are not continued."""
    rules, said = open_safeguard("rules"), []
    for name in INSTRUCTION:
        for n, text in enumerate(TEXTS * 5 if name != "white_box" else ()):
            heard = corrupt_instruction(text, name, 1.0, Key(0, str(n)))
            said.append(rules.canonicalise(heard).text)
    assert hashlib.sha256(json.dumps(said).encode()).hexdigest()[:12] == SAID, f"of {VERSION}"


@pytest.mark.parametrize("choice", ["", None, 5, "tagger+", "reader+"])
def test_what_names_no_safeguard_is_answered_with_the_choices(choice):
    with pytest.raises(ValueError, match=r"no safeguard .* one of: none, rules, .* folder"):
        open_safeguard(choice)


@pytest.mark.parametrize("first", ["", "tagger+", "reader+"])
def test_a_folder_without_weights_is_told_what_a_safeguards_folder_holds(tmp_path, first):
    (tmp_path / "config.yaml").write_text("agent: {}")
    said = r"no safeguard in .* holds model\.safetensors of a tagger or a reader .*, or card\.json"
    with pytest.raises(FileNotFoundError, match=said):
        open_safeguard(f"{first}{tmp_path}")


def test_weights_of_another_network_are_told_what_a_safeguards_folder_holds():
    with pytest.raises(ValueError, match="of another network.* of a tagger or a reader"):
        open_safeguard(str(find("checkpoints/base")))


def test_an_adapter_that_lacks_files_names_them(tmp_path):
    (tmp_path / adapter_folder.CONFIG).write_text("{}")
    with pytest.raises(FileNotFoundError, match="adapter_model.safetensors missing"):
        open_safeguard(str(tmp_path))


def test_a_folder_that_holds_two_safeguards_is_refused(tmp_path):
    """It was known by the one and opened as the other."""
    (tmp_path / "model.safetensors").write_bytes(b"a")
    for ask in (open_safeguard, identity, label):
        _adapter(tmp_path, b"a")
        with pytest.raises(ValueError, match="holds two safeguards, model.safetensors of"):
            ask(str(tmp_path))


@pytest.mark.parametrize("first", ["tagger", "reader"])
def test_behind_a_tagger_stands_no_other_tagger(first):
    folder = find("checkpoints/safeguard_tagger")
    with pytest.raises(ValueError, match=rf"Behind {first}\+ .* holds a tagger or a reader"):
        choices.check(f"{first}+{folder}")


def _weights_with(change):
    found = json.loads(weights.FILE.read_text("utf-8"))
    change(found)
    return json.dumps(found)


@pytest.mark.parametrize(
    "text, said",
    [
        ("{", "damaged"),
        ("[]", "must hold own, context"),
        (_weights_with(lambda found: found.pop("front")), "must hold own, context"),
        (_weights_with(lambda found: found["own"].pop("bias")), "own has or lacks bias"),
        (_weights_with(lambda found: found["part"].update(bias="1")), "part must be numbers"),
        (_weights_with(lambda found: found["words"].update(go=float("nan"))), "damaged .NaN"),
        (_weights_with(lambda found: found.update(style="hi")), "style must be a list"),
    ],
    ids=["cut", "list", "no front", "no bias", "text", "NaN", "no style"],
)
def test_weights_of_the_rules_that_are_none_say_how_to_write_some(tmp_path, text, said):
    file = tmp_path / "rules.json"
    with pytest.raises(FileNotFoundError, match="fit --split tune > tune.json"):
        weights.read_weights(file)
    file.write_text(text)
    with pytest.raises(ValueError, match=rf"{said}(?s:.*)fit --split tune > tune.json"):
        weights.read_weights(file)
