"""Tests of objects that are built from a config: their values, and how often they are built."""

from __future__ import annotations

import pickle

import pytest
import torch
import yaml
from omegaconf import OmegaConf

from mitigate.agents import building
from mitigate.core import build, checkpoint


class Engine:
    pass


class Car:
    def __init__(self, engine: Engine, doors: int = 4) -> None:
        self.engine, self.doors = engine, doors


class Garage:
    def __init__(self, car, size: int) -> None:
        self.cars, self.size = [car() for _ in range(size)], size


CAR = {
    "_target_": f"{__name__}.Car",
    "_partial_": True,
    "engine": {"_target_": f"{__name__}.Engine"},
    "doors": "${doors}",
}


def test_maker_results_share_nothing():
    """Each world that runs in parallel must have its own environment."""
    cfg = OmegaConf.create({"doors": 2, "car": CAR})
    make = pickle.loads(pickle.dumps(build.maker(cfg.car)))
    first, second = make(), make()
    assert first.doors == second.doors == 2 and first.engine is not second.engine


def test_partial_entry_becomes_a_function():
    cfg = OmegaConf.create({"doors": 3, "garage": {"_target_": f"{__name__}.Garage", "car": CAR}})
    output = build.build(cfg.garage, size=2)
    assert output.cars[0].engine is not output.cars[1].engine and output.cars[1].doors == 3


def test_non_partial_entry_is_built():
    engine = {"_target_": f"{__name__}.Engine", "_partial_": False}
    cfg = OmegaConf.create({"_target_": f"{__name__}.Car", "engine": engine})
    assert isinstance(build.build(cfg).engine, Engine)


@pytest.mark.parametrize("target", [f"{__name__}.Cart", "no_such_module.Car"])
def test_build_names_unimportable_targets(target):
    for make in (lambda: build.build(OmegaConf.create({"_target_": target})), build.locate):
        with pytest.raises(ValueError, match=f"{target}.* in the current folder, or on PYTH"):
            make(target) if make is build.locate else make()


class Gained(torch.nn.Module):
    """An agent with two settings that the weights do not contain; one of them has no default."""

    def __init__(self, gain: float, width: int = 2) -> None:
        super().__init__()
        self.gain, self.line = gain, torch.nn.Linear(width, 1)


@pytest.mark.parametrize(
    ("overrides", "gain"), [([], -1.0), (["agent=mine"], -1.0), (["agent.gain=2.0"], 2.0)]
)
def test_settings_of_weights_apply_unless_overridden(overrides, gain, tmp_path):
    """``agent=mine`` selects a config with the right class, but its values are not the values of
    the loaded agent."""
    target = f"{__name__}.Gained"
    checkpoint.save_weights(Gained(-1.0), tmp_path)
    settings = {"agent": {"_target_": target, "gain": -1.0, "width": 2}}
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(settings))
    here = 2.0 if "agent.gain=2.0" in overrides else 1.0
    node = OmegaConf.create({"_target_": target, "gain": here, "width": 2})
    matches = building.settings_of(node, str(tmp_path), overrides)
    assert building.build_agent(matches, weights=str(tmp_path), seed=0).gain == gain
