"""What stands above a card's README for Hugging Face: YAML that its model repositories read.

``hf upload`` of a folder as it is then makes a model page with library, licence, tags and the
metrics with their intervals (docs/deployment.md). The form:
https://github.com/huggingface/hub-docs/blob/main/modelcard.md
"""

from __future__ import annotations

import re
from typing import Any

import yaml

from mitigate.evaluation.bootstrap import LEVEL, RESAMPLES
from mitigate.evaluation.sections import label

LIBRARY = "mitigate"
TASK = "robotics"  # of Hugging Face's list of tasks, the one for agents that move
TAGS = ("embodied-navigation", "robustness", "sensor-corruption", "safetensors")
DATASET = "mitigate-episodes"  # ours; no data set of the hub


def front_matter(card: dict[str, Any]) -> str:
    """Return the YAML of a card, between its two lines of ``---``, without ``model-index`` where
    there are no metrics."""
    kind = "adapters" if card["adapters_only"] else "full-weights"
    held: dict[str, Any] = {
        "library_name": LIBRARY,
        "license": str(card["license"]).lower(),
        "pipeline_tag": TASK,
        "tags": list(dict.fromkeys([*TAGS, kind, _tag(card["recipe"])])),
    }
    results = [_result(entry) for entry in card["metrics"]]
    if results:
        held["model-index"] = [{"name": card["name"], "results": results}]
    text = yaml.dump(held, Dumper=_Quoting, sort_keys=False, allow_unicode=True)
    return f"---\n{text}---\n"


class _Quoting(yaml.SafeDumper):
    """Quotes texts that YAML 1.2, which the hub reads, takes for numbers and PyYAML's 1.1 does
    not: 1e3, 08."""


def _represent(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = "'" if re.match(r"[-+.]*\d", text) else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Quoting.add_representer(str, _represent)


def _result(entry: dict[str, Any]) -> dict[str, Any]:
    """Return one table of a card as a result of ``model-index``."""
    severity = f"severity {entry['severity']:g}"
    found = [(f"Clean {metric}", value) for metric, value in entry["clean"].items()]
    found += entry["PRS"].items()
    metrics = [_metric(title, *value) for title, value in found if value[0] is not None]
    metrics += [
        _metric(f"SR, {label(name)}", value, None, None)
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
    found: dict[str, Any] = {"type": _tag(kind), "name": title, "value": value}
    if low is not None and high is not None:
        found["args"] = {"interval": [low, high], "level": LEVEL, "resamples": RESAMPLES}
    return found


def _tag(text: str) -> str:
    """Return ``text`` as the hub writes tags: small letters, digits and dashes."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")
