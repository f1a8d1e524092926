"""Whether memory or open files grow: ``python -m tools.bench.soak --minutes 60``.

Training, evaluation and bridge traffic (``loads.py``) run one after the other (``--together``: side
by side), each for so many minutes; every few seconds the memory (RSS) and the open file descriptors
of all its processes are noted. Writes ``soak.csv``, ``soak.png`` and ``soak.md`` (slopes with 95 %
intervals, a verdict) to the output folder, and exits with 1 if anything grows or a load ends by
itself. Linux only.
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
from tools.bench.growth import DAY, MUCH, Growth, growth
from tools.bench.loads import LOADS

PAGE = os.sysconf("SC_PAGE_SIZE")
MEASURES = ("RSS, MiB", "file descriptors")
COLUMNS = ("load", "seconds", "processes", "rss_mib", "descriptors")
GRACE = 60.0  # seconds for a load to end
Sample = tuple[float, int, float, int]  # COLUMNS without the first


def measured(pid: int) -> tuple[int, float, int]:
    """Processes below ``pid`` and itself, their resident memory in MiB and open descriptors.

    What processes share counts in each. One that ends in this moment counts as nothing.
    """
    processes, memory, open_files = 0, 0, 0
    for one in family(pid):
        with suppress(OSError, IndexError, ValueError):
            place = Path(f"/proc/{one}")
            pages = int((place / "statm").read_text().split()[1])
            descriptors = len(os.listdir(place / "fd"))
            processes, memory = processes + 1, memory + pages
            open_files += descriptors
    return processes, memory * PAGE / 2**20, open_files


def family(pid: int) -> Iterator[int]:
    """``pid`` and all processes below it."""
    yield pid
    for thread in Path(f"/proc/{pid}/task").glob("*"):
        with suppress(OSError):
            for child in (thread / "children").read_text().split():
                yield from family(int(child))


def watch(name: str, seconds: float, every: float, out: Path) -> tuple[list[Sample], str]:
    """Run a load for so long; return its samples and, if it ended by itself, its last words."""
    found: list[Sample] = []
    with tempfile.TemporaryDirectory(prefix="soak-", dir=out) as folder:
        log = out / f"{name}.txt"
        with open_output(log, "w", encoding="utf-8") as said:
            process = subprocess.Popen(
                [sys.executable, "-m", "tools.bench.loads", name, str(Path(folder) / "load")],
                stdout=said,
                stderr=subprocess.STDOUT,
            )
        began = time.monotonic()
        try:
            with Progress(f"soak: {name}", round(seconds), unit="second") as progress:
                while (now := time.monotonic() - began) < seconds and process.poll() is None:
                    found.append((now, *measured(process.pid)))
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
    return found, last[-400:] if ended else ""


def grown(samples: Sequence[Sample]) -> dict[str, Growth]:
    """The growth of each measure."""
    hours = np.array([sample[0] for sample in samples]) / 3600
    return {
        name: growth(hours, np.array([sample[column] for sample in samples], float))
        for name, column in zip(MEASURES, (2, 3), strict=True)
    }


def table(found: dict[str, dict[str, Growth]], minutes: float) -> str:
    """Markdown: a line for each load and measure."""
    about = (
        f"{minutes:g} minutes each; slopes an hour after the first quarter, with 95 % intervals. "
        f'"grows": over {100 * MUCH:g} % of the mean in {DAY:g} hours even at the lower end; '
        '"flat": not even at the upper end.'
    )
    rows = []
    for load, measures in found.items():
        for name, g in measures.items():
            slope = f"{g.slope:+.2f} [{g.low:+.2f}, {g.high:+.2f}]"
            rows.append([load, name, f"{g.mean:.1f}", slope, g.verdict])
    head = ("load", "measure", "mean", "slope an hour", "verdict")
    return f"{about}\n\n{markdown_table(head, rows, words=2)}\n"


def draw(samples: dict[str, list[Sample]], out: Path) -> Path:
    """Write ``soak.png``: both measures of each load over time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4 * len(samples), 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, len(samples), squeeze=False, sharex="col")
    for column, (load, found) in enumerate(samples.items()):
        minutes = [sample[0] / 60 for sample in found]
        for row, (name, index) in enumerate(zip(MEASURES, (2, 3), strict=True)):
            axes[row, column].plot(minutes, [sample[index] for sample in found], linewidth=1)
            axes[row, column].set_ylim(bottom=0)
            axes[row, column].set_ylabel(name)
        axes[0, column].set_title(load)
        axes[1, column].set_xlabel("minutes")
    return write_figure(out / "soak.png", figure, dpi=100)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.soak", description=__doc__)
    add = parser.add_argument
    add("--minutes", type=float, default=60.0, help="of each load (default 60)")
    add("--loads", nargs="+", default=list(LOADS), choices=list(LOADS))
    add("--every", type=float, default=2.0, help="seconds between two looks (default 2)")
    add("--together", action="store_true", help="all loads at once, on the same cores")
    add("--out", type=Path, default=Path("runs/soak"))
    chosen = parser.parse_args(arguments)
    if chosen.minutes <= 0 or chosen.every <= 0:
        parser.error("--minutes and --every must be above 0.")
    make_folder(chosen.out)
    samples, found, problems = {}, {}, []

    def watched(load: str) -> tuple[list[Sample], str]:
        return watch(load, 60 * chosen.minutes, chosen.every, chosen.out)

    with ThreadPoolExecutor(len(chosen.loads) if chosen.together else 1) as pool:
        made = list(pool.map(watched, chosen.loads))
    for load, (seen, last) in zip(chosen.loads, made, strict=True):
        samples[load] = seen
        problems += [f"{load} ended by itself: {last}"] if last else []
        try:
            found[load] = grown(samples[load])
        except ValueError as error:
            problems.append(f"{load}: {error}")
    with atomic_text(chosen.out / "soak.csv") as file:
        rows = csv.writer(file)
        rows.writerow(COLUMNS)
        rows.writerows([load, *sample] for load, there in samples.items() for sample in there)
    text = table(found, chosen.minutes)
    write_bytes(chosen.out / "soak.md", text.encode())
    print(f"{text}\nwrote {draw(samples, chosen.out)}", *problems, sep="\n", flush=True)
    verdicts = {g.verdict for measures in found.values() for g in measures.values()}
    return int(bool(problems) or "grows" in verdicts)


if __name__ == "__main__":
    sys.exit(main())
