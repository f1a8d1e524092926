"""What a command's processes told of their episodes, as result rows."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.bridge.events import MEASURES, damaged, name_of, read_events
from mitigate.bridge.hook.mitigate_hook import CLOSE, OVER
from mitigate.corruptions import SUITE_VERSION, Corruption
from mitigate.corruptions.registry import version
from mitigate.evaluation.rows import Row
from mitigate.worlds.measures import RULES, Rule, path_length, spl

OWN = "own: the agent's Success measure"
NEAR = 1.01  # metres: depth that reads no more may be normalised (ours)
NORMALISED = "is it normalised? Say so: normalize_depth, min_depth, max_depth"
CUT_OFF = (
    "its Env was closed before the episode was over, and other Envs walked beside it, as where an "
    "evaluator cuts them off: choose by episodes= and let it walk all, or, if the program ends "
    "its episodes so, count_closed=true"
)
COMMON = {"words": RULES["etpnav"], "objects": RULES["wmnav"]}  # need no STOP: some never say it


@dataclass
class Told:
    """What was told under one condition, so far.

    ends: of each episode, by its name, the first that was over, or else the first; again: episodes
    that ended once more; dropped: left in the middle, and why, where that is known. beside: whether
    an episode ended while another was on. cameras: of all calls, as first described;
    first: what the first episode says; languages: of the episodes' words, by name. refused: what
    the server could not do, and why processes stopped themselves, in words. adapted: encoders that
    got adapters. connected: environments that are there now.
    """

    hellos: list[dict[str, Any]] = field(default_factory=list)
    cameras: list[dict[str, Any]] = field(default_factory=list)
    ends: dict[str, dict[str, Any]] = field(default_factory=dict)
    again: int = 0
    dropped: dict[str, str] = field(default_factory=dict)
    beside: bool = False
    refused: list[str] = field(default_factory=list)
    first: dict[str, Any] = field(default_factory=dict)
    languages: dict[str, str | None] = field(default_factory=dict)
    adapted: list[str] = field(default_factory=list)
    connected: int = 0
    announced: int = 0
    ended: int = 0

    @property
    def lost(self) -> list[str]:
        """Episodes that were left in the middle, and did not end later."""
        return sorted(self.dropped.keys() - self.ends.keys())

    def announce(self, event: dict[str, Any]) -> None:
        """Take how many episodes a program is to run: of its own list, by ``wanted``."""
        if event.get("wanted") is not None:
            self.announced = max(self.announced, int(event["wanted"]))

    def end(self, name: str, event: dict[str, Any]) -> None:
        """Take how an episode ended: what was over is in place of a try that was given up."""
        held = self.ends.get(name)
        if held is None or (_how(event) == OVER != _how(held)):
            self.ends[name] = event
        elif _how(event) != CLOSE:
            self.again += 1
        if held is not None and held["scene"] != event["scene"]:
            self.refused.append(
                f"two scenes have one file name, {held['scene']} and {event['scene']}: "
                "episodes are told apart by it. Rename the scenes' files."
            )

    def without_closed(self) -> Told:
        """Drop episodes whose Env was closed before they were over, if Envs walked side by side: an
        evaluator cuts them off so. An Env that walks alone ends its episode by a close."""
        if self.beside:
            closed = [name for name, end in self.ends.items() if _how(end) == CLOSE]
            self.dropped.update(dict.fromkeys(closed, CUT_OFF))
            self.ends = {n: end for n, end in self.ends.items() if n not in closed}
        return self


def read(folder: Path, count_closed: bool = False) -> Told:
    """Return what the events in ``folder`` tell; a last line without its end is left out.

    count_closed: episodes whose Env was closed before they were over count as they stood, though
    Envs walked side by side.

    Raises:
        ValueError: Another line is damaged. The message names the file, the line and what to do.
    """
    told, began = Told(), dict[int, int]()
    for number, event in read_events(folder):
        try:
            _take(told, event, began)
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise damaged(folder, f"line {number} is no event of this version") from error
    return told if count_closed else told.without_closed()


def _take(told: Told, event: dict[str, Any], began: dict[int, int]) -> None:
    """Add one event to what was told.

    Args:
        told: What the events before it told.
        event: One line of the events.
        began: Per connection, how many episodes had ended when its episode began.
    """
    kind, name = event["event"], name_of(event.get("scene", ""), event.get("episode", ""))
    if kind == "hello":
        told.hellos.append(event)
        told.connected += 1
    elif kind == "bye":
        told.connected -= 1
    elif kind == "spec":
        known = {camera.get("name") for camera in told.cameras}
        told.cameras += [c for c in event["cameras"] if c.get("name") not in known]
    elif kind == "dataset":
        told.announce(event)
    elif kind == "episode":
        told.first = told.first or event
        told.languages[name] = event.get("language")
        began[event.get("pid", 0)] = told.ended
    elif kind == "end":
        told.end(name, event)
        told.beside = told.beside or began.get(event.get("pid", 0), told.ended) < told.ended
        told.ended += 1
    elif kind == "dropped":
        told.dropped[name] = str(event.get("fault") or "")
    elif kind == "adapted":
        told.adapted.append(event["module"])
    elif kind in ("refused", "stopped"):
        told.refused.append(event["problem"])


def _how(end: dict[str, Any]) -> str:
    return end.get("how", OVER)


def rows(
    told: Told,
    corruption: Corruption,
    label: dict[str, Any],
    rule: str | None,
    clean: Told | None = None,
) -> list[Row]:
    """Return the rows of one condition, by the agent's own rule of success and by a common one.

    label: what all rows say ("agent", "name", "split", "seed"). rule: of ``RULES``, in place of the
    agent's Success measure. An agent without either has the common one alone. clean: what was told
    of the clean condition, if that is another.
    """
    found, rules = [], _rules(told, rule, clean)
    for name, end in told.ends.items():
        row = {
            "agent": label["agent"],
            "name": label["name"],
            "corruption": corruption.name,
            "severity": corruption.severity,
            "split": label["split"],
            "episode_id": name,
            "seed": label["seed"],
            "suite": SUITE_VERSION,
            **version(corruption.name),
        }
        for own in _by_rules(end, rule, rules):
            found.append(row | own | _measures(end))
    return found


def _common(told: Told) -> Rule:
    routes = told.first.get("text") and not told.first.get("category")
    return COMMON["words" if routes else "objects"]


def _rules(told: Told, rule: str | None, clean: Told | None = None) -> list[Rule]:
    """The rule that is asked for, and the common one. This is left out where it cannot judge an
    episode that the agent's own rule judges, and where nobody tells a distance, here or in clean:
    it would be of some episodes alone."""
    common, ends = _common(told), [*told.ends.values()]
    left = any(_unknown(end, common) for end in ends if "success" in end.get("metrics", {}))
    tell = [*ends, *(clean.ends.values() if clean is not None else ())]
    far = all(_metres(end) is None for end in tell)
    return ([RULES[rule]] if rule else []) + ([] if left or far else [common])


def _by_rules(end: dict[str, Any], rule: str | None, rules: Iterable[Rule]) -> Iterable[Row]:
    """Success and SPL of one episode by each rule that can be applied, each once."""
    metrics, judged = end.get("metrics", {}), {}
    if rule is None and "success" in metrics:
        won = float(metrics["success"]) > 0
        judged[OWN] = {
            "success": float(won),
            "spl": metrics["spl"] if "spl" in metrics else _spl(end, won),
        }
    for known in rules:
        if not _unknown(end, known):
            metres = _metres(end)
            won = metres is not None and known.met(metres, bool(end.get("stopped")))
            judged[str(known)] = {"success": float(won), "spl": _spl(end, won)}
    return [{"rule": name, **values} for name, values in judged.items()]


def _metres(end: dict[str, Any]) -> Any:
    """Metres to the goal; None where nobody knows."""
    return end.get("distance", end.get("metrics", {}).get("distance_to_goal"))


def _unknown(end: dict[str, Any], rule: Rule) -> str:
    """What an episode does not tell and a rule needs to judge it: an argument of ``finish``. A
    failure that was told without a distance is one by every rule, and so is one too far away,
    with STOP or without."""
    metres = _metres(end)
    if metres is None:
        return "" if end.get("metrics", {}).get("success", 1) <= 0 else "distance_to_goal"
    return "stopped" if end.get("stopped") is None and rule.stop and rule.met(metres, True) else ""


def unjudged(told: Told, rule: str) -> dict[str, int]:
    """What a rule needs to judge episodes and they do not tell, and how many; empty if it can judge
    all."""
    found = Counter(_unknown(end, RULES[rule]) for end in told.ends.values())
    return {what: count for what, count in found.most_common() if what}


def _spl(end: dict[str, Any], won: bool) -> float:
    """SPL by the path that was told, or the agent's own; where it tells neither of a success, 1, as
    if the way had been the shortest (:func:`without_path` counts these)."""
    start, length = _start(end), _length(end)
    if not won:
        return 0.0
    if start is None or length is None:
        return float(end["metrics"]["spl"]) if _tells_spl(end) else 1.0
    return spl(won, float(start), length)


def _tells_spl(end: dict[str, Any]) -> bool:
    """Whether the agent's own SPL is that of a success."""
    metrics = end.get("metrics", {})
    return "spl" in metrics and metrics.get("success", 0) > 0


