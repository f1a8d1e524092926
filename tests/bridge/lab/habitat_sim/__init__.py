"""A stand-in for habitat-sim, for tests of programs without habitat-lab."""

from habitat_sim.simulator import Simulator

__all__ = ["Simulator"]
