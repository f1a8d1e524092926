"""Tests of the Habitat world with a fake simulator; whole episodes are tested by hand
(docs/habitat.md)."""

import json
import math
import pickle
from types import SimpleNamespace

import numpy as np
import pytest

from mitigate.core.build import maker
from mitigate.core.conf import load_config
from mitigate.core.observation import DEPTH, FORWARD, RGB, STOP
from mitigate.worlds import habitat_world, measures
from mitigate.worlds.habitat_world import NAVMESH, HabitatWorld


def world(*options):
    cfg = load_config("evaluate", ["env=habitat", *options])
    return maker(cfg.env.world)()


def test_config_makes_a_world_that_pickles(tmp_path):
    habitat = world(f"env.scenes={tmp_path}", "env.size=32", "env.rule=etpnav", "env.views=1")
    sent = pickle.loads(pickle.dumps(habitat))
    for each in (habitat, sent):
        assert each.sensors[RGB].shape == (32, 32, 3) and each.sensors[DEPTH].unit == "m"
        assert each.rule == "etpnav: geodesic <= 3.0 m, STOP or not"


def test_navmesh_settings_have_a_default_file(tmp_path):
    assert HabitatWorld(str(tmp_path / "scenes")).navmesh == NAVMESH
    (tmp_path / "navmesh.json").write_text(json.dumps({"agent_radius": 0.2, "camera_height": 1.0}))
    assert HabitatWorld(str(tmp_path / "scenes")).navmesh == {**NAVMESH, "agent_radius": 0.2}
    (tmp_path / "mine.json").write_text(json.dumps({"agent_height": 1.5}))
    named = world(f"env.scenes={tmp_path}/scenes", f"env.navmesh={tmp_path}/mine.json")
    assert named.navmesh == {**NAVMESH, "agent_height": 1.5}


@pytest.mark.parametrize(
    "value, words",
    [
        ({"rule": "etpnaw"}, "no success rule 'etpnaw'. Did you mean etpnav"),
        ({"rule": "objectnav"}, "no success rule 'objectnav'.*vln_ce.*no view points"),
        ({"rule": "wmnav"}, "view points"),
        ({"views": 4}, r"must be 12 \(panorama\) or 1"),
    ],
)
def test_habitat_world_rejects_invalid_arguments_first(value, words):
    with pytest.raises(ValueError, match=words):
        HabitatWorld("scenes", **value)


class Simulator:
    """A fake habitat-sim; ``walkable`` is true if a navmesh can be computed."""

    walkable, loaded = True, ""
    pathfinder = None

    def __init__(self, settings):
        self.reconfigure(settings)

    def reconfigure(self, settings):
        self.loaded = settings

    def recompute_navmesh(self, finder, settings):
        return self.walkable


def test_failed_scene_is_loaded_again(tmp_path, monkeypatch):
    for name in "ab":
        (tmp_path / f"{name}.glb").touch()
    habitat = HabitatWorld(str(tmp_path))
    settings = type(
        "S", (), {"set_defaults": lambda self: None, "agent_radius": 0, "agent_height": 0}
    )
    library = type("habitat_sim", (), {"Simulator": Simulator, "NavMeshSettings": settings})
    monkeypatch.setattr(habitat_world, "_habitat_sim", lambda: library)
    monkeypatch.setattr(habitat, "_settings", str)
    habitat._load_scene("a.glb")
    monkeypatch.setattr(Simulator, "walkable", False)
    with pytest.raises(ValueError, match=r"an empty navmesh for .*b\.glb"):
        habitat._load_scene("b.glb")
    monkeypatch.setattr(Simulator, "walkable", True)
    habitat._load_scene("a.glb")
    assert habitat._sim.loaded == str(tmp_path / "a.glb")


def started(rule, monkeypatch):
    """Return a Habitat world at the start of an episode; it has no simulator."""
    reported = SimpleNamespace(reference_path=[(0.0, 0.0, 0.0), (0.0, 0.0, -2.0)])
    habitat = HabitatWorld("scenes", rule=rule)
    vars(habitat).update(episode=reported, path=[np.zeros(3)], start_distance=2.0)
    vars(habitat).update(stopped=False, steps=0, collisions=0)
    monkeypatch.setattr(habitat, "distance_to_goal", lambda: 2.0)
    monkeypatch.setattr(habitat, "_observation", lambda: None)
    return habitat


@pytest.mark.parametrize("rule, metres", [("apartments", 2.0), ("vln_ce", 3.0)])
def test_ndtw_uses_the_metres_of_the_rule(rule, metres, monkeypatch):
    ndtw = started(rule, monkeypatch).measures()["ndtw"]
    assert ndtw == pytest.approx(math.exp(-2.0 / (2 * metres)), abs=1e-5)


def test_step_raises_after_stop(monkeypatch):
    habitat = started("vln_ce", monkeypatch)
    habitat.step(STOP)
    with pytest.raises(RuntimeError, match="over. Call reset"):
        habitat.step(FORWARD)
    assert habitat.done and habitat.steps == 1


def test_expert_stops_within_the_rule():
    assert measures.RULES["habitat_vln"].stop_within <= 0.2
    assert measures.RULES["vln_ce"].stop_within == measures.RULES["wmnav"].stop_within == 1.0
    assert measures.RULES["objectnav"].stop_within == 0.1
