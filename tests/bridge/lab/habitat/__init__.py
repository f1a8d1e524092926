"""A fake habitat-lab for tests: it makes the same calls in the same order, in a tiny world.

The code runs on Python 3.6 to 3.13. The bridge wraps the same methods here as in habitat-lab 0.1.5
to 0.3. As in habitat-lab, the simulator and the task use the same sensor-suite class, a task resets
the simulator, and an Env updates the measures.
"""

from habitat.core.env import Env

__all__ = ["Env"]
