"""Measure whether the memory or the number of open files grows: ``python -m tools.bench.soak
--minutes 60``.

Training, evaluation and bridge traffic (``loads.py``) run one after the other (with ``--together``,
in parallel), each for ``--minutes``. Every few seconds, the tool records the memory (RSS) and the
number of open file descriptors of all their processes. The tool writes ``soak.csv``, ``soak.png``
and ``soak.md`` (slopes with 95 % intervals, and a result) to the output folder. Its exit status is
1 if a measure grows or a load ends early. It runs only on Linux.
"""

from __future__ import annotations

import argparse
import csv
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np

from mitigate.core.files import atomic_text, make_folder, write_bytes, write_figure
from mitigate.core.markdown import markdown_table
from mitigate.core.output import open_output
from mitigate.core.progress import Progress
from tools.bench.growth import DAY, LIMIT, Growth, growth
from tools.bench.loads import LOADS

PAGE = os.sysconf("SC_PAGE_SIZE")
MEASURES = ("RSS, MiB", "file descriptors")
COLUMNS = ("load", "seconds", "processes", "rss_mib", "descriptors")
GRACE = 60.0  # seconds after which a load that does not end is killed
Sample = tuple[float, int, float, int]  # the values of all COLUMNS except the first


def measured(pid: int) -> tuple[int, float, int]:
    """Return the number of processes, the memory (RSS, MiB) and the number of open files of ``pid``
    and its descendants.

    Shared memory is counted once for each process that uses it. Processes that end while they are
    counted are left out.
    """
    processes = 0
    memory = 0
    open_files = 0
    for member in family(pid):
        with suppress(OSError, IndexError, ValueError):
            folder = Path(f"/proc/{member}")
            pages = int((folder / "statm").read_text().split()[1])
            descriptors = len(os.listdir(folder / "fd"))
            processes += 1
            memory += pages
            open_files += descriptors
    return processes, memory * PAGE / 2**20, open_files


def family(pid: int) -> Iterator[int]:
    """Yield ``pid`` and all of its descendants."""
    yield pid
    for thread in Path(f"/proc/{pid}/task").glob("*"):
        with suppress(OSError):
            for child in (thread / "children").read_text().split():
                yield from family(int(child))


def watch(name: str, seconds: float, every: float, out: Path) -> tuple[list[Sample], str]:
    """Run a load; return its samples and, if it ended early, the last part of its output.

    Args:
        name: Name of the load.
        seconds: Duration.
        every: Seconds between two samples.
        out: File for the output of the load.
    """
    samples: list[Sample] = []
    with tempfile.TemporaryDirectory(prefix="soak-", dir=out) as folder:
        log = out / f"{name}.txt"
        with open_output(log, "w", encoding="utf-8") as log_file:
            process = subprocess.Popen(
                [sys.executable, "-m", "tools.bench.loads", name, str(Path(folder) / "load")],
                stdout=log_file,
                stderr=subprocess.STDOUT,
            )
        start = time.monotonic()
        try:
            with Progress(f"soak: {name}", round(seconds), unit="second") as progress:
                while (now := time.monotonic() - start) < seconds and process.poll() is None:
                    samples.append((now, *measured(process.pid)))
                    progress.advance(min(round(now), progress.total) - progress.done)
                    time.sleep(every)
            ended = process.poll() is not None
        finally:
            process.send_signal(signal.SIGTERM)
            with suppress(subprocess.TimeoutExpired):
                process.wait(GRACE)
            process.kill()
            process.wait()
        last = " ".join(log.read_text(encoding="utf-8", errors="replace").split("\n")[-4:])
    return samples, last[-400:] if ended else ""


def growth_by_measure(samples: Sequence[Sample]) -> dict[str, Growth]:
    """Return the growth of each measure."""
    hours = np.array([sample[0] for sample in samples]) / 3600
    return {
        name: growth(hours, np.array([sample[column] for sample in samples], float))
        for name, column in zip(MEASURES, (2, 3), strict=True)
    }


def table(by_load: dict[str, dict[str, Growth]], minutes: float) -> str:
    """Return a Markdown table with a row per load and measure."""
    caption = (
        f"{minutes:g} minutes each; slopes per hour after the first quarter, with 95 % intervals. "
        f'"grows": the lower end is above {100 * LIMIT:g} % of the mean in {DAY:g} hours; '
        '"flat": the upper end is not.'
    )
    rows = []
    for load, measures in by_load.items():
        for name, g in measures.items():
            slope = f"{g.slope:+.2f} [{g.low:+.2f}, {g.high:+.2f}]"
            rows.append([load, name, f"{g.mean:.1f}", slope, g.verdict])
    head = ("load", "measure", "mean", "slope per hour", "verdict")
    return f"{caption}\n\n{markdown_table(head, rows, words=2)}\n"


def draw(samples: dict[str, list[Sample]], out: Path) -> Path:
    """Write ``soak.png`` with both measures of each load over time; return its path."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4 * len(samples), 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, len(samples), squeeze=False, sharex="col")
    for column, (load, series) in enumerate(samples.items()):
        minutes = [sample[0] / 60 for sample in series]
        for row, (name, index) in enumerate(zip(MEASURES, (2, 3), strict=True)):
            axes[row, column].plot(minutes, [sample[index] for sample in series], linewidth=1)
            axes[row, column].set_ylim(bottom=0)
            axes[row, column].set_ylabel(name)
        axes[0, column].set_title(load)
        axes[1, column].set_xlabel("minutes")
    return write_figure(out / "soak.png", figure, dpi=100)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.soak", description=__doc__)
    add = parser.add_argument
    add("--minutes", type=float, default=60.0, help="per load (default 60)")
    add("--loads", nargs="+", default=list(LOADS), choices=list(LOADS))
    add("--every", type=float, default=2.0, help="seconds between two samples (default 2)")
    add("--together", action="store_true", help="all loads in parallel, on the same cores")
    add("--out", type=Path, default=Path("runs/soak"))
    options = parser.parse_args(arguments)
    if options.minutes <= 0 or options.every <= 0:
        parser.error(
            f"--minutes and --every must be > 0, got {options.minutes:g} and {options.every:g}."
        )
    make_folder(options.out)
    samples: dict[str, list[Sample]] = {}
    by_load: dict[str, dict[str, Growth]] = {}
    problems: list[str] = []

    def watch_load(load: str) -> tuple[list[Sample], str]:
        return watch(load, 60 * options.minutes, options.every, options.out)

    with ThreadPoolExecutor(len(options.loads) if options.together else 1) as pool:
        results = list(pool.map(watch_load, options.loads))
    for load, (series, last) in zip(options.loads, results, strict=True):
        samples[load] = series
        problems += [f"{load} ended early: {last}"] if last else []
        try:
            by_load[load] = growth_by_measure(series)
        except ValueError as error:
            problems.append(f"{load}: {error}")
    with atomic_text(options.out / "soak.csv") as file:
        rows = csv.writer(file)
        rows.writerow(COLUMNS)
        rows.writerows([load, *sample] for load, series in samples.items() for sample in series)
    text = table(by_load, options.minutes)
    write_bytes(options.out / "soak.md", text.encode())
    print(f"{text}\nwrote {draw(samples, options.out)}", *problems, sep="\n", flush=True)
    verdicts = {g.verdict for measures in by_load.values() for g in measures.values()}
    return int(bool(problems) or "grows" in verdicts)


if __name__ == "__main__":
    sys.exit(main())
