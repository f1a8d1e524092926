"""What ``restore=`` names: a restorer's folder, or ``FOLDER:rgb`` for one of its sensors alone.

Without torch, for which nobody waits who only names it.
"""

from __future__ import annotations

from mitigate.core.observation import DEPTH, RGB

SENSORS = (RGB, DEPTH)


def parted(choice: str) -> tuple[str, str | None]:
    """The folder, and the one sensor that is restored; None: all that it is for."""
    folder, colon, sensor = str(choice).rpartition(":")
    return (folder, sensor) if colon and sensor in SENSORS else (str(choice), None)


def label(choice: str) -> str:
    """What it adds to a column's name: the folder's, and the sensor."""
    from mitigate.core.names import name_of

    folder, sensor = parted(choice)
    return "-".join(filter(None, (name_of(folder), sensor)))
