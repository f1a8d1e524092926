"""Measure the milliseconds of a call in the steady state, and of calls with new parameters.

Other programs can only make a call slower, so the time in the steady state is the minimum over
many equal calls. Calls with new random parameters take different times, so their median is used.
"""

from __future__ import annotations

import os
import platform
import re
import statistics
import time
from collections.abc import Callable
from datetime import date
from importlib import metadata
from pathlib import Path
from typing import Any

# number of different inputs that the timed calls use in turn
CYCLE = 8
LEAST = 5  # minimum number of measured calls, even if they take longer than the given time
PACKAGES = ("numpy", "numba", "opencv-python-headless", "torch")


def steady(call: Callable[[int], object], seconds: float) -> float:
    """Return the mean over i < ``CYCLE`` of the shortest time of ``call(i)``, in milliseconds."""
    fastest = [float("inf")] * CYCLE
    call(0)  # compiles
    end = time.perf_counter() + seconds
    rounds = 0
    while rounds < LEAST or time.perf_counter() < end:
        for i in range(CYCLE):
            fastest[i] = min(fastest[i], clock(call, i))
        rounds += 1
    return statistics.fmean(fastest)


def fresh(call: Callable[[int], object], seconds: float) -> float:
    """Return the median time in milliseconds of ``call(i)`` for increasing i."""
    call(0)
    end = time.perf_counter() + seconds
    times: list[float] = []
    while len(times) < LEAST or time.perf_counter() < end:
        times.append(clock(call, len(times) + 1))
    return statistics.median(times)


def clock(call: Callable[[Any], object], argument: Any) -> float:
    """Return the milliseconds of one call."""
    start = time.perf_counter()
    call(argument)
    return 1e3 * (time.perf_counter() - start)


def machine() -> str:
    """Return the processor, cores, load, date and versions of this measurement."""
    info = Path("/proc/cpuinfo")
    name = re.search(r"^model name\s*: (.*)$", info.read_text() if info.exists() else "", re.M)
    processor = name[1].strip() if name else platform.processor() or platform.machine()
    versions = {package: version(package) for package in PACKAGES}
    software = ", ".join(f"{package} {number}" for package, number in versions.items() if number)
    return (
        f"{processor}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {date.today()}; "
        f"Python {platform.python_version()}, {software}"
    )


def version(package: str) -> str | None:
    """Return the installed version of ``package``, or None if it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
