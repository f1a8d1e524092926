"""Parse the values of ``restore=``.

A value is the folder of a restorer, ``hold`` (``hold.py``), or a user's ``module:callable``
(``callables.py``). The suffixes in ``FOLDER:rgb`` and ``FOLDER:depth`` restrict the restorer to one
sensor. This module does not need torch.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from mitigate.core.names import name_of
from mitigate.core.observation import DEPTH, RGB

SENSORS = (RGB, DEPTH)
HOLD = "hold"
_CALLABLE = re.compile(r"([A-Za-z_][\w.]*):([A-Za-z_]\w*)(?:@(.+))?")


class CallableChoice(NamedTuple):
    """The parts of ``module:name@version``."""

    module: str
    name: str
    version: str | None


def parted(choice: str) -> tuple[str, str | None]:
    """Return the folder and the sensor to restore, or None for all sensors of the restorer."""
    folder, colon, sensor = str(choice).rpartition(":")
    return (folder, sensor) if colon and sensor in SENSORS else (str(choice), None)


def callable_of(choice: str) -> CallableChoice | None:
    """Return the parts of ``module:callable``, or None if ``choice`` names a folder.

    ``choice`` names a folder if this path exists, or if it has the form ``FOLDER:SENSOR``, as in
    ``FOLDER:rgb``.
    """
    match = _CALLABLE.fullmatch(choice)
    if match is None or match[2] in SENSORS or Path(choice).exists():
        return None
    return CallableChoice(*match.groups())


def label(choice: str) -> str:
    """Return the text that ``choice`` adds to a column name.

    For a folder, the text contains the folder's name and the sensor. For a callable, it contains
    the names of the module and the callable, and the version.
    """
    named = callable_of(str(choice))
    if named is not None:
        text = f"{named.module.rpartition('.')[2]}.{named.name}"
        text += "" if named.version is None else f"@{named.version}"
        return re.sub(r"[^\w.@-]+", "-", text)
    folder, sensor = parted(choice)
    return "-".join(filter(None, (name_of(folder), sensor)))
