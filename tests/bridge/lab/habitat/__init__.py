"""A stand-in for habitat-lab in tests: the same calls in the same order, in a tiny world.

Python 3.6 to 3.13. The bridge wraps the same methods here as in habitat-lab 0.1.5 to 0.3: the
sensor suites of simulator and task have one class, a task resets the simulator, and an Env updates
the measures.
"""

from habitat.core.env import Env

__all__ = ["Env"]
