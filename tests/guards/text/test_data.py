"""Tests that training texts are varied and exclude test texts, and tests of reading chat files."""

from __future__ import annotations

import gzip
import json
import re

import pytest

from mitigate.core.seeding import generator
from mitigate.corruptions.instruction import prefixes
from mitigate.corruptions.language.style import MANNERS
from mitigate.guards.text.learning import data, routes
from mitigate.guards.text.learning.data import KINDS, Pair, draw_pair, read_chats
from mitigate.worlds.apartments.instructions import TEMPLATES
from mitigate.worlds.episodes import read_episodes

SIZE = 2000

pytestmark = pytest.mark.xdist_group("pairs")  # all tests use the same samples


@pytest.fixture(scope="module")
def pairs() -> list[Pair]:
    return [draw_pair(0, index) for index in range(500)]


def plain(text: str) -> str:
    return " ".join(re.findall(r"[a-z]+", text.lower()))


def test_draw_route_uses_no_validation_phrase():
    everything = "\n".join(f" {plain(routes.draw_route(generator(1, i)))} " for i in range(SIZE))
    for split in ("val_seen", "val_unseen"):
        for kind, phrases in TEMPLATES[split].items():
            for phrase in phrases if kind != "join" else ():
                parts = [f" {plain(part)} " for part in re.split(r"\{\w+\}", phrase)]
                content = "(?:[a-z]+ ){1,3}?".join(part.lstrip() for part in parts)
                assert not re.search(f" {content}", everything), phrase


def test_overlaps_validation_finds_validation_instructions():
    listed = read_episodes("mitigate/worlds/apartments/episodes/val_unseen_vln.json.gz")
    assert all(routes.overlaps_validation(episode.instruction.text) for episode in listed)
    assert not routes.overlaps_validation("Leave the pantry and veer left at the piano.")


def test_draw_pair_uses_no_held_out_attack(pairs):
    bank = [s for split in ("validation", "test") for g in prefixes(split).values() for s in g]
    texts = " ".join(plain(f"{pair.source} {pair.target}") for pair in pairs)
    assert not [sentence for sentence in bank if plain(sentence) in texts]


def test_draw_pair_uses_no_held_out_style_phrase(pairs):
    assert all(len(data.held_out(manner)) >= 2 for manner in MANNERS)
    for pair in pairs:
        if pair.kind == "style":
            assert not all(data.holds_held_out(pair.source, manner) for manner in MANNERS)


def test_draw_route_is_varied():
    texts = [routes.draw_route(generator(2, i)) for i in range(SIZE)]
    assert len(set(texts)) > 0.97 * SIZE
    sizes = [len(text.split()) for text in texts]
    assert min(sizes) <= 4 and max(sizes) >= 60
    openings = {" ".join(text.lower().split()[:2]) for text in texts}
    assert len(openings) > 100
    assert any(text != text.lower() for text in texts) and any(t == t.lower() for t in texts)


def test_draw_pair_depends_on_seed_and_index_alone(pairs):
    for kind, share in KINDS.items():
        matches = sum(pair.kind == kind for pair in pairs) / len(pairs)
        assert abs(matches - share) < 0.05
    assert draw_pair(0, 300) == pairs[300] and draw_pair(1, 300) != pairs[300]


def test_draw_pair_targets_fit_their_kind(pairs):
    assert all(p.source == p.target for p in pairs if p.kind == "identity")
    attacked = [p for p in pairs if p.kind == "black_box"]
    before_plain = sum(p.source.endswith(p.target) for p in attacked) / len(attacked)
    # the other attacks precede a spoken passage, and the target is the plain text of this passage
    assert 0.6 < before_plain < 0.95
    assert 0.1 < sum(not p.target for p in attacked) / len(attacked) < 0.5


def test_draw_pair_uses_texts_of_the_user():
    mine = ["Swagger by the xylophone, then sashay up to the zebra statue."]
    pairs = [draw_pair(0, index, mine, 0.5) for index in range(200)]
    matches = sum("xylophone" in p.source.lower() or "zebra" in p.source.lower() for p in pairs)
    assert 50 < matches < 130


def test_read_chats_returns_the_written_pairs(tmp_path, pairs):
    lines = []
    for pair in pairs[:20]:
        texts = [("system", "Repair."), ("user", pair.source), ("assistant", pair.target)]
        messages = [{"role": role, "content": content} for role, content in texts]
        lines.append(json.dumps({"messages": messages, "kind": pair.kind}))
    with gzip.open(tmp_path / "a.jsonl.gz", "wt", encoding="utf-8") as file:
        file.write("\n".join(lines))
    assert list(read_chats(tmp_path / "a.jsonl.gz")) == pairs[:20]


USER, ASSISTANT = {"role": "user", "content": "Go."}, {"role": "assistant", "content": "Go."}


@pytest.mark.parametrize(
    "line, problem",
    [
        ("{", "is no chat (JSONDecodeError"),
        ("[" * 100_000, "is no chat (RecursionError"),
        ("[1]", "is no chat"),
        ('{"messages": {}}', "not one user and one assistant"),
        (json.dumps({"messages": ["hello"]}), "is no chat"),
        (json.dumps({"messages": [{"role": "user"}]}), "is no chat (KeyError: 'content')"),
        (
            json.dumps({"messages": [{"role": "boss", "content": "x"}]}),
            "roles ['boss'], not one user",
        ),
        (json.dumps({"messages": [USER, {**ASSISTANT, "content": 3}]}), "content that is not text"),
        (json.dumps({"messages": [USER]}), "not one user and one assistant"),
        (json.dumps({"messages": [ASSISTANT, USER]}), "not one user and one assistant"),
        (json.dumps({"messages": [{**USER, "content": "  "}, ASSISTANT]}), "empty user text"),
    ],
)
def test_read_chats_names_a_malformed_line(tmp_path, line, problem):
    good = json.dumps({"messages": [USER, ASSISTANT]})
    path = tmp_path / "chats.jsonl"
    path.write_text(f"{good}\n\n{line}\n")
    chats = read_chats(path)
    assert next(chats) == Pair("Go.", "Go.", "chat")
    with pytest.raises(ValueError, match=f"line 3 .*{re.escape(problem)}.*Fix or delete"):
        list(chats)
