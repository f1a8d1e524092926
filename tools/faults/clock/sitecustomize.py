"""Make the clock jump about once per second in each Python process whose PYTHONPATH contains this
folder.

``time.time`` jumps by up to a day in either direction, and ``time.monotonic`` does not jump. The
same happens when an administrator or NTP sets a machine's clock.
"""

import random
import time

_real_time = time.time
_rng = random.Random(0)


def _jumping_time() -> float:
    _rng.seed(int(time.monotonic()))
    return _real_time() + _rng.uniform(-86400.0, 86400.0)


time.time = _jumping_time
