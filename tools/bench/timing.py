"""Clocks: milliseconds of a call in the steady state and of calls that each pay for something new.

A busy machine only ever makes a call slower. So the steady state is the fastest of many equal
calls; calls that each draw something new are not equal, and their median counts.
"""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable
from datetime import date
from importlib import metadata
from pathlib import Path

CYCLE = 8  # different calls in the steady state, such as the frames of an episode
LEAST = 5  # calls timed, however short the time
PACKAGES = ("numpy", "numba", "opencv-python-headless", "torch")


def steady(call: Callable[[int], object], seconds: float) -> float:
    """Milliseconds of ``call(i)``: the fastest time of each i < ``CYCLE``, averaged over them."""
    fastest = [float("inf")] * CYCLE
    call(0)  # compiles
    end, rounds = time.perf_counter() + seconds, 0
    while rounds < LEAST or time.perf_counter() < end:
        for i in range(CYCLE):
            fastest[i] = min(fastest[i], _clock(call, i))
        rounds += 1
    return statistics.fmean(fastest)


def fresh(call: Callable[[int], object], seconds: float) -> float:
    """Milliseconds of ``call(i)``, median over growing i: no i comes twice."""
    call(0)
    end, times = time.perf_counter() + seconds, list[float]()
    while len(times) < LEAST or time.perf_counter() < end:
        times.append(_clock(call, len(times) + 1))
    return statistics.median(times)


def _clock(call: Callable[[int], object], i: int) -> float:
    started = time.perf_counter()
    call(i)
    return 1e3 * (time.perf_counter() - started)


def machine() -> str:
    """Processor, cores, load, date and versions of this measurement."""
    names = [
        line.split(":")[1].strip()
        for line in _lines("/proc/cpuinfo")
        if line.startswith("model name")
    ]
    processor = names[0] if names else platform.processor() or platform.machine()
    found = {package: version(package) for package in PACKAGES}
    software = ", ".join(f"{package} {number}" for package, number in found.items() if number)
    return (
        f"{processor}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {date.today()}; "
        f"Python {platform.python_version()}, {software}"
    )


def version(package: str) -> str | None:
    """The installed version of ``package``, None if it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text().splitlines()
    except OSError:
        return []
