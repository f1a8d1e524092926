"""Tests that splits have no common layout, palette or template, and that episode lists can be
generated again."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest

from mitigate.agents.text import UNKNOWN, Vocabulary
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.instructions import TEMPLATES
from mitigate.worlds.apartments.palette import SEED_RANGES, SPLITS, palette, split_of
from mitigate.worlds.apartments.tasks import (
    LONGEST,
    SHORTEST,
    TASKS,
    DrawnEpisodes,
    fixed_episodes,
    load_episodes,
)
from mitigate.worlds.episodes import to_json

PAIRS = list(itertools.combinations(SPLITS, 2))
LISTS = list(itertools.product(("val_seen", "val_unseen"), TASKS))


@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_seed_ranges_do_not_overlap(a, b):
    (low_a, high_a), (low_b, high_b) = SEED_RANGES[a], SEED_RANGES[b]
    assert high_a <= low_b or high_b <= low_a


def test_split_of_follows_the_seed_ranges():
    for split, (low, high) in SEED_RANGES.items():
        assert {split_of(low), split_of(high - 1), Apartment(low).split} == {split}
    with pytest.raises(ValueError, match="train 0-99999, val_seen 100000-109999"):
        split_of(150_000)


@pytest.mark.slow
@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_layouts_differ_between_seeds(a, b):
    def plans(split):
        low = SEED_RANGES[split][0]
        return {tuple(r.rect for r in Apartment(seed).rooms) for seed in range(low, low + 12)}

    assert len(plans(a)) == 12 and not plans(a) & plans(b)


@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_palettes_share_no_colour(a, b):
    one, two = palette(a), palette(b)
    for name in one.colours:
        assert not rows(one.colours[name]) & rows(two.colours[name])
    assert not rows(one.walls) & rows(two.walls) and not rows(one.floors) & rows(two.floors)


def rows(colours: np.ndarray) -> set[tuple]:
    return {tuple(row) for row in np.rint(colours * 255).astype(int)}


@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_templates_share_no_phrase(a, b):
    for event in TEMPLATES[a].keys() - {"join"}:
        assert not set(TEMPLATES[a][event]) & set(TEMPLATES[b][event])


def test_validation_words_occur_in_training():
    for split in ("val_seen", "val_unseen"):
        for phrase in itertools.chain(*TEMPLATES[split].values()):
            words = re.findall(r"[a-z]+", re.sub(r"\{.*?\}", " ", phrase))
            assert set(words) <= set(Vocabulary())


@pytest.mark.parametrize(("split", "task"), LISTS)
def test_shipped_list_has_300_episodes(split, task):
    episodes = load_episodes(split, task)
    low, high = SEED_RANGES[split]
    assert len({e.episode_id for e in episodes}) == len(episodes) == 300
    for episode in episodes:
        assert episode.scene_id.startswith(f"apartments/{split}/")
        assert low <= int(episode.scene_id[-6:]) < high
        assert SHORTEST / 1.09 < episode.geodesic_distance < LONGEST
        assert UNKNOWN not in Vocabulary().encode(episode.instruction.text)


@pytest.mark.parametrize(("split", "task"), LISTS)
def test_shipped_list_equals_generated_episodes(split, task):
    shipped = load_episodes(split, task)
    drawn = fixed_episodes(split, task, 12)
    assert [to_json(e) for e in drawn] == [to_json(e) for e in shipped[:12]]


def test_training_episode_depends_only_on_the_generator():
    def draw(seed):
        return DrawnEpisodes(3, 0.2).draw(np.random.default_rng(seed))

    assert draw(1) == draw(1) and len({draw(seed).instruction.text for seed in range(5)}) > 3
    assert all(draw(seed).scene_id.startswith("apartments/train/") for seed in range(5))
