"""Write the measurements as the page ``docs/benchmarks.md``."""

from __future__ import annotations

from pathlib import Path

from mitigate.core.markdown import markdown_table
from mitigate.core.observation import VIEWS
from mitigate.corruptions import SUITE_VERSION
from tools.bench.evaluation import Pace
from tools.bench.renderers import OURS
from tools.bench.suite import SEED, SEVERITY, Cost
from tools.bench.tensors import Batch
from tools.bench.timing import machine
from tools.bench.training import CAPS, LAYOUTS, Stage, table

TEMPLATE = Path(__file__).with_suffix(".md")  # the template: names in braces are replaced by values
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
    """Return the page as Markdown. ``arguments`` are the arguments of the command."""
    times = ", ".join(f"{seconds:.1f} s with {n}" for n, seconds in by_workers.items())
    gain = f" ({by_workers[1] / by_workers[2]:.2f} times)" if 2 in by_workers else ""
    return TEMPLATE.read_text("utf-8").format(
        options=f' ARGS="{arguments}"' if arguments else "",
        machine=machine(),
        seed=SEED,
        seconds=seconds,
        suite=SUITE_VERSION,
        severity=SEVERITY,
        corruptions="\n\n".join(_corruptions(label, rows) for label, rows in costs.items()),
        libraries=_libraries(costs),
        pair=pair,
        tensors=tensor_tables(batches),
        layouts=LAYOUTS,
        training=table(stages[False]),
        caps=" ".join(f"{key}={value}" for key, value in CAPS.items()),
        training_with_caps=table(stages[True]),
        evaluation=_evaluation(paces),
        by_workers=f"{times}{gain}",
        size=size,
        rendering=_rendering(rates),
    )


def _corruptions(label: str, rows: dict[str, Cost]) -> str:
    cells = (_row(name, cost) for name, cost in rows.items())
    return f"### {label}\n\n{markdown_table(COLUMNS, cells)}"


def _row(name: str, cost: Cost) -> list[str]:
    peer = cost.best_peer
    peer_cells = ["none", "", ""]
    if peer is not None:
        times = (f"{peer[1] / ms:.1f}" for ms in (cost.steady, cost.per_frame))
        peer_cells = [f"{peer[0]}: {peer[1]:.3f}", *times]
    times_of_ours = [f"{ms:.4f}" for ms in (cost.steady, cost.per_frame, cost.first)]
    return [f"`{name}`", *times_of_ours, *peer_cells, f"{cost.steady / cost.copy:.1f}"]


def _libraries(costs: dict[str, dict[str, Cost]]) -> str:
    """Return the table of each library's times relative to this project's, over corruptions."""
    libraries = {name for rows in costs.values() for cost in rows.values() for name in cost.peers}
    cells = []
    for library in sorted(libraries):
        for label, rows in costs.items():
            both = [(cost, cost.peers[library]) for cost in rows.values() if library in cost.peers]
            if both:
                ranges = [_range(both, "steady"), _range(both, "per_frame")]
                cells.append([library, label, len(both), *ranges])
    head = ("library", "frame", "corruptions", "its time / steady", "its time / per frame")
    return markdown_table(head, cells, words=3)


def _range(both: list[tuple[Cost, float]], kind: str) -> str:
    factors = [theirs / getattr(cost, kind) for cost, theirs in both]
    return f"{min(factors):.1f} to {max(factors):.1f}"


def tensor_tables(batches: dict[str, list[Batch]]) -> str:
    """Return one table of batches of tensors per device."""
    head = ("corruption", "batch", "kornia", "numpy", "kornia / numpy", "torch", "kornia / torch")
    parts = []
    for device, rows in batches.items():
        cells = [
            [f"`{row.name}`", row.shape, _ms(row.kornia), _ms(row.numpy)]
            + [_ratio(row.kornia, row.numpy), _ms(row.torch), _ratio(row.kornia, row.torch)]
            for row in rows
        ]
        parts.append(f"On {device}:\n\n{markdown_table(head, cells, words=2)}")
    if len(batches) == 1:
        parts.append("No GPU was available, so there are no GPU timings.")
    return "\n\n".join(parts)


def _ms(milliseconds: float | None) -> str:
    return "" if milliseconds is None else f"{milliseconds:.2f}"


def _ratio(peer: float | None, ours: float | None) -> str:
    return "" if peer is None or ours is None else f"{peer / ours:.2f}"


def _evaluation(paces: dict[str, Pace]) -> str:
    rows = [
        [f"`{name}`", pace.count, f"{pace.count / pace.alone:.1f}"]
        + [f"{pace.count / pace.together:.1f}", f"{pace.alone / pace.together:.2f}"]
        + ["equal" if pace.same else "NOT EQUAL"]
        for name, pace in paces.items()
    ]
    head = ("agent", "episodes", "alone, episodes / CPU s", "together", "together / alone", "rows")
    return markdown_table(head, rows)


def _rendering(rates: dict[str, tuple[float, float]]) -> str:
    fastest = rates[OURS][0]
    rows = [
        [name, f"{wall:.0f}", f"{cpu:.0f}", f"{wall / VIEWS:.0f}", f"{fastest / wall:.1f} times"]
        for name, (wall, cpu) in rates.items()
    ]
    views = ("RGB-D views/s", "per CPU second", "panoramas (12 views)/s")
    return markdown_table(("renderer", *views, "speed of `apartments` divided by its speed"), rows)