def without_path(told: Told, rule: str | None) -> dict[str, int]:
    """By rule: how many successes tell neither SPL nor the start and path to compute it by."""
    found: Counter[str] = Counter()
    rules = _rules(told, rule)
    for end in told.ends.values():
        if not _tells_spl(end) and (_start(end) is None or _length(end) is None):
            judged = _by_rules(end, rule, rules)
            found.update(str(row["rule"]) for row in judged if row["success"])
    return dict(found)


def near(told: Told) -> list[str]:
    """Cameras whose depth is told as metres and read no more than ``NEAR`` in any episode."""
    most: dict[str, float] = {}
    for end in told.ends.values():
        for name, metres in end.get("farthest", {}).items():
            most[name] = max(most.get(name, 0.0), metres or 0.0)
    metric = [c["name"] for c in told.cameras if not c.get("normalize_depth")]
    return [name for name in metric if 0 < most.get(name, 0.0) <= NEAR]


def _start(end: dict[str, Any]) -> float | None:
    """Metres of the shortest way; None where it is not known or there is none."""
    metres = end.get("start_distance", end.get("metrics", {}).get("geodesic_distance"))
    return metres if metres is not None and math.isfinite(metres) else None


def _length(end: dict[str, Any]) -> float | None:
    path = end.get("path") or []
    if len(path) > 0:
        return path_length(np.array(path))
    return end.get("metrics", {}).get("path_length")


def _measures(end: dict[str, Any]) -> dict[str, Any]:
    metrics = end.get("metrics", {})
    found: dict[str, Any] = {name: metrics[name] for name in MEASURES if name in metrics}
    known = {
        "path_length": _length(end),
        "geodesic_distance": end.get("start_distance"),
        "distance_to_goal": end.get("distance"),
    }
    found = {name: value for name, value in known.items() if value is not None} | found
    found = {name: value for name, value in found.items() if math.isfinite(value)}
    return found | {"decisions": end.get("calls", 0), "steps": end.get("steps", 0)}
