"""A stand-in of habitat-sim's structure, for tests of programs without the lab."""

from habitat_sim.simulator import Simulator

__all__ = ["Simulator"]
