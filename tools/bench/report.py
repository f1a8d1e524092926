"""The measurements as the page ``docs/benchmarks.md``."""

from __future__ import annotations

from mitigate.core.markdown import markdown_table
from mitigate.core.observation import VIEWS
from mitigate.corruptions import SUITE_VERSION
from mitigate.corruptions.registry import record
from tools.bench.evaluation import Pace
from tools.bench.renderers import OURS
from tools.bench.suite import PANORAMA_BAR, SEED, SEVERITY, TINY, Cost
from tools.bench.timing import machine
from tools.bench.training import CAPS, LAYOUTS, Stage, table

AIM = 0.15  # of a training step, at most, in which no network computes
COLUMNS = (
    "corruption",
    "steady",
    "per frame",
    "first",
    "best peer",
    "peer / steady",
    "peer / per frame",
    "bar",
    "steady / bar",
    "steady / copy",
)


def page(
    costs: dict[str, dict[str, Cost]],
    pair: float,
    stages: dict[bool, list[Stage]],
    rates: dict[str, tuple[float, float]],
    size: int,
    seconds: float,
    paces: dict[str, Pace],
    by_workers: dict[int, float],
    arguments: str = "",
) -> str:
    """All parts as Markdown; ``arguments`` are those of the command."""
    given = f' ARGS="{arguments}"' if arguments else ""
    head = [
        "# Benchmarks",
        "",
        f"`make bench{given}` on {machine()}. One process and one "
        f"thread but for training, seed {SEED}, about {seconds:g} s a clock.",
        "",
    ]
    parts = [
        head,
        _corruptions(costs),
        _panorama(pair),
        _over(costs),
        _training(stages),
        _evaluation(paces, by_workers),
        _rendering(rates, size),
    ]
    return "\n".join(line for part in parts for line in part).rstrip() + "\n"


def _corruptions(costs: dict[str, dict[str, Cost]]) -> list[str]:
    lines = [
        f"## Corruptions, suite {SUITE_VERSION}, severity {SEVERITY}",
        "",
        "Milliseconds a frame (12x64x64: a panorama of 12 views). **Steady**: the frames of an "
        "episode, fastest of many calls, mean over a few episodes. **Per frame**: each frame "
        "starts an episode, as in the per-frame regime. **First**: a new severity as well, "
        "whose tables are then built; both are medians. The peers draw anew at each "
        "call and keep nothing; theirs is the fastest of many calls too. The bar is this project's "
        "aim (it has none at 12x64x64).",
    ]
    for label, rows in costs.items():
        lines += [
            "",
            f"### {label}",
            "",
            markdown_table(COLUMNS, (_row(name, cost) for name, cost in rows.items())),
        ]
    return [*lines, ""]


def _row(name: str, cost: Cost) -> list[str]:
    peer = cost.best_peer
    beside = ["none", "", ""]
    if peer is not None:
        times = (f"{peer[1] / mine:.1f}" for mine in (cost.steady, cost.per_frame))
        beside = [f"{peer[0]}: {peer[1]:.3f}", *times]
    bar = ["", ""] if cost.bar is None else [f"{cost.bar:g}", f"{cost.steady / cost.bar:.2f}"]
    own = [f"{ms:.4f}" for ms in (cost.steady, cost.per_frame, cost.first)]
    return [f"`{name}`", *own, *beside, *bar, f"{cost.steady / cost.copy:.1f}"]


def _panorama(pair: float) -> list[str]:
    return [
        "### The worst pair on a panorama",
        "",
        f"`low_light_noise` and `multipath` on one panorama of 12 x 224 x 224, in one run: "
        f"{pair:.2f} ms (bar {PANORAMA_BAR} ms).",
        "",
    ]


def _over(costs: dict[str, dict[str, Cost]]) -> list[str]:
    missed = [
        (name, label, cost)
        for label, rows in costs.items()
        for name, cost in rows.items()
        if cost.over
    ]
    if not missed:
        return ["Every bar is met.", ""]
    rows = [
        [f"`{name}`", label, f"{cost.steady - cost.bar:.4f}", f"{cost.call:.4f}"]
        + [f"{cost.steady - cost.call:.4f}", f"{cost.copy:.4f}", record(name).reason]
        for name, label, cost in missed
        if cost.bar is not None
    ]
    head = ("corruption", "size", "over by", "call", "kernel", "frame copy", "where the time goes")
    return [
        "### Over the bar",
        "",
        f"**Call**: milliseconds of the same call on a frame of {TINY} x {TINY} pixels: checks, "
        "keys, look-ups and the way into compiled code. **Kernel**: the rest.",
        "",
        markdown_table(head, rows, words=2),
        "",
    ]


def _training(stages: dict[bool, list[Stage]]) -> list[str]:
    lines = [
        "## Training",
        "",
        "Every stage of the recipes as `make train` runs it, with a worker process a core, on 2 "
        f"threads; {LAYOUTS} apartments, so that making them, which a training pays once, does not "
        "count. **Waiting**: the share of a step in which the trainer waits for its batch; **no "
        f"network computes**: the same without the networks of rollouts (aim: at most {AIM:.0%}). "
        "The last columns are milliseconds on one core to make a step's batch, by part. Medians of "
        "a few steps; corruption and all others are timed in one run.",
    ]
    for caps, found in stages.items():
        name = " ".join(f"{key}={value}" for key, value in CAPS.items())
        lines += [
            "",
            f"### {f'Capped: {name}' if caps else 'As the machine is'}",
            "",
            table(found),
        ]
    return [*lines, ""]


def _evaluation(paces: dict[str, Pace], by_workers: dict[int, float]) -> list[str]:
    times = ", ".join(f"{seconds:.1f} s with {n}" for n, seconds in by_workers.items())
    rows = [
        [f"`{name}`", pace.count, f"{pace.count / pace.alone:.1f}"]
        + [f"{pace.count / pace.together:.1f}", f"{pace.alone / pace.together:.2f}"]
        + ["the same" if pace.same else "NOT THE SAME"]
        for name, pace in paces.items()
    ]
    head = ("agent", "episodes", "alone, episodes / CPU s", "together", "together / alone", "rows")
    gain = f" ({by_workers[1] / by_workers[2]:.2f} times)" if 2 in by_workers else ""
    return [
        "## Evaluation",
        "",
        "Episodes, each under one condition of the suite, in one run and in turns, CPU time of one "
        "process. **Alone**: every episode by itself. **Together**: the conditions of an episode "
        "one after the other, with frames and features kept, as an evaluation runs them.",
        "",
        markdown_table(head, rows),
        "",
        f"The same evaluation by worker processes, wall time: {times}{gain}.",
        "",
    ]


def _rendering(rates: dict[str, tuple[float, float]], size: int) -> list[str]:
    fastest = rates[OURS][0]
    rows = [
        [name, f"{wall:.0f}", f"{cpu:.0f}", f"{wall / VIEWS:.0f}", f"{fastest / wall:.1f} times"]
        for name, (wall, cpu) in rates.items()
    ]
    views = ("RGB-D views/s", "per CPU second", "panoramas (12 views)/s")
    return [
        f"## RGB-D rendering, {size} x {size} pixels",
        "",
        "One process, one run, in turns; the best of several rounds.",
        "",
        markdown_table(("renderer", *views, "ours is faster"), rows),
    ]
