"""Write the card and the README of a hardened checkpoint.

The card describes the training and the results. The README begins with the front matter that
Hugging Face reads.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import yaml

from mitigate.agents import adapters, loading, schema
from mitigate.core import checkpoint
from mitigate.core.files import ROOT, find, sha256
from mitigate.core.markdown import markdown_of, markdown_table
from mitigate.core.names import counted, short
from mitigate.corruptions import SUITE_VERSION, registry
from mitigate.evaluation.bootstrap import LEVEL, NO_INTERVAL, RESAMPLES, Estimate
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import Retained, Section, sections

VERSIONS = ("mitigate", "torch", "numpy", "safetensors", "panda3d")
# the files at these paths of a checkout determine the content of an exported folder
CODE = ("mitigate", "conf", "recipes", "pyproject.toml")
LIBRARY = "mitigate"
TASK = "robotics"  # Hugging Face's task name for agents that move
TAGS = ("embodied-navigation", "robustness", "sensor-corruption", "safetensors")
# this project's own name for the episodes, which are not a data set on the hub
DATASET = "mitigate-episodes"
LICENCE = "Apache-2.0"  # licence of the agents that this project defines
UNKNOWN = "other"  # Hugging Face's name for an unknown licence


def facts(cfg: dict[str, Any], agent: Any) -> dict[str, Any]:
    """Return the entries of a card that describe how ``agent`` was trained.

    The entries come from the resolved config ``cfg`` of the run and from this checkout. Raises
    FileNotFoundError if the base or a teacher of the run is missing, and ValueError if ``cfg`` has
    a value that training never writes.
    """
    _check(cfg)
    teachers = sorted({path for path in _teachers(cfg.get("stages")) if path != "start"})
    trained_at = {**cfg, **(cfg.get("schedule") or {})}
    kind = str((cfg.get("agent") or {}).get("_target_", loading.TARGET))
    return {
        "recipe": cfg["name"],
        "severity": trained_at["severity"],
        "severity_depth": trained_at["severity_depth"],
        "seed": cfg["seed"],
        "precision": _precision(cfg.get("stages") or {}),
        "suite": SUITE_VERSION,
        "base": reference(cfg["init"]) if cfg.get("init") else None,
        "teachers": [reference(path) for path in teachers],
        "vocabulary": loading.vocabulary_sha(agent),
        "commit": commit(),
        "uncommitted": uncommitted(),
        "versions": {package: _version(package) for package in VERSIONS},
        "class": kind,
        "license": LICENCE if kind in schema.KINDS else UNKNOWN,
    }


def reference(weights: str) -> dict[str, str]:
    """Return the path of ``weights`` and its sha256.

    A path below the current folder is made relative.
    """
    path = find(weights)
    adapters_only = loading.adapters_only(path)
    file = path / adapters.WEIGHTS if adapters_only else checkpoint.weights_file(path)
    return {"weights": weights.removeprefix(f"{Path.cwd()}/"), "sha256": sha256(file)}


def commit() -> str | None:
    """Return the git commit of the checkout, or None without a checkout or git."""
    return _git("rev-parse", "HEAD") or None


def uncommitted() -> bool:
    """Return whether the checkout has uncommitted changes to code or configs."""
    return bool(_git("--no-optional-locks", "status", "--porcelain", "--", *CODE))


def _git(*words: str) -> str:
    """Run git in the checkout and return its output, or "" without a checkout or git."""
    # if the package is installed, it may be inside the git repository of another project
    if not (ROOT / ".git").exists():
        return ""
    try:
        process = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    except OSError:
        return ""
    return process.stdout.strip() if process.returncode == 0 else ""


def weights_of(row: Row) -> str:
    """Return the hash of the weights in a row, which older versions store under ``agent``."""
    return str(row.get("weights", row["agent"]))


def metrics(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Return SR, SPL and PRS with 95 % intervals, from the rows of one agent.

    One entry per split, suite, success rule and severity; intervals are [value, low, high].
    """
    mine = [{**row, "name": "agent", "agent": "agent"} for row in rows]
    return [_entry(section) for section in sections(mine)] if mine else []


