"""Compute result rows from what a command's processes report about their episodes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.bridge.events import MEASURES, damaged, episode_name, read_events
from mitigate.bridge.hook.mitigate_hook import CLOSE, OVER
from mitigate.corruptions import SUITE_VERSION, Corruption
from mitigate.corruptions.registry import version
from mitigate.evaluation.rows import Row
from mitigate.worlds.measures import RULES, Rule, path_length, spl

OWN = "own: the agent's Success measure"
# if depth that is declared in metres never exceeds this value, it may be normalised (heuristic)
NORMALISED_LIMIT = 1.01
NORMALISED_HINT = (
    "is it normalised? If so, describe it, with the camera's own name and range: corrupt(..., "
    "cameras={'depth': {'normalize_depth': True, 'min_depth': 0.0, 'max_depth': 10.0}})"
)
CUT_OFF = (
    "its Env was closed before the episode was over while other Envs ran in parallel, as when an "
    "evaluator stops after a number of episodes. Choose episodes by episodes= and let the program "
    "run all of them. If the program ends its episodes this way, set count_closed=true"
)
# COMMON maps each task to its common success rule.
# A task is recognised by its first episode, which has either a "category" or a "text".
# The rules do not use STOP, because some programs never report it.
COMMON = {"category": RULES["wmnav"], "text": RULES["etpnav"]}


@dataclass
class Reports:
    """All reports that a command's processes have sent under one condition."""

    # the first message of each connection, with the versions of Python and libraries
    hellos: list[dict[str, Any]] = field(default_factory=list)
    # the first description of each camera
    cameras: list[dict[str, Any]] = field(default_factory=list)
    # Descriptions of observations that look like frames, but do not come from cameras. They belong
    # to the first call. Each contains the type of its sensor.
    unread: list[str] = field(default_factory=list)
    # maps the name of each episode to the event of its end (:meth:`end`)
    ends: dict[str, dict[str, Any]] = field(default_factory=dict)
    repeated: int = 0  # number of episodes that ended more than once
    # episodes that were left unfinished, with the reason if known
    dropped: dict[str, str] = field(default_factory=dict)
    parallel: bool = False  # whether an episode ended while another one was running
    # failures of the server, and reasons why processes stopped themselves
    problems: list[str] = field(default_factory=list)
    first: dict[str, Any] = field(default_factory=dict)  # the event that began the first episode
    # language of the instruction, by episode name
    languages: dict[str, str | None] = field(default_factory=dict)
    adapted: bool = False  # whether adapters were attached to an encoder
    connected: int = 0  # number of environments that are connected now
    announced: int = 0  # number of episodes that the program must run
    ended: int = 0  # number of episodes that ended

    @property
    def lost(self) -> list[str]:
        """The names of the episodes that were begun but never finished."""
        return sorted(self.dropped.keys() - self.ends.keys())

    def end(self, name: str, event: dict[str, Any]) -> None:
        """Record the event that reports the end of an episode.

        The first event counts, but an event that says that the episode was over replaces an earlier
        reset or close.
        """
        before = self.ends.get(name)
        if before is None or (_how(event) == OVER != _how(before)):
            self.ends[name] = event
        elif _how(event) != CLOSE:
            self.repeated += 1
            if event.get("loop"):
                self.problems.append(
                    f"each episode must have its own name, but {name} ended twice. Pass a "
                    "different name or scene to mitigate_hook.connect for each episode."
                )
        if before is not None and before["scene"] != event["scene"]:
            self.problems.append(
                f"scene files must have different names, got {before['scene']} and "
                f"{event['scene']}: episodes are named after them. Rename the files."
            )


def read(folder: Path, count_closed: bool = False) -> Reports:
    """Read the reports from the events in ``folder``; ignore an incomplete last line.

    Args:
        folder: The folder of a condition.
        count_closed: Whether to count an episode whose Env was closed before the episode was over,
            while other Envs ran in parallel.

    Raises:
        ValueError: If another line is damaged. The message names the file and the line, and says
            what to do.
    """
    reports, began = Reports(), dict[int, int]()
    for number, event in read_events(folder):
        try:
            _add(reports, event, began)
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise damaged(folder, f"line {number} is not an event of this version") from error
    # An evaluator with parallel Envs cuts off running episodes when it closes the Envs.
    # A single Env, however, may be closed to end its episode.
    if reports.parallel and not count_closed:
        closed = [name for name, end in reports.ends.items() if _how(end) == CLOSE]
        reports.dropped |= dict.fromkeys(closed, CUT_OFF)
        reports.ends = {name: end for name, end in reports.ends.items() if name not in closed}
    return reports


