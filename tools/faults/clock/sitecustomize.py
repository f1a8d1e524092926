"""Loaded by a Python whose PYTHONPATH names this folder: its clock jumps about once a second.

``time.time`` jumps by up to a day either way; ``time.monotonic`` goes on, as when an administrator
or NTP sets a machine's clock.
"""

import random
import time

_true, _rng = time.time, random.Random(0)


def _jumping() -> float:
    _rng.seed(int(time.monotonic()))
    return _true() + _rng.uniform(-86400.0, 86400.0)


time.time = _jumping
