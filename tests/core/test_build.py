"""What a config makes, and how often."""

from __future__ import annotations

import pickle

from omegaconf import OmegaConf

from mitigate.core import build


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


def test_what_a_maker_makes_shares_nothing_with_what_it_made_before():
    """As worlds do that are walked in lockstep: each has an environment of its own."""
    cfg = OmegaConf.create({"doors": 2, "car": CAR})
    make = pickle.loads(pickle.dumps(build.maker(cfg.car)))
    first, second = make(), make()
    assert first.doors == second.doors == 2 and first.engine is not second.engine


def test_an_entry_marked_partial_arrives_as_such_a_function():
    cfg = OmegaConf.create({"doors": 3, "garage": {"_target_": f"{__name__}.Garage", "car": CAR}})
    made = build.build(cfg.garage, size=2)
    assert made.cars[0].engine is not made.cars[1].engine and made.cars[1].doors == 3