def readme(card: dict[str, Any], folder: str) -> str:
    """Return the README of an exported folder as Markdown, with Hugging Face's front matter.

    Args:
        card: the card of the folder.
        folder: path of the folder, shown in the example that loads the agent.
    """
    parts = [f"# {card['name']}", _origin(card), *map(_table, card["metrics"]), _use(card, folder)]
    if not card["metrics"]:
        parts.insert(2, "There are no metrics, because no result rows were given at export.")
    return front_matter(card) + "\n" + "\n\n".join(parts) + "\n"


def _entry(section: Section) -> dict[str, Any]:
    grid, column = section.grid, section.columns[0]
    return {
        "split": grid.split,
        "severity": section.severity,
        "suite": grid.suite,
        "rule": grid.rule,
        "episodes": len(grid.episodes),
        "seeds": list(grid.seeds[column, section.severity]),
        "clean": {metric: _interval(value) for (_, metric), value in section.clean.items()},
        "PRS": {
            f"PRS-{metric} ({_heading(section, block, value)})": _interval(value.estimate)
            for (_, block, metric), value in section.retained.items()
        },
        "SR": {
            name: _number(section.value(column, name))
            for names in section.blocks.values()
            for name in names
        },
        "incomplete": sorted({gap.corruption for gap in section.gaps}),
    }


def _heading(section: Section, block: str, retained: Retained) -> str:
    """Return the name of a block of corruptions, with their number if some are missing."""
    count = len(retained.corruptions)
    whole = section.whole(block)
    return block if count >= whole else f"{block}, {count} of {whole}"


def _interval(estimate: Estimate) -> list[float | None]:
    return [_number(estimate.value), _number(estimate.low), _number(estimate.high)]


def _number(value: float) -> float | None:
    return None if math.isnan(value) else round(value, 4)


def _origin(card: dict[str, Any]) -> str:
    depth = card["severity"] if card["severity_depth"] is None else card["severity_depth"]
    severities = f"{_span(card['severity'])} (depth {_span(depth)})"
    base = card["base"]
    start = (
        f" Training started from `{base['weights']}` (sha256 `{base['sha256'][:12]}`)."
        if base
        else ""
    )
    taught = "".join(
        f" The teacher was `{t['weights']}` (sha256 `{t['sha256'][:12]}`)."
        for t in card["teachers"]
    )
    kind = (
        "This folder contains adapters, without the base agent that they belong to"
        if card["adapters_only"]
        else "This folder contains all weights of the agent"
        f"{', in float16' if card.get('program', True) else ''}"
    )
    known = card["license"] != UNKNOWN
    licence = f"Licence: {card['license']}." if known else "The agent's owner chooses the licence."
    computed = f", precision {card['precision']}" if card.get("precision") else ""
    changed = ", with uncommitted changes" if card.get("uncommitted") else ""
    commit = f" Exported at commit `{card['commit']}`{changed}." if card["commit"] else ""
    return (
        f"Trained with the recipe `{card['recipe']}`: severity {severities}, seed {card['seed']}"
        f"{computed}, corruption suite {card['suite']}.{start}{taught}\n{kind}. {_hashes(card)} "
        f"{licence}{commit}"
    )


def _hashes(card: dict[str, Any]) -> str:
    """Return a sentence with the hashes of the weights and the fingerprints in result rows."""
    exported, before = card["agent"], card.get("run_agent", card["agent"])
    rounded = f" (`{before}` before rounding)" if before != exported else ""
    names = " and ".join(f"`{agent}`" for agent in card.get("rows_agent", ()))
    rows = f" Result rows name this agent {names}." if names else ""
    return f"The hash of the weights is `{exported}`{rounded}.{rows}"


