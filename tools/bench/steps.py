"""Compare the cost of a step in two runs of the same recipe: is one slower than it may be?

    python -m tools.bench.steps runs/native runs/capped --most 4

CI trains once as the processor can and once with the instructions of an older one
(``ONEDNN_MAX_CPU_ISA=AVX2 ATEN_CPU_CAPABILITY=avx2``). Both runs log every step
(``trainer.log_every=1``) and use one thread (``OMP_NUM_THREADS=1``): then the CPU seconds of a step
hardly depend on what else the machine does. A stage counts by its cheapest step, since all else
only adds to it; the first, which warms up, does not count.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from mitigate.training.journal import CPU

LEAST = 3  # steps of a stage that are worth comparing: one that warms up and two


def main(arguments: list[str] | None = None) -> int:
    """Print a line for each stage; return 1 if one is slower than ``--most`` allows, else 0."""
    parser = argparse.ArgumentParser(
        prog="tools.bench.steps", description="Compare CPU seconds a step."
    )
    parser.add_argument("reference", type=Path, help="run folder that sets the measure")
    parser.add_argument("other", type=Path, help="run folder that must not be much slower")
    parser.add_argument("--most", type=float, default=4.0, help="times as much (default 4)")
    options = parser.parse_args(arguments)
    try:
        reference, other = step_costs(options.reference), step_costs(options.other)
        ratios = slower(reference, other)
    except (FileNotFoundError, ValueError) as error:
        parser.error(str(error))
    for stage, ratio in ratios.items():
        times = f"{reference[stage]:.3f} and {other[stage]:.3f} CPU s a step"
        print(f"{stage:<20}{times}: {ratio:.2f} times, at most {options.most:g}", flush=True)
    over = [stage for stage, ratio in ratios.items() if ratio > options.most]
    if over:
        print(_explained(over, options), file=sys.stderr)
    return 1 if over else 0


def step_costs(run: Path) -> dict[str, float]:
    """Return the CPU seconds of each stage's cheapest step but the first, as TensorBoard has them.

    Raises FileNotFoundError for a folder without stages, ValueError for fewer than ``LEAST`` steps.
    """
    stages = sorted({file.parent for file in run.glob("*/events.out.tfevents.*")})
    if not stages:
        raise FileNotFoundError(
            f"{run} holds no stage with TensorBoard files. Name the folder of a training, the one "
            "that holds config.yaml."
        )
    return {stage.name: _cheapest(stage) for stage in stages}


def slower(reference: dict[str, float], other: dict[str, float]) -> dict[str, float]:
    """Return by stage how many times as much a step of ``other`` costs.

    Raises ValueError when the two do not have the same stages.
    """
    if reference.keys() != other.keys():
        raise ValueError(
            f"The runs have different stages ({', '.join(reference)} and {', '.join(other)}). "
            "Compare two runs of one recipe."
        )
    return {stage: other[stage] / seconds for stage, seconds in reference.items()}


def _cheapest(stage: Path) -> float:
    """CPU seconds of the cheapest step but the first of one stage."""
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(stage), size_guidance={"scalars": 0})  # 0: keep all
    events.Reload()
    logged = events.Scalars(CPU) if CPU in events.Tags()["scalars"] else []
    if len(logged) < LEAST:
        raise ValueError(
            f"{stage} logged the cost of {len(logged)} steps, fewer than {LEAST}. Train it with "
            f"trainer.log_every=1 and trainer.steps={LEAST} or more."
        )
    return min(event.value for event in logged[1:])


def _explained(over: list[str], options: argparse.Namespace) -> str:
    return (
        f"Steps of {', '.join(over)} cost more than {options.most:g} times as much in "
        f"{options.other} as in {options.reference}. With the same work on fewer instructions this "
        "means arithmetic that the processor has to emulate: see that every network runs in the "
        "precision that suits the processor, not in a fixed bf16."
    )


if __name__ == "__main__":
    sys.exit(main())