def _add(reports: Reports, event: dict[str, Any], began: dict[int, int]) -> None:
    """Add one event to the reports.

    Args:
        reports: The reports from all earlier events.
        event: One line of the events.
        began: For each connection, the number of episodes that had ended when its current episode
            began.
    """
    kind = event["event"]
    name = episode_name(event.get("scene", ""), event.get("episode", ""))
    if kind == "hello":
        reports.hellos.append(event)
        reports.connected += 1
    elif kind == "bye":
        reports.connected -= 1
    elif kind == "spec":
        reports.unread = reports.unread or event.get("unread", [])
        known = {camera.get("name") for camera in reports.cameras}
        reports.cameras += [c for c in event["cameras"] if c.get("name") not in known]
    elif kind == "dataset":
        reports.announced = max(reports.announced, int(event.get("wanted") or 0))
    elif kind == "episode":
        reports.first = reports.first or event
        reports.languages[name] = event.get("language")
        began[event.get("pid", 0)] = reports.ended
    elif kind == "end":
        reports.end(name, event)
        reports.parallel |= began.get(event.get("pid", 0), reports.ended) < reports.ended
        reports.ended += 1
    elif kind == "dropped":
        reports.dropped[name] = str(event.get("fault") or "")
    elif kind == "adapted":
        reports.adapted = True
    elif kind in ("refused", "stopped"):
        reports.problems.append(event["problem"])


def _how(end: dict[str, Any]) -> str:
    return end.get("how", OVER)


def rows(
    reports: Reports,
    corruption: Corruption,
    label: dict[str, Any],
    rule: str | None,
    clean: Reports | None = None,
) -> list[Row]:
    """Return the rows of one condition, judged by the agent's success rule and by a common rule.

    Args:
        reports: The reports of the condition.
        corruption: The corruption of the condition.
        label: Values that are the same in all rows ("agent", "name", "split", "seed").
        rule: A name in ``RULES``; this rule replaces the agent's own Success measure. If it is None
            and the agent reports no Success measure, all rows are judged by the common rule.
        clean: The reports of the clean condition, if ``reports`` belong to a different condition.
    """
    rules = _choose_rules(reports, rule, clean)
    return [
        {
            "agent": label["agent"],
            "name": label["name"],
            "corruption": corruption.name,
            "severity": corruption.severity,
            "split": label["split"],
            "episode_id": name,
            "seed": label["seed"],
            "suite": SUITE_VERSION,
            **version(corruption.name),
            **judged,
            **_measures(end),
        }
        for name, end in reports.ends.items()
        for judged in _judge(end, rule, rules)
    ]


def _choose_rules(reports: Reports, rule: str | None, clean: Reports | None = None) -> list[Rule]:
    """Return the requested success rule and the common success rule.

    The common rule is omitted in each of these cases:

    - The task has no common rule. An example is PointNav, which has neither words nor objects.
    - An episode can be judged by the agent's own rule, but not by the common rule.
    - Neither this condition nor the clean condition reports a distance.
    """
    requested = [RULES[rule]] if rule else []
    task = next((name for name in COMMON if reports.first.get(name)), None)
    if task is None:
        return requested
    ends = [*reports.ends.values()]
    with_success = [end for end in ends if "success" in end.get("metrics", {})]
    # whether the agent's own rule can judge an episode that the common rule cannot
    partial = any(_missing(end, COMMON[task]) for end in with_success)
    all_ends = [*ends, *(clean.ends.values() if clean is not None else ())]
    no_distance = all(_goal_distance(end) is None for end in all_ends)
    return requested + ([] if partial or no_distance else [COMMON[task]])


def _judge(end: dict[str, Any], rule: str | None, rules: Iterable[Rule]) -> Iterable[Row]:
    """Return the success and SPL of an episode for each success rule that can judge it."""
    metrics, judged = end.get("metrics", {}), {}
    if rule is None and "success" in metrics:
        success = float(metrics["success"]) > 0
        spl_value = metrics["spl"] if "spl" in metrics else _spl(end, success)
        judged[OWN] = {"rule": OWN, "success": float(success), "spl": spl_value}
    for known in rules:
        if not _missing(end, known):
            metres = _goal_distance(end)
            success = metres is not None and known.met(metres, bool(end.get("stopped")))
            values = {"rule": str(known), "success": float(success), "spl": _spl(end, success)}
            judged[str(known)] = values
    return judged.values()