def _span(severity: float | list[float]) -> str:
    return " to ".join(f"{s:g}" for s in (severity if isinstance(severity, list) else [severity]))


def _table(entry: dict[str, Any]) -> str:
    rows = [[f"Clean {name}", _cell(value)] for name, value in entry["clean"].items()]
    rows += [[name, _cell(value)] for name, value in entry["PRS"].items()]
    rows += [[f"SR under {registry.title(name)}", _cell([sr])] for name, sr in entry["SR"].items()]
    table = markdown_table(["measure", "value, 95 % interval"], rows)
    gaps = f"\n\nNot complete: {', '.join(entry['incomplete'])}." if entry["incomplete"] else ""
    return (
        f"## {markdown_of(entry['split'])}, severity {entry['severity']:g}\n\n"
        f"{counted(entry['episodes'], 'episode')}, seed {', '.join(map(str, entry['seeds']))}, "
        f"suite {markdown_of(entry['suite'])}. "
        f"Success: {markdown_of(entry['rule'])}.\n\n{table}{gaps}"
    )


def _cell(numbers: list[float | None]) -> str:
    texts = ["–" if value is None else f"{value:.3f}" for value in numbers]
    if len(numbers) == 1:
        return texts[0]
    interval = f"[{texts[1]}, {texts[2]}]" if numbers[1] != numbers[2] else NO_INTERVAL
    return f"{texts[0]} {interval}"


def _use(card: dict[str, Any], folder: str) -> str:
    # a JSON string is a string literal of Python with double quotes
    load = f"mitigate.load_hardened({json.dumps(folder, ensure_ascii=False)}"
    whole = card.get("program", True)
    of_user = not whole and card.get("class") not in schema.KINDS
    start = (
        f"## Use\n\n```python\nimport mitigate\n\nagent = {load}"
        f"{', agent=Mine(...)' if of_user else ''})\n```\n\n"
        f"{'Build the agent with the settings in `config.yaml`. ' * of_user}"
        f"{'The weights are loaded into this object. ' * of_user}"
        "Before loading, every file is compared with its sha256 in `manifest.json`. "
    )
    if not whole:
        return (
            f"{start}At export, the agent was also loaded in a new process, where it ran "
            f"{counted(card['checked']['walks'], 'episode')} with the same results."
        )
    times, checked = card["latency_ms"], card["checked"]
    rows = [
        [f"`{name}`, {kind}", *(f"{times[kind][name][which]:g}" for which in ("wall", "cpu"))]
        for name in times["eager"]
        for kind in ("eager", "exported")
    ]
    table = markdown_table(["network", "fastest", "processor"], rows)
    return (
        f"{start}`program.pt2` computes a decision without the code of this project, and "
        "`program.json` describes its inputs. If `program.pt2` is missing, "
        "`mitigate export FOLDER --programs` writes it. At export, the files were loaded in a new "
        "process. There, the outputs on a fixed probe differed by at most "
        f"{checked['reload_tolerance']:g} (agent) and {checked['program_tolerance']:g} (program). "
        f"The largest change of an output by rounding to float16 was {checked['float16']:.2g}.\n\n"
        f"Times in milliseconds on {counted(times['threads'], 'thread')}: the fastest of "
        f"{times['calls']} calls, and the median processor time.\n\n{table}"
    )


def _check(cfg: dict[str, Any]) -> None:
    """Raise ValueError if an untrusted config has an entry that must not appear in a card."""
    schedule = cfg.get("schedule") or {}
    entries = {**cfg, **(schedule if isinstance(schedule, dict) else {})}
    name, stages = entries.get("name"), entries.get("stages") or {}
    valid = {
        "name": isinstance(name, str) and name.isprintable() and "`" not in name,
        "severity": _is_span(entries.get("severity")),
        "severity_depth": entries.get("severity_depth") is None
        or _is_span(entries["severity_depth"]),
        "seed": type(entries.get("seed")) is int,
        "schedule": isinstance(schedule, dict),
        "stages": isinstance(stages, dict)
        and all(isinstance(stage or {}, dict) for stage in stages.values()),
    }
    for key in [key for key, ok in valid.items() if not ok]:
        raise ValueError(
            f"The run's config.yaml has {key}={short(entries.get(key))}, which `make train` never "
            "writes. Export the folder as `make train` wrote it."
        )


