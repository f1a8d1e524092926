"""Tests of success rules: the rule of a paper is selected by name, and every row contains its
rule."""

from __future__ import annotations

import hashlib
import math

import pytest

from mitigate.agents.topological.rollout import STOP_BEST, STOP_WITHIN
from mitigate.core.observation import FORWARD, STOP
from mitigate.worlds.apartments.tasks import load_episodes, view_points
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.measures import RULES


def test_etpnav_rule_includes_the_edge_without_stop():
    ours, theirs = RULES["vln_ce"], RULES["etpnav"]
    assert not ours.met(3.0, True) and ours.met(2.999, True) and not ours.met(2.0, False)
    assert theirs.met(3.0, False) and not theirs.met(3.001, True)
    with pytest.raises(ValueError, match="got nan"):
        theirs.met(math.nan, True)


def test_rows_say_which_rule_it_was():
    texts = [ApartmentsWorld(rule=name).rule for name in ("apartments", "etpnav", "objectnav")]
    assert texts == [
        "vln: STOP and geodesic < 2.0 m; SPL of any-angle paths",
        "etpnav: geodesic <= 3.0 m, STOP or not; SPL of any-angle paths",
        "objectnav: STOP and geodesic < 0.1 m to a view point; SPL of any-angle paths",
    ]
    with pytest.raises(ValueError, match="object_nav"):
        ApartmentsWorld(rule="object_nav")


def test_object_rule_accepts_any_view_point():
    episode = load_episodes("val_seen", "ogn")[0]
    world = ApartmentsWorld(rule="objectnav")
    world.reset(episode)
    space, beside = world.simulator.space, view_points(episode)
    assert len(beside) > len(episode.goals)
    world.simulator.xy = space.centre(
        max(beside, key=lambda i: world.expert().distance(space.centre(i)))
    )
    world.step(STOP)
    assert world.measures()["success"] == 1


def test_rule_without_stop_needs_only_distance():
    episode = load_episodes("val_seen")[0]
    for rule, won in (("apartments", 0), ("etpnav", 1)):
        world = ApartmentsWorld(rule=rule)
        world.reset(episode)
        goal = episode.goals[0].position
        world.simulator.xy = world.simulator.space.centre(
            world.simulator.space.cell_of((goal[0], -goal[2]))
        )
        world.step(FORWARD)
        assert world.measures()["success"] == won


@pytest.mark.parametrize("task", ["vln", "ogn"])
@pytest.mark.parametrize("rule", ["apartments", "habitat_vln", "objectnav", "wmnav"])
def test_expert_satisfies_the_rule(rule, task):
    world = ApartmentsWorld(rule=rule)
    for episode in load_episodes("val_unseen", task)[::60]:
        world.reset(episode)
        expert = world.expert()
        while not world.done:
            world.step(expert.action())
        assert world.measures()["success"] == 1


@pytest.mark.parametrize("rule, within", [("apartments", 1.0), ("objectnav", 0.1)])
def test_distances_follow_the_rule(rule, within):
    world = ApartmentsWorld(rule=rule)
    for episode in load_episodes("val_seen", "ogn")[:20:5]:
        world.reset(episode)
        at_once, reported = world.measures(), episode.geodesic_distance
        shortest = at_once["geodesic_distance"]  # in any direction; the other one in eight
        assert shortest < at_once["distance_to_goal"] < 1.09 * shortest
        assert (shortest == reported) == (rule == "apartments")
        while not world.done:
            world.step(world.expert().action())
        assert world.measures()["distance_to_goal"] < within
        assert world.measures()["spl"] <= 1


def test_ndtw_threshold_follows_the_rule():
    episode, loaded = load_episodes("val_seen")[0], {}
    for rule, metres in (("apartments", 2.0), ("vln_ce", 3.0), ("wmnav", 3.0), ("objectnav", 3.0)):
        world = ApartmentsWorld(rule=rule)
        world.reset(episode)
        loaded[rule] = -math.log(world.measures()["ndtw"]) * metres
    assert loaded["vln_ce"] == pytest.approx(loaded["apartments"], rel=1e-4)
    # the goals of these rules are view points, for which nDTW uses the threshold of VLN-CE
    for rule in ("wmnav", "objectnav"):
        assert loaded[rule] == pytest.approx(loaded["apartments"], rel=1e-4)


def test_expert_of_the_default_rule_is_unchanged():
    """The shipped rows and weights were made with these actions of the expert."""
    world, message = ApartmentsWorld(), []
    for episode in load_episodes("val_seen")[::60]:
        world.reset(episode)
        expert, actions = world.expert(), []
        while not world.done:
            actions.append(expert.action())
            world.step(actions[-1])
        message.append("".join(map(str, actions)))
    assert hashlib.sha256(" ".join(message).encode()).hexdigest()[:12] == "c20e5590c0de"
    assert all(expert.counts(metres) for metres in (STOP_WITHIN, STOP_BEST))
