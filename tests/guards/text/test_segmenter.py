"""Tests of the network that finds the attack span in a text, and of its training texts."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from mitigate.guards.text.features import FEATURES
from mitigate.guards.text.learning import segmentation
from mitigate.guards.text.learning.lines import Line
from mitigate.guards.text.learning.splices import fold_of, splices
from mitigate.guards.text.segmenter import INSIDE, NAMES, Segmenter


def network(seed: int = 0) -> segmentation.Network:
    torch.manual_seed(seed)
    return segmentation.Network().eval()


def values(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((count, FEATURES)).astype(np.float32)


@pytest.mark.parametrize("count", [2, 7])
def test_segmenter_computes_the_scores_of_the_trained_network(count):
    trained = network()
    clause, edge = Segmenter(trained.arrays()).scores(values(count))
    with torch.no_grad():
        one = trained(torch.from_numpy(values(count))[None], torch.tensor([count]))
    np.testing.assert_allclose(clause, one[0][0].numpy(), atol=1e-5)
    np.testing.assert_allclose(edge, one[1][0].numpy(), atol=1e-5)


def test_segmenter_averages_the_scores_of_several_networks():
    single = [network(seed).arrays() for seed in range(3)]
    several = Segmenter({name: np.concatenate([one[name] for one in single]) for name in NAMES})
    scores = [Segmenter(one).scores(values(7)) for one in single]
    for averaged, each in zip(several.scores(values(7)), zip(*scores, strict=True), strict=True):
        np.testing.assert_allclose(averaged, np.mean(each, 0), atol=1e-5)
    same = Segmenter({name: np.concatenate([single[0][name]] * 2) for name in NAMES})
    assert same.attack(values(7), 0.5) == pytest.approx(Segmenter(single[0]).attack(values(7), 0.5))
    none = {name: array.copy() for name, array in same.arrays.items()}
    none["net_none"][1] += 1.0
    assert Segmenter(none).attack(values(7), 0.5)[0] == pytest.approx(
        same.attack(values(7), 0.5)[0] - 0.5, abs=1e-4
    )


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("bonus", [0.0, 0.7])
def test_attack_returns_the_best_span_except_the_whole_text(seed, bonus):
    segmenter = Segmenter(network(seed).arrays())
    clause, edge = segmenter.scores(values(5, seed))
    edge[1:-1] += INSIDE
    spans = [(i, j) for i in range(5) for j in range(i, 5) if (i, j) != (0, 4)]

    def score(span, bonus):
        first, last = span
        return (clause[first : last + 1] + bonus).sum() + edge[first] + edge[last + 1]

    odds, first, last = segmenter.attack(values(5, seed), bonus)
    assert (first, last) == max(spans, key=lambda span: score(span, bonus))
    none = segmenter.arrays["net_none"].mean()
    assert odds == pytest.approx(
        np.logaddexp.reduce([score(s, 0.0) for s in spans]) - none, abs=1e-4
    )


def test_attack_finds_nothing_in_a_single_clause():
    assert Segmenter(network().arrays()).attack(values(1), 0.5)[0] == -np.inf


@pytest.mark.slow
def test_train_finds_marked_clauses(capsys):
    rng = np.random.default_rng(0)
    examples = []
    for _ in range(2000):
        attack = np.zeros(4, bool)
        if rng.random() < 0.5:
            attack[: rng.integers(1, 4)] = True
        features = 0.1 * rng.standard_normal((4, FEATURES)).astype(np.float32)
        features[attack, 0] += 3
        examples.append(segmentation.Example(features, attack))
    segmenter = Segmenter(segmentation.train(examples, 0))
    found = [segmenter.attack(example.features, 0.0) for example in examples]
    right = [
        (odds > 0, last + 1 if odds > 0 else 0) == (attack.any(), attack.sum())
        for (odds, _, last), attack in zip(found, (e.attack for e in examples), strict=True)
    ]
    assert np.mean(right) > 0.95 and capsys.readouterr().out.count("loss") == segmentation.EPOCHS


def test_splices_record_the_spans_of_attacks_and_keep_groups_in_folds():
    lines = [Line(f"attack number {i} zzz", True, f"a{i}") for i in range(40)]
    lines += [Line(f"Zzz before {{route}} zzz after {i}", True, f"w{i}") for i in range(40)]
    routes = [f"Turn left at lamp {i}, then walk on and stop by the bed." for i in range(80)]
    lines += [Line(text, False, f"r{i}") for i, text in enumerate(routes)]
    made = list(splices(lines, (["Hey!"], ["Now."]), 200))
    assert 0.25 < np.mean([not one.attacks for one in made]) < 0.55
    groups = {text.lower(): fold_of(line) for line, text in zip(lines[80:], routes, strict=True)}
    for one in made:
        rest, attacked = one.text, ""
        for start, end in reversed(one.attacks):
            attacked += one.text[start:end].lower()
            rest = rest[:start] + rest[end:]
        assert "zzz" not in rest.lower()
        assert "lamp" not in attacked and ("zzz" in attacked) == bool(one.attacks)
        for text, fold in groups.items():
            if text.rstrip(".") in one.text.lower():
                assert fold == one.fold
