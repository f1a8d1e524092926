"""Compare an encoder before and after training with a table, rows and a picture."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from torch import nn

from mitigate.agents.agent import as_agent
from mitigate.agents.building import build_agent
from mitigate.core import checkpoint
from mitigate.core.build import maker
from mitigate.core.files import write_figure, write_text
from mitigate.core.json_files import read_object
from mitigate.core.markdown import markdown_table
from mitigate.corruptions import CLEAN, SUITE_VERSION, Corruption
from mitigate.corruptions.registry import names, title
from mitigate.encoders.folder import lines
from mitigate.encoders.model import Encoder
from mitigate.encoders.probe import Score, average, measure
from mitigate.encoders.sources import TRAIN, UNSEEN, Frames, collect, source_of
from mitigate.evaluation.bootstrap import NO_INTERVAL, Estimate
from mitigate.evaluation.conditions import conditions
from mitigate.training.config import TrainConfig
from mitigate.training.plan import IDENTITY

BEFORE, AFTER = "before", "after"
MEAN = "mean over corruptions"
EACH = 12  # frames per evaluated episode, equal to the number of views of a panorama
MOST_TRAIN = 2400  # number of frames for fitting the probe (heuristic)
MEASURES = {
    "cosine": "centred cosine to the clean features",
    "probe": "linear probe, mean average precision",
    "retrieval": "own clean frame retrieved first",
}
Scores = dict[tuple[str, str, str], Score]


def before_after(config: TrainConfig, base: Any, trained: nn.Module, folder: Path) -> None:
    """Print and write the similarity of corrupted to clean features, before and after training.

    The frames come from the scenes of ``evaluation.split``. Their number is 12 times
    ``evaluation.episodes``, but at most the number of training frames. The conditions are the
    suite's corruptions of this sensor.

    Args:
        config: options of the training run.
        base: the encoder from which training started if ``init`` was set, or None.
        trained: the trained encoder. If it has adapters, "before" means its original weights.
        folder: folder of the run.
    """
    assert isinstance(trained, Encoder)
    train, unseen = _frames(config, trained.sensor)
    whole = trained.tune == "all"
    before: Any = _encoder_before(config, base, folder) if whole else as_agent(trained).as_teacher()
    encoders: dict[str, Encoder] = {BEFORE: before.eval(), AFTER: trained.eval()}
    met = _conditions(config, trained.sensor)
    scores = with_mean(measure(encoders, met, train, unseen, config.seed))
    if ("before", "clean", "probe") in scores:
        scores = {at: score for at, score in scores.items() if at[2] != "retrieval"}
    about = (
        f"{len(unseen)} frames of {len(np.unique(unseen.scene))} unseen scenes, "
        f"severity {config.severity:g}, seed {config.seed}, suite {SUITE_VERSION}"
    )
    write(scores, folder, about)
    print(f"To load it in plain PyTorch:\n\n{lines(trained, folder / 'agent')}", flush=True)


def _encoder_before(config: TrainConfig, base: Any, folder: Path) -> nn.Module:
    """Return the encoder with its weights before training.

    Raises ValueError if it cannot be rebuilt.
    """
    encoder = build_agent(config.agent, weights=None, seed=config.seed) if base is None else base
    stage = next(iter(config.active_stages))
    identity = read_object(folder / stage / IDENTITY, "Train again in another folder.")
    if checkpoint.weights_sha(encoder) != identity.get("encoder_sha256"):
        raise ValueError(
            f"The weights of agent.model={config.agent['model']} differ from those at the start of "
            "the training (the file was changed, or the weights are random). Set "
            "agent.weights=FILE and train again in another folder. The trained encoder is in "
            f"{folder / 'agent'}."
        )
    return encoder


def _frames(config: TrainConfig, sensor: str) -> tuple[Frames, Frames]:
    """Return training frames and unseen frames.

    The training frames fit the probe and give the mean features. The unseen frames are used for the
    measurement.
    """
    recipe = next(iter(config.active_stages.values())).recipe
    frames, quick, env = recipe["frames"], config.evaluation, config.env
    source = source_of(maker(env.world), sensor, env.episodes, quick.split, recipe.get("label"))
    count = min(frames, EACH * quick.episodes) if quick.episodes else frames
    train = collect(source, TRAIN, min(frames, MOST_TRAIN), config.seed)
    return train, collect(source, UNSEEN, count, config.seed)


def _conditions(config: TrainConfig, sensor: str) -> list[Corruption]:
    """Return the clean condition and the suite's corruptions of ``sensor``.

    If the suite contains no corruption of the sensor, return all registered corruptions of the
    sensor.
    """
    met = conditions(config.suite.conditions, config.severity, None)
    chosen = [corruption.name for corruption in met if corruption.modality == sensor]
    chosen = chosen or list(names(sensor))
    return [CLEAN, *conditions(chosen, config.severity, config.severity_depth)]


def with_mean(scores: Scores) -> Scores:
    """Return ``scores`` with the mean over the corruptions as the last condition."""
    states = dict.fromkeys((state, what) for state, _, what in scores)
    means = {
        (state, MEAN, what): average(
            s for (a, name, b), s in scores.items() if (a, b) == (state, what) and name != "clean"
        )
        for state, what in states
    }
    return {**scores, **means}


def write(scores: Scores, folder: Path, about: str) -> list[Path]:
    """Write ``features.md``, ``features.jsonl`` and ``features.png``; print the table."""
    text = table(scores, about)
    write_text(folder / "features.md", text)
    lines_of_rows = (json.dumps(row) + "\n" for row in rows(scores, about))
    write_text(folder / "features.jsonl", "".join(lines_of_rows))
    write_figure(folder / "features.png", picture(scores, about), dpi=120, facecolor="white")
    report_paths = [folder / f"features.{kind}" for kind in ("md", "jsonl", "png")]
    print(text, flush=True)
    print("\n".join(f"wrote {path}" for path in report_paths), flush=True)
    return report_paths


def rows(scores: Scores, about: str) -> list[dict[str, Any]]:
    """Return one row per measure and condition.

    A row holds the values before and after training and their difference. Each value is [value,
    lower bound, upper bound]; the bounds are null if there is no confidence interval.
    """
    records = []
    for condition, what in _cells(scores):
        first, second = (scores[state, condition, what] for state in (BEFORE, AFTER))
        estimates = {BEFORE: first.estimate, AFTER: second.estimate, "gain": second.minus(first)}
        values = {
            name: [None if math.isnan(v) else round(v, 4) for v in (e.value, e.low, e.high)]
            for name, e in estimates.items()
        }
        records.append({"measure": what, "condition": condition, **values, "of": about})
    return records


def table(scores: Scores, about: str) -> str:
    """Return the Markdown table, with one block per measure."""
    parts = [
        f"# Features before and after\n\n{about}. In brackets 95 % intervals over scenes "
        f"({NO_INTERVAL}: of one scene alone there is none).\n"
    ]
    for what, named in MEASURES.items():
        measured = [condition for condition, other in _cells(scores) if other == what]
        if measured:
            head = (named, "before", "after", "after - before")
            parts.append(markdown_table(head, (_row(scores, c, what) for c in measured)) + "\n")
    return "\n".join(parts)


def _row(scores: Scores, condition: str, what: str) -> list[str]:
    first, second = (scores[state, condition, what] for state in (BEFORE, AFTER))
    name = condition if condition == MEAN else title(condition)
    return [name, _text(first.estimate), _text(second.estimate), _text(second.minus(first), "+")]


def _text(e: Estimate, sign: str = "") -> str:
    return f"{e.value:{sign}.2f} {e.interval(f'{sign}.2f')}"


def _cells(scores: Scores) -> list[tuple[str, str]]:
    return [(condition, what) for state, condition, what in scores if state == BEFORE]


def picture(scores: Scores, about: str) -> Figure:
    """Plot a bar chart with one panel per measure, and two bars per condition."""
    measures = [what for what in MEASURES if any(other == what for _, other in _cells(scores))]
    figure = Figure(figsize=(9, 3.1 * len(measures)), layout="constrained")
    for axis, what in zip(
        figure.subplots(len(measures), squeeze=False)[:, 0], measures, strict=True
    ):
        measured = [condition for condition, other in _cells(scores) if other == what]
        for place, (state, colour) in enumerate(((BEFORE, "#b9b9b9"), (AFTER, "#2a7f62"))):
            estimates = [scores[state, condition, what].estimate for condition in measured]
            x = np.arange(len(measured)) + 0.4 * (place - 0.5)
            ends = [[e.value - e.low for e in estimates], [e.high - e.value for e in estimates]]
            axis.bar(
                x, [e.value for e in estimates], 0.38, yerr=np.maximum(ends, 0), color=colour,
                label=state, error_kw={"lw": 0.8},
            )  # fmt: skip
        names_shown = [name if name == MEAN else title(name) for name in measured]
        axis.set_xticks(range(len(measured)), names_shown, rotation=20, ha="right", fontsize=8)
        axis.set_ylabel(MEASURES[what], fontsize=8)
        axis.grid(axis="y", alpha=0.3)
        axis.legend(fontsize=8, loc="lower left")
    figure.suptitle(about, fontsize=8)
    return figure
