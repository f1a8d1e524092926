"""What ``restore=`` names: the folder of a restorer, ``FOLDER:rgb`` for one of its sensors alone,
or ``module:callable`` of the user (``callables.py``). Needs no torch."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from mitigate.core.names import name_of
from mitigate.core.observation import DEPTH, RGB

SENSORS = (RGB, DEPTH)
_CALLABLE = re.compile(r"([A-Za-z_][\w.]*):([A-Za-z_]\w*)(?:@(.+))?")


class CallableChoice(NamedTuple):
    """``module:name@version``; ``version`` is None if it is not given."""

    module: str
    name: str
    version: str | None


def parted(choice: str) -> tuple[str, str | None]:
    """Return the folder, and the one sensor that is restored; None: all that it is for."""
    folder, colon, sensor = str(choice).rpartition(":")
    return (folder, sensor) if colon and sensor in SENSORS else (str(choice), None)


def callable_of(choice: str) -> CallableChoice | None:
    """Return the parts of ``module:callable``, None for a folder. A folder of this name comes
    first, and a name "rgb" or "depth" is a sensor of a folder."""
    match = _CALLABLE.fullmatch(choice)
    if match is None or match[2] in SENSORS or Path(choice).exists():
        return None
    return CallableChoice(*match.groups())


def label(choice: str) -> str:
    """Return what ``choice`` adds to a column's name: the folder's name and the sensor, or the
    names of the module and the callable and the version."""
    named = callable_of(str(choice))
    if named is not None:
        own = f"{named.module.rpartition('.')[2]}.{named.name}"
        own += "" if named.version is None else f"@{named.version}"
        return re.sub(r"[^\w.@-]+", "-", own)
    folder, sensor = parted(choice)
    return "-".join(filter(None, (name_of(folder), sensor)))
