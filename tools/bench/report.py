"""Write the measurements as the page ``docs/benchmarks.md``."""

from __future__ import annotations

from mitigate.core.markdown import markdown_table
from mitigate.core.observation import VIEWS
from mitigate.corruptions import SUITE_VERSION
from tools.bench.evaluation import Pace
from tools.bench.renderers import OURS
from tools.bench.suite import SEED, SEVERITY, Cost
from tools.bench.tensors import Batch
from tools.bench.timing import machine
from tools.bench.training import CAPS, LAYOUTS, Stage, table

AIM = 0.15  # target: maximum fraction of a training step in which no network is running
COLUMNS = (
    "corruption",
    "steady",
    "per frame",
    "first",
    "best peer",
    "peer / steady",
    "peer / per frame",
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
    batches: dict[str, list[Batch]],
    arguments: str = "",
) -> str:
    """Return all parts of the page as Markdown. ``arguments`` are the arguments of the command."""
    options = f' ARGS="{arguments}"' if arguments else ""
    head = [
        "# Benchmarks",
        "",
        f"`make bench{options}` on {machine()}. Everything except training uses one process and "
        f"one thread. The seed is {SEED}, and each measurement takes about {seconds:g} s.",
        "",
    ]
    parts = [
        head,
        _corruptions(costs),
        _panorama(pair),
        tensor_lines(batches),
        _training(stages),
        _evaluation(paces, by_workers),
        _rendering(rates, size),
    ]
    return "\n".join(line for part in parts for line in part).rstrip() + "\n"


def _corruptions(costs: dict[str, dict[str, Cost]]) -> list[str]:
    lines = [
        f"## Corruptions, suite {SUITE_VERSION}, severity {SEVERITY}",
        "",
        "Times are milliseconds per frame. At 12x64x64, the times are for one panorama of 12 "
        "views.",
        "",
        "- **steady**: time for consecutive frames of an episode: the fastest of many calls, "
        "averaged over a few episodes.",
        "- **per frame**: median time if each frame starts a new episode, as in the schedule "
        "`per_frame`.",
        "- **first**: median time if each frame also has a new severity, so that look-up tables "
        "must be built.",
        "- **best peer**: the fastest other library, or plain NumPy, OpenCV or torch code for "
        "depth. The other libraries draw random numbers at each call and cache nothing. For these "
        "libraries the table shows the fastest of many calls.",
        "- **steady / copy**: this time divided by the time to copy the frame.",
    ]
    for label, rows in costs.items():
        lines += [
            "",
            f"### {label}",
            "",
            markdown_table(COLUMNS, (_row(name, cost) for name, cost in rows.items())),
        ]
    return [*lines, "", *_libraries(costs)]


def _libraries(costs: dict[str, dict[str, Cost]]) -> list[str]:
    """Return the table of each library's times relative to this project's, over corruptions."""
    libraries = {name for rows in costs.values() for cost in rows.values() for name in cost.peers}
    cells = [
        [library, label, str(len(both)), _range(both, "steady"), _range(both, "per_frame")]
        for library in sorted(libraries)
        for label, rows in costs.items()
        if (
            both := [(cost, cost.peers[library]) for cost in rows.values() if library in cost.peers]
        )
    ]
    head = ("library", "frame", "corruptions", "its time / steady", "its time / per frame")
    return [
        "### Each library",
        "",
        "Smallest and greatest factor over the corruptions that the library also has:",
        "",
        markdown_table(head, cells, words=3),
        "",
    ]


def _range(both: list[tuple[Cost, float]], kind: str) -> str:
    factors = [theirs / getattr(cost, kind) for cost, theirs in both]
    return f"{min(factors):.1f} to {max(factors):.1f}"


def _row(name: str, cost: Cost) -> list[str]:
    peer = cost.best_peer
    peer_cells = ["none", "", ""]
    if peer is not None:
        times = (f"{peer[1] / ms:.1f}" for ms in (cost.steady, cost.per_frame))
        peer_cells = [f"{peer[0]}: {peer[1]:.3f}", *times]
    times_of_ours = [f"{ms:.4f}" for ms in (cost.steady, cost.per_frame, cost.first)]
    return [f"`{name}`", *times_of_ours, *peer_cells, f"{cost.steady / cost.copy:.1f}"]