def _goal_distance(end: dict[str, Any]) -> Any:
    """Return the distance to the goal in metres, or None if it is unknown."""
    return end.get("distance", end.get("metrics", {}).get("distance_to_goal"))


def _missing(end: dict[str, Any], rule: Rule) -> str:
    """Return the argument of ``finish`` that ``rule`` needs and that this episode lacks, or "".

    A reported failure without a distance is a failure by every rule. An episode that ends too far
    from the goal is also a failure, with or without STOP.
    """
    metres = _goal_distance(end)
    if metres is None:
        return "" if end.get("metrics", {}).get("success", 1) <= 0 else "distance_to_goal"
    return "stopped" if end.get("stopped") is None and rule.stop and rule.met(metres, True) else ""


def count_missing(reports: Reports, rule: str) -> dict[str, int]:
    """Count the episodes that lack an argument that ``rule`` needs, by argument."""
    counts = Counter(_missing(end, RULES[rule]) for end in reports.ends.values())
    return {name: count for name, count in counts.most_common() if name}


def _spl(end: dict[str, Any], success: bool) -> float:
    """Return the SPL of the reported path, or else the SPL that the agent reported.

    The SPL of a successful episode is 1 if the agent reported neither a path nor an SPL. Such
    episodes are counted by :func:`count_without_path`.
    """
    start, length = _shortest_path(end), _path_length(end)
    if not success:
        return 0.0
    if start is None or length is None:
        return float(end["metrics"]["spl"]) if _has_spl(end) else 1.0
    return spl(success, float(start), length)


def _has_spl(end: dict[str, Any]) -> bool:
    """Return whether the agent reported an SPL for a success."""
    metrics = end.get("metrics", {})
    return "spl" in metrics and metrics.get("success", 0) > 0


def count_without_path(reports: Reports, rule: str | None) -> dict[str, int]:
    """For each rule, count the successes that have neither an SPL nor a path to compute it from."""
    counts: Counter[str] = Counter()
    rules = _choose_rules(reports, rule)
    for end in reports.ends.values():
        if not _has_spl(end) and (_shortest_path(end) is None or _path_length(end) is None):
            judged = _judge(end, rule, rules)
            counts.update(str(row["rule"]) for row in judged if row["success"])
    return dict(counts)


def maybe_normalised(reports: Reports) -> list[str]:
    """Return the cameras with depth in metres that never exceeds ``NORMALISED_LIMIT``."""
    maximum: dict[str, float] = {}
    for end in reports.ends.values():
        for name, metres in end.get("farthest", {}).items():
            maximum[name] = max(maximum.get(name, 0.0), metres or 0.0)
    metric = [c["name"] for c in reports.cameras if not c.get("normalize_depth")]
    return [name for name in metric if 0 < maximum.get(name, 0.0) <= NORMALISED_LIMIT]


def _shortest_path(end: dict[str, Any]) -> float | None:
    """Return the length of the shortest path in metres.

    The result is None if the length is unknown or if there is no path.
    """
    metres = end.get("start_distance", end.get("metrics", {}).get("geodesic_distance"))
    return metres if metres is not None and math.isfinite(metres) else None


def _path_length(end: dict[str, Any]) -> float | None:
    if path := end.get("path"):
        return path_length(np.array(path))
    return end.get("metrics", {}).get("path_length")


def _measures(end: dict[str, Any]) -> dict[str, Any]:
    """Return the entries of a row that do not depend on a success rule."""
    metrics = end.get("metrics", {})
    measures: dict[str, Any] = {
        "path_length": _path_length(end),
        "geodesic_distance": end.get("start_distance"),
        "distance_to_goal": end.get("distance"),
    }
    measures = {n: v for n, v in measures.items() if v is not None}
    measures |= {n: metrics[n] for n in MEASURES if n in metrics}
    finite = {n: v for n, v in measures.items() if math.isfinite(v)}
    return finite | {"decisions": end.get("calls", 0), "steps": end.get("steps", 0)}
