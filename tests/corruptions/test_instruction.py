"""Tests of instruction corruptions: no change at s = 0, more changes at higher s, random keys, and
protected words."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from hashlib import sha256
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitigate.corruptions import (
    INSTRUCTION,
    SUITE_VERSION,
    Corruption,
    Key,
    NotApplicable,
    corrupt_instruction,
    inject_system_prompt,
)
from mitigate.corruptions.instruction import SPLITS, prefixes
from mitigate.corruptions.language import words
from mitigate.corruptions.language.fidelity import check
from mitigate.corruptions.language.style import MANNERS, restyle
from mitigate.corruptions.language.tagger import tag, tokens

SPOKEN = tuple(name for name in INSTRUCTION if name != "white_box")
TEXT = (
    "Walk past the big red sofa and turn left at the second door. Go up the stairs, "
    "then stop next to the small lamp on your right."
)
KEY = Key(3, "17")
PIECES = (
    *("and", "then", ",", ".", ";", "at the", "once you reach", "turn", "left", "right", "walk"),
    *("go", "past", "sofa", "door", "stop", "please", "next", "first", "in", "I", "'", "-", "Exit"),
    *("out of", "up", "stairs", "around", "180 degrees", "two", "don't", "until", "{", "{rest}"),
)
SEVERITIES = [i / 20 for i in range(21)]
texts = st.text(max_size=200).map(lambda text: f"{text} go to the sofa")


@given(text=texts, name=st.sampled_from(SPOKEN), episode=st.text(max_size=5))
@settings(max_examples=200, deadline=None)
def test_severity_zero_changes_nothing_and_any_unicode_passes(text, name, episode):
    key = Key(0, episode)
    assert corrupt_instruction(text, name, 0.0, key) == text
    for severity in (0.5, 1.0):
        changed = corrupt_instruction(text, name, severity, key)
        assert changed == corrupt_instruction(text, name, severity, key)
        assert changed.encode("utf-8", "surrogatepass")


@pytest.mark.slow
@given(
    chosen=st.lists(st.sampled_from(PIECES), min_size=1, max_size=25).filter(
        lambda chosen: any(piece[-1].isalnum() for piece in chosen)
    ),
    manner=st.sampled_from(MANNERS),
)
@settings(max_examples=300, deadline=None)
def test_rewriter_and_gate_accept_any_words(chosen, manner):
    text = " ".join(chosen)
    assert check(text, text) == []
    assert check(text, corrupt_instruction(text, manner, 1.0, KEY)) == []


@pytest.mark.parametrize("name", SPOKEN)
def test_full_severity_changes_text_by_its_key(name):
    changed = {corrupt_instruction(TEXT, name, 1.0, Key(0, str(i))) for i in range(8)}
    assert TEXT not in changed
    assert len(changed) == (1 if name in ("capitalize", "mask") else len(changed)) and changed
    halves = {corrupt_instruction(TEXT, name, 0.5, Key(0, str(i))) for i in range(30)}
    assert len(halves) > 5


@pytest.mark.parametrize("name", ["capitalize", "mask"])
def test_changes_are_nested_in_severity(name):
    before: set[int] = set()
    for severity in SEVERITIES:
        got = tokens(corrupt_instruction(TEXT, name, severity, KEY))
        changed = {
            i for i, (a, b) in enumerate(zip(tokens(TEXT), got, strict=True)) if a.text != b.text
        }
        assert before <= changed
        before = changed
    assert len(before) > 5


@pytest.mark.slow
def test_styles_reach_their_share_and_stay():
    for manner in MANNERS:
        hit: set[int] = set()
        for severity in (0.2, 0.5, 0.8, 1.0):
            got = {
                i
                for i in range(200)
                if corrupt_instruction(TEXT, manner, severity, Key(0, str(i))) != TEXT
            }
            assert hit <= got and abs(len(got) / 200 - severity) < 0.1
            hit = got
        assert len(hit) == 200


@pytest.mark.parametrize("split", SPLITS)
def test_prefixes_stack_in_front_and_leave_the_instruction_alone(split):
    bank = [s for sentences in prefixes(split).values() for s in sentences]
    before = ""
    for severity in SEVERITIES[1:]:
        got = corrupt_instruction(TEXT, "black_box", severity, KEY, split=split)
        assert got.endswith(" " + TEXT)
        front = got.removesuffix(" " + TEXT)
        assert front.startswith(before) and any(front.endswith(s) for s in bank)
        before = front
    used = [s for s in bank if s in before]
    assert len(used) == len(prefixes(split))  # one injected prefix of each family
    least = corrupt_instruction(TEXT, "black_box", 1e-9, KEY, split=split)
    assert sum(s in least for s in bank) == 1


def test_families_and_sentences_are_in_one_split():
    banks = [prefixes(split) for split in SPLITS]
    families = [family for bank in banks for family in bank]
    sentences = [s for bank in banks for group in bank.values() for s in group]
    assert len(families) == len(set(families)) == 13
    assert len(sentences) == len({s.lower() for s in sentences}) >= 100
    assert all(len(group) >= 8 for bank in banks for group in bank.values())


def test_capitals_stress_what_is_eligible_and_nothing_else():
    got = corrupt_instruction(TEXT, "capitalize", 1.0, KEY)
    assert got.lower() == TEXT.lower()
    for old, new in zip(tag(TEXT), tokens(got), strict=True):
        stressed = old.tag in ("NOUN", "PROPN", "VERB", "ADP")
        assert new.text == (old.text.upper() if stressed else old.text)


@given(
    chosen=st.lists(
        st.sampled_from([*sorted(words.SPATIAL), "the", "a", "sofa", "red", "and", "your", "walk"]),
        min_size=1,
        max_size=30,
    )
)
@settings(max_examples=200, deadline=None)
def test_masks_never_hide_a_word_that_says_where(chosen):
    text = " ".join(chosen)
    masked = tokens(corrupt_instruction(text, "mask", 1.0, KEY))
    for old, new in zip(tokens(text), masked, strict=True):
        if old.lower in words.SPATIAL or old.lower == "sofa":
            assert new.text == old.text
    assert {"left", "right", "forward", "through", "past", "not"} <= words.SPATIAL


@pytest.mark.parametrize(
    "text",
    [
        "It isn't there, won’t open and doesn't move; they aren't red, and you shouldn't stop.",
        "Neither the sofa nor the bed, nothing else.",
        "Go northward, southward, eastward and westward.",
        "Take the same door as on the previous floor, only the preceding one, and the following.",
    ],
)
def test_masks_keep_negations_compass_words_and_choices(text):
    remaining = words.bag(
        "isn't won't doesn't aren't shouldn't neither nor nothing same previous only"
    )
    remaining |= words.bag("northward southward eastward westward preceding following")
    masked = tokens(corrupt_instruction(text, "mask", 1.0, KEY))
    for old, new in zip(tokens(text), masked, strict=True):
        assert new.text == old.text or old.lower not in remaining
    assert "[MASK]" in [token.text for token in masked]


def test_masks_write_the_tokenizers_own_mask_token():
    got = corrupt_instruction(TEXT, "mask", 1.0, KEY, mask_token="<mask>")
    assert "<mask>" in got and "[MASK]" not in got and "left" in got and "sofa" in got
    with pytest.raises(ValueError, match="mask_token must not be empty"):
        corrupt_instruction(TEXT, "mask", 1.0, KEY, mask_token=" ")


@pytest.mark.slow
def test_text_is_equal_in_another_process():
    program = (
        "from mitigate.corruptions import *;"
        f"print([corrupt_instruction({TEXT!r}, n, 0.7, Key(3, '17')) for n in {SPOKEN!r}])"
    )
    message = {
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert message == {f"{[corrupt_instruction(TEXT, name, 0.7, KEY) for name in SPOKEN]}\n"}


@pytest.mark.parametrize("text", ["", "  \n", "...", "🙂", "\x00\x07"])
@pytest.mark.parametrize("name", SPOKEN)
def test_instruction_without_a_word_is_rejected(text, name):
    with pytest.raises(ValueError, match="The instruction must contain a word"):
        corrupt_instruction(text, name, 0.5, KEY)


@pytest.mark.slow
@pytest.mark.parametrize("name", SPOKEN)
def test_long_instruction_with_emoji_and_controls_is_corrupted(name):
    text = "Turn left 🙂 at the\x07 sofa and go\u200b on. " * 1100
    assert corrupt_instruction(text, name, 1.0, KEY) != text


@pytest.mark.parametrize("space", [" ", "\n", "\t "])
def test_long_white_space_takes_no_time(space):
    text = "Turn left{0}at the sofa,{0}then{0},{0}now{0}walk{0}and stop.".format(space * 1500)
    start = time.process_time()
    for manner in MANNERS:
        corrupt_instruction(text, manner, 1.0, KEY)
    assert time.process_time() - start < 2.0


def test_wrong_options_name_the_right_ones():
    with pytest.raises(ValueError, match="Did you mean formal"):
        corrupt_instruction(TEXT, "formel", 0.5, KEY)
    with pytest.raises(ValueError, match="from 0 .clean. to 1"):
        corrupt_instruction(TEXT, "mask", 1.5, KEY)
    with pytest.raises(ValueError, match="train, validation, test"):
        corrupt_instruction(TEXT, "black_box", 0.5, KEY, split="tset")
    with pytest.raises(ValueError, match="inject_system_prompt"):
        corrupt_instruction(TEXT, "white_box", 0.5, KEY)
    with pytest.raises(ValueError, match="key must be a Key.*whole number.*text"):
        corrupt_instruction(TEXT, "mask", 0.5, None)


@pytest.mark.parametrize(("short", "key"), [(7, Key(7, "0")), ("kitchen", Key(0, "kitchen"))])
def test_number_or_text_is_a_valid_key(short, key):
    for name in SPOKEN:
        output = corrupt_instruction(TEXT, name, 0.6, short)
        assert output == corrupt_instruction(TEXT, name, 0.6, key)
    prompt = "Do: {task}"
    assert inject_system_prompt(prompt, 0.6, short) == inject_system_prompt(prompt, 0.6, key)
    with pytest.raises(ValueError, match="key must be a Key"):
        inject_system_prompt(prompt, 0.6, 1.5)


def test_style_of_text_without_a_word_is_rejected():
    with pytest.raises(ValueError, match="The instruction must contain a word"):
        restyle(" ... ", "formal", KEY)


def test_white_box_precedes_the_task_and_never_runs_clean():
    prompt = "You are a robot.\nTask: {instruction}\nAnswer."
    got = inject_system_prompt(prompt, 0.5, KEY)
    front = corrupt_instruction("x", "black_box", 0.5, KEY).removesuffix(" x")
    assert got == prompt.replace("{instruction}", front + "\n{instruction}")
    assert inject_system_prompt("You are a robot.", 0.5, KEY) == f"You are a robot.\n{front}"
    assert inject_system_prompt(prompt, 0.0, KEY) == prompt
    for severity in (0.0, 0.5):
        assert isinstance(inject_system_prompt(None, severity, KEY), NotApplicable)


def test_suite_lists_the_families():
    assert Corruption("black_box", 0.5).modality == "instruction"
    assert len(INSTRUCTION) == 8 and set(MANNERS) < set(INSTRUCTION)


def test_words_match_the_suite_version():
    """If the corrupted texts change, results change, and SUITE_VERSION must be increased."""
    path = Path(__file__).parents[1] / "guards/text/handwritten.txt"
    texts = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    lines_of_text = [
        corrupt_instruction(text, name, severity, Key(0, str(index)))
        for name in SPOKEN
        for severity in (0.5, 1.0)
        for index, text in enumerate(texts)
    ]
    assert SUITE_VERSION == "1.1"
    assert sha256("\n".join(lines_of_text).encode()).hexdigest()[:16] == "b3888f3e739f9bda"
