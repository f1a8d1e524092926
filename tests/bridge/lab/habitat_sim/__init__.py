"""A fake habitat-sim for tests of programs that do not use habitat-lab."""

from habitat_sim.simulator import Simulator

__all__ = ["Simulator"]
