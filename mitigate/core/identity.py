"""What makes an agent the one that it is, as one hash: equal hash, equal behaviour.

A display name carries no identity. Rows of results hold the hash, so that an agent with one setting
changed, other words, or views of another size is another agent to every table and every resume.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from torch import nn

from mitigate.core.checkpoint import weights_sha
from mitigate.core.observation import Sensor

DIGITS = 12  # hex digits: 48 bits


def identity(agent: Any, sensors: Mapping[str, Sensor], front: str = "none") -> str:
    """Return the hash of ``agent`` behind ``sensors``.

    It covers the weights (names, types, shapes, values), the agent's class and ``settings()``
    (vocabulary and all else that is no weight), what each sensor gives, and what stands in front of
    the agent (``front``: the safeguard that repairs its instructions).
    """
    held = {
        "class": type(agent).__qualname__,
        "weights": weights_sha(agent) if isinstance(agent, nn.Module) else "",
        "settings": getattr(agent, "settings", dict)(),
        "sensors": {name: asdict(sensor) for name, sensor in sorted(sensors.items())},
        "front": front,
    }
    text = json.dumps(held, sort_keys=True, default=list)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]
