"""Compare the cost of a step in two runs of one recipe, and fail if one run is much slower.

    python -m tools.bench.steps runs/native runs/capped --most 4

CI trains once with the full instruction set of the processor, and once with that of an older
processor (``ONEDNN_MAX_CPU_ISA=AVX2 ATEN_CPU_CAPABILITY=avx2``). Both runs log every step
(``trainer.log_every=1``) and use one thread (``OMP_NUM_THREADS=1``), so that other programs hardly
influence the CPU seconds of a step. In each stage, the step with the fewest CPU seconds is used,
because other programs can only make a step slower. The first step is a warm-up and is not used.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from mitigate.training.journal import CPU

MIN_STEPS = 3  # minimum steps per stage: one for warm-up, two to measure


def main(arguments: list[str] | None = None) -> int:
    """Print a line per stage; return 1 if a stage's ratio is above ``--most``, else 0."""
    parser = argparse.ArgumentParser(
        prog="tools.bench.steps", description="Compare CPU seconds per step."
    )
    parser.add_argument("reference", type=Path, help="folder of the reference run")
    parser.add_argument("other", type=Path, help="folder of the run that must not be much slower")
    parser.add_argument("--most", type=float, default=4.0, help="largest ratio (default 4)")
    options = parser.parse_args(arguments)
    try:
        reference, other = step_costs(options.reference), step_costs(options.other)
        ratios = slower(reference, other)
    except (FileNotFoundError, ValueError) as error:
        parser.error(str(error))
    for stage, ratio in ratios.items():
        times = f"{reference[stage]:.3f} and {other[stage]:.3f} CPU s per step"
        print(f"{stage:<20}{times}: {ratio:.2f} times, at most {options.most:g}", flush=True)
    over = [stage for stage, ratio in ratios.items() if ratio > options.most]
    if over:
        print(_explain(over, options), file=sys.stderr)
    return 1 if over else 0


def step_costs(run: Path) -> dict[str, float]:
    """Return the minimum CPU seconds per step for each stage. The first step is ignored.

    The CPU seconds are read from TensorBoard files.

    Raises:
        FileNotFoundError: If the folder contains no stages.
        ValueError: If a stage has fewer than ``MIN_STEPS`` steps.
    """
    stages = sorted({file.parent for file in run.glob("*/events.out.tfevents.*")})
    if not stages:
        raise FileNotFoundError(
            f"{run} contains no stage with TensorBoard files. Name the folder of a training run, "
            "which contains config.yaml."
        )
    return {stage.name: _cheapest(stage) for stage in stages}


def slower(reference: dict[str, float], other: dict[str, float]) -> dict[str, float]:
    """Return, by stage, the seconds per step of ``other`` divided by the seconds of ``reference``.

    Raises:
        ValueError: If the runs have different stages.
    """
    if reference.keys() != other.keys():
        raise ValueError(
            f"The runs have different stages ({', '.join(reference)} and {', '.join(other)}). "
            "Compare two runs of one recipe."
        )
    return {stage: other[stage] / seconds for stage, seconds in reference.items()}


def _cheapest(stage: Path) -> float:
    """Return the minimum CPU seconds per step of a stage. The first step is ignored."""
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(stage), size_guidance={"scalars": 0})  # 0: keep all
    events.Reload()
    logged = events.Scalars(CPU) if CPU in events.Tags()["scalars"] else []
    if len(logged) < MIN_STEPS:
        raise ValueError(
            f"{stage} logged the cost of {len(logged)} steps, fewer than {MIN_STEPS}. Train it "
            f"with trainer.log_every=1 and trainer.steps={MIN_STEPS} or more."
        )
    return min(event.value for event in logged[1:])


def _explain(over: list[str], options: argparse.Namespace) -> str:
    return (
        f"Steps of {', '.join(over)} cost more than {options.most:g} times as much in "
        f"{options.other} as in {options.reference}. The work is equal, so the processor probably "
        "emulates missing instructions. Run every network in a precision that the processor "
        "supports, not in a fixed bf16."
    )


if __name__ == "__main__":
    sys.exit(main())
