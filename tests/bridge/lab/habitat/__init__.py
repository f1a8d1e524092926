"""A stand-in of habitat-lab's structure, for tests: its calls, in its order, over a tiny world.

Python 3.6 to 3.13. What the bridge wraps is where the lab has it (0.1.5 to 0.3): a simulator's
sensor suite and a task's are of one class, a task resets the simulator, an Env updates measures.
"""

from habitat.core.env import Env

__all__ = ["Env"]
