"""The oracle of an episode in an apartment: it knows how far it is."""

from __future__ import annotations

import numpy as np

from mitigate.core.observation import FORWARD, FORWARD_METRES, LEFT, RIGHT, STOP, TURN_DEGREES
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.measures import Rule
from mitigate.worlds.world import Expert


class GeodesicExpert(Expert):
    """Distances and the greedy follower of a geodesic ``field``: it turns to the heading whose step
    lowers the distance most, and stops within what ``rule`` counts."""

    def __init__(self, simulator: Simulator, rule: Rule, field: np.ndarray) -> None:
        self.simulator, self.rule, self.field = simulator, rule, field

    def distance(self, xy: np.ndarray) -> float:
        return float(self.field[self.simulator.space.cell_of(xy)])

    def counts(self, metres: float) -> bool:
        return self.rule.met(metres, True)

    def action(self) -> int:
        simulator = self.simulator
        if self.distance(simulator.xy) < self.rule.stop_within:
            return STOP
        turns = sorted(range(-12, 13), key=abs)
        headings = [simulator.heading + np.radians(TURN_DEGREES) * turn for turn in turns]
        ends = [
            simulator.space.move(simulator.xy, heading, FORWARD_METRES)[0] for heading in headings
        ]
        best = turns[int(np.argmin([self.distance(end) for end in ends]))]
        return FORWARD if best == 0 else LEFT if best > 0 else RIGHT