def _is_span(severity: Any) -> bool:
    """Return whether ``severity`` is a number or a non-empty list of numbers."""
    numbers = severity if isinstance(severity, list) and severity else [severity]
    return all(type(number) in (int, float) for number in numbers)


def _precision(stages: dict[str, Any]) -> str:
    """Return the precision of the stages: "fp32", "bf16", or both if the stages differ."""
    settings = [(stage or {}).get("trainer") or {} for stage in stages.values()]
    return " and ".join(sorted({s["precision"] for s in settings if s.get("precision")}))


def _teachers(node: Any) -> list[str]:
    if not isinstance(node, dict):
        return []
    paths = [value for key, value in node.items() if key == "teacher" and isinstance(value, str)]
    return paths + [path for value in node.values() for path in _teachers(value)]


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


# Hugging Face's front matter ----------------------------------------------------------------------


def front_matter(card: dict[str, Any]) -> str:
    """Return the front matter of a README for Hugging Face.

    The front matter is YAML between two lines of ``---``. After ``hf upload``, the hub shows a
    model page with the library, the licence, tags and metrics (docs/deployment.md). If there are no
    metrics, there is no ``model-index``. The format is described in
    https://github.com/huggingface/hub-docs/blob/main/modelcard.md
    """
    kind = "adapters" if card["adapters_only"] else "full-weights"
    fields: dict[str, Any] = {
        "library_name": LIBRARY,
        "license": str(card["license"]).lower(),
        "pipeline_tag": TASK,
        "tags": list(dict.fromkeys([*TAGS, kind, _tag(card["recipe"])])),
    }
    if results := [_result(entry) for entry in card["metrics"]]:
        fields["model-index"] = [{"name": card["name"], "results": results}]
    text = yaml.safe_dump(fields, sort_keys=False, allow_unicode=True)
    return f"---\n{text}---\n"


def _result(entry: dict[str, Any]) -> dict[str, Any]:
    """Convert one metrics table of a card to an entry of ``model-index``."""
    severity = f"severity {entry['severity']:g}"
    intervals = [(f"Clean {metric}", value) for metric, value in entry["clean"].items()]
    intervals += entry["PRS"].items()
    metrics = [_metric(title, *value) for title, value in intervals if value[0] is not None]
    metrics += [
        _metric(f"SR under {registry.title(name)}", value, None, None)
        for name, value in entry["SR"].items()
        if value is not None
    ]
    return {
        "task": {"type": TASK, "name": "Embodied navigation"},
        "dataset": {
            "type": DATASET,
            "name": f"{entry['split']}, corruption suite {entry['suite']}, {severity}",
            "config": severity,
            "split": entry["split"],
            "revision": f"suite {entry['suite']}",
            "args": {
                "success": entry["rule"],
                "episodes": entry["episodes"],
                "seeds": list(entry["seeds"]),
            },
        },
        "metrics": metrics,
    }


def _metric(title: str, value: float, low: float | None, high: float | None) -> dict[str, Any]:
    kind = title.partition(" (")[0].partition(",")[0]
    metric: dict[str, Any] = {"type": _tag(kind), "name": title, "value": value}
    if low is not None and high is not None:
        metric["args"] = {"interval": [low, high], "level": LEVEL, "resamples": RESAMPLES}
    return metric


def _tag(text: str) -> str:
    """Convert ``text`` to a Hugging Face tag of lower-case letters, digits and dashes."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")