def _panorama(pair: float) -> list[str]:
    return [
        "### The slowest pair on a panorama",
        "",
        f"`low_light_noise` and `multipath` on one panorama of 12 x 224 x 224, in one run: "
        f"{pair:.2f} ms.",
        "",
    ]


def tensor_lines(batches: dict[str, list[Batch]]) -> list[str]:
    """Return the section on batches of tensors, with one table per device."""
    lines = [
        "## Batches of torch tensors",
        "",
        f"Milliseconds per batch at severity {SEVERITY}: the fastest of many calls with the same "
        "keys, on one thread. For the CPU it is the CPU time of the process.",
        "",
        "- **kornia**: kornia's similar transform, if it has one, for float tensors in [0, 1].",
        '- **numpy**: `corrupt_tensors(..., backend="numpy")`, the default for tensors on the CPU.',
        '- **torch**: `corrupt_tensors(..., backend="torch")`, the default for tensors on a GPU.',
    ]
    head = ("corruption", "batch", "kornia", "numpy", "kornia / numpy", "torch", "kornia / torch")
    for device, rows in batches.items():
        cells = [
            [f"`{row.name}`", row.shape, _ms(row.kornia), _ms(row.numpy)]
            + [_ratio(row.kornia, row.numpy), _ms(row.torch), _ratio(row.kornia, row.torch)]
            for row in rows
        ]
        lines += ["", f"On {device}:", "", markdown_table(head, cells, words=2)]
    if len(batches) == 1:
        lines += ["", "No GPU was available, so there are no GPU timings."]
    return [*lines, ""]


def _ms(milliseconds: float | None) -> str:
    return "" if milliseconds is None else f"{milliseconds:.2f}"


def _ratio(peer: float | None, ours: float | None) -> str:
    return "" if peer is None or ours is None else f"{peer / ours:.2f}"


def _training(stages: dict[bool, list[Stage]]) -> list[str]:
    lines = [
        "## Training",
        "",
        "The table shows every stage of the recipes as `make train` runs it, with one worker "
        f"process per core. The measurement used 2 cores and {LAYOUTS} apartments. The time to "
        "generate apartments is excluded, because it is spent only once per training run. Values "
        "are medians of a few steps, and all parts are timed in one run.",
        "",
        "- **waiting**: fraction of a step during which the trainer waits for its batch.",
        "- **no network**: fraction of a step in which no network is running, neither for "
        f"training nor in rollouts (target: at most {AIM:.0%}).",
        "- The columns from **rendering** to **other**: milliseconds that one core needs for each "
        "part of the work on a batch.",
    ]
    for caps, measured in stages.items():
        name = " ".join(f"{key}={value}" for key, value in CAPS.items())
        lines += [
            "",
            f"### {f'Limited to AVX2: {name}' if caps else 'All instructions of the CPU'}",
            "",
            table(measured),
        ]
    return [*lines, ""]


def _evaluation(paces: dict[str, Pace], by_workers: dict[int, float]) -> list[str]:
    times = ", ".join(f"{seconds:.1f} s with {n}" for n, seconds in by_workers.items())
    rows = [
        [f"`{name}`", pace.count, f"{pace.count / pace.alone:.1f}"]
        + [f"{pace.count / pace.together:.1f}", f"{pace.alone / pace.together:.2f}"]
        + ["equal" if pace.same else "NOT EQUAL"]
        for name, pace in paces.items()
    ]
    head = ("agent", "episodes", "alone, episodes / CPU s", "together", "together / alone", "rows")
    gain = f" ({by_workers[1] / by_workers[2]:.2f} times)" if 2 in by_workers else ""
    return [
        "## Evaluation",
        "",
        "Values are CPU times of one process. The two variants alternate in one run. Here, an "
        "episode is one run under one condition of the suite.",
        "",
        "- **alone**: every episode is run separately.",
        "- **together**: the conditions of an episode follow each other and share cached frames "
        "and features, as in an evaluation.",
        "",
        markdown_table(head, rows),
        "",
        f"Wall time of this evaluation by number of worker processes: {times}{gain}.",
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
        "The renderers alternate in one process. Values are the best of several rounds.",
        "",
        markdown_table(("renderer", *views, "speed of ours relative to it"), rows),
    ]
