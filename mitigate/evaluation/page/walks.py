"""Walks for the page: episodes chosen by rule from the rows, walked again, seen from above.

Rows say how an episode went, not where the agent was. So agents whose weights are at hand walk some
episodes again, with the keys of the rows: what they then measure is compared with their rows, and
the page says where the two differ.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Mapping, Sequence
from itertools import count, islice
from typing import Any

import numpy as np

from mitigate.agents.agent import Agent
from mitigate.agents.fingerprint import fingerprint
from mitigate.core.observation import POSE
from mitigate.corruptions import Corruption
from mitigate.evaluation.episode import instruction
from mitigate.evaluation.episode_lists import GOLDEN
from mitigate.evaluation.rows import Row
from mitigate.evaluation.sections import label
from mitigate.evaluation.trajectories import Walk, first_sight, walked
from mitigate.worlds.episodes import Episode, from_vlnce
from mitigate.worlds.world import World, as_world

KINDS = {  # (the first agent succeeds, the last one does): what the page calls it
    (False, True): "won back",
    (False, False): "lost by both",
    (True, True): "won by both",
    (True, False): "lost by the last",
}
ALONE = {True: "won", False: "lost"}  # where there is one agent


def outcome(won: Sequence[bool]) -> str:
    """Return what the page calls it that the agents won or not, in their order."""
    return KINDS[won[0], won[-1]] if len(won) > 1 else ALONE[won[0]]


def choose(rows: Sequence[Row], agents: Sequence[str], most: int) -> list[tuple[str, Corruption]]:
    """Return at most ``most`` pairs (episode id, corruption) that the first and the last of
    ``agents`` both met.

    By turns of the kinds of :data:`KINDS`, and of each kind by turns of the corruptions, in the
    order of ``rows``; no episode twice. It is a choice to look at, not a sample: how often each
    kind comes is in the tables.
    """
    first, last = _won(rows, agents[0]), _won(rows, agents[-1])
    found: dict[tuple[bool, bool], dict[tuple[str, float], list[str]]] = {k: {} for k in KINDS}
    for place, won in first.items():
        if place in last:
            episode, corruption, severity = place
            kind = (bool(won), bool(last[place]))
            found[kind].setdefault((corruption, severity), []).append(episode)
    turns = [_turns(held, offset) for offset, held in enumerate(found.values())]
    return list(islice(_once(turns), most))


def _won(rows: Sequence[Row], name: str) -> dict[tuple[str, str, float], float]:
    """Return the success of an agent under each corruption, of the lowest seed that it ran with."""
    own = [row for row in rows if row["name"] == name and row["corruption"] != "clean"]
    seed = min((row["seed"] for row in own), default=0)
    kept = [row for row in own if row["seed"] == seed]
    return {(r["episode_id"], r["corruption"], float(r["severity"])): r["success"] for r in kept}


def _turns(
    held: Mapping[tuple[str, float], Sequence[str]], offset: int
) -> Iterator[tuple[str, Corruption]]:
    """Yield the first of each corruption, then the second of each and so on; ``offset``: which
    corruption begins."""
    names = [*held][offset:] + [*held][:offset]
    for turn in count():
        left = [at for at in names if len(held[at]) > turn]
        if not left:
            return
        for at in left:
            yield held[at][turn], Corruption(*at)


def _once(turns: Sequence[Iterator[Any]]) -> Iterator[tuple[str, Corruption]]:
    """Yield from each of ``turns`` in turn what is of an episode not yet seen."""
    seen: set[str] = set()
    waiting = list(turns)
    while waiting:
        for turn in list(waiting):
            found = next((pair for pair in turn if pair[0] not in seen), None)
            if found is None:
                waiting.remove(turn)
            else:
                seen.add(found[0])
                yield found


AGREED = ("success", "spl", "steps")
CLOSE = 1e-6  # of a measure that rows round to six digits
PLAN_INCHES, PLAN_DPI, PLAN_COLOURS = 6.0, 110, 64  # of a plan's longer side (ours)
QUALITY = 80  # of a JPEG of the first view


def walk_again(
    agents: Mapping[str, Agent],
    world: World,
    episodes: Sequence[Episode],
    rows: Sequence[Row],
    *,
    most: int,
    seed: int,
) -> Iterator[dict[str, Any]]:
    """Yield each chosen episode as the page reads it, walked by the first agent clean, and by all
    corrupted.

    ``agents`` by their names in ``rows``, which are of one split and rule; of these, those of other
    agents of that name, or of another seed, are passed over. Raises ValueError if an agent has none
    at all, no episode is to be chosen, or the world has no poses.
    """
    if POSE not in world.sensors:
        raise ValueError("This world gives no poses, so there is no walk to be drawn.")
    known = {episode.episode_id: episode for episode in episodes}
    spread = {episode_id: n * GOLDEN % 1 for n, episode_id in enumerate(known)}
    hashes = {name: fingerprint(agent, world.sensors) for name, agent in agents.items()}
    own = [row for row in _own(rows, hashes) if row["episode_id"] in known and row["seed"] == seed]
    own.sort(key=lambda row: spread[row["episode_id"]])
    chosen = choose(own, list(agents), most)
    if not chosen:
        raise ValueError(
            f"No episode of these was met under a corruption by {' and '.join(agents)} with seed "
            f"{seed}: the names must be those of the rows."
        )
    index = {(r["name"], r["episode_id"], r["corruption"], r["severity"]): r for r in own}
    for episode_id, corruption in chosen:
        with as_world(world).remembering():
            episode = known[episode_id]
            walks = list(walked(agents, world, episode, corruption, seed))
            views = [_jpeg(sight) for sight in first_sight(world, episode, corruption, seed)[1]]
            drawn = _drawn(episode, corruption, walks, index, hashes)
            drawn |= {key: own[0][key] for key in ("split", "rule", "seed")}
            drawn |= {"views": views, "heard": instruction(episode, corruption, seed)}
            yield drawn | _plan(world)


def _own(rows: Sequence[Row], hashes: Mapping[str, str]) -> list[Row]:
    """Return the rows of the agents of ``hashes``, by name. Raises ValueError if one has none."""
    for name, own in hashes.items():
        others = sorted({row["agent"] for row in rows if row["name"] == name})
        if others and own not in others:
            raise ValueError(
                f"The rows of {name} are of {', '.join(others)}, and the weights named for it are "
                f"{own}, another agent: name the weights that made the rows, and what `mitigate "
                "evaluate` was told of the agent and the world (agent=..., env.views=1)."
            )
    return [row for row in rows if hashes.get(row["name"]) == row["agent"]]


def _drawn(
    episode: Episode,
    corruption: Corruption,
    walks: Sequence[Walk],
    index: Mapping[tuple, Row],
    hashes: Mapping[str, str],
) -> dict[str, Any]:
    reference = [from_vlnce(point) for point in episode.reference_path or ()]
    return {
        "episode": episode.episode_id,
        "instruction": episode.instruction.text,
        "corruption": corruption.name,
        "title": label(corruption.name),
        "severity": corruption.severity,
        "kind": outcome([walk.won for walk in walks[1:]]),
        "reference": _points(reference),
        "goals": _points([from_vlnce(goal.position) for goal in episode.goals]),
        "walks": [_walk(walk, episode, index) | {"hash": hashes[walk.agent]} for walk in walks],
    }


def _walk(walk: Walk, episode: Episode, index: Mapping[tuple, Row]) -> dict[str, Any]:
    met = walk.corruption
    row = index.get((walk.agent, episode.episode_id, met.name, met.severity))
    shared = [key for key in AGREED if row is not None and key in row and key in walk.measures]
    same = [abs(walk.measures[key] - row[key]) < CLOSE for key in shared] if row else []
    left = float(walk.metres_left)
    return {
        "agent": walk.agent,
        "clean": met.name == "clean",
        "won": walk.won,
        "left": round(left, 1) if np.isfinite(left) else None,
        "steps": walk.measures.get("steps"),
        "agrees": all(same) if same else None,
        "points": _points(walk.path),
    }


def _points(path: Any) -> list[list[float]]:
    return [[round(float(x), 2), round(float(y), 2)] for x, y in path]


def _plan(world: World) -> dict[str, Any]:
    """Return the plan as a PNG, where the world draws one, and its corners [x0, y0, x1, y1] in
    metres."""
    draw = as_world(world).draw
    if draw is None:
        return {"plan": None, "corners": None}
    from matplotlib.figure import Figure

    figure = Figure(figsize=(PLAN_INCHES, PLAN_INCHES))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    draw(axes)
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    longer = max(x1 - x0, y1 - y0)
    figure.set_size_inches(PLAN_INCHES * (x1 - x0) / longer, PLAN_INCHES * (y1 - y0) / longer)
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=PLAN_DPI, facecolor="white", format="png")
    corners = [round(float(x), 3) for x in (x0, y0, x1, y1)]
    return {"plan": _address("png", _fewer_colours(drawn)), "corners": corners}


def _fewer_colours(png: io.BytesIO) -> bytes:
    from PIL import Image

    out = io.BytesIO()
    Image.open(png).convert("RGB").quantize(PLAN_COLOURS).save(out, "PNG", optimize=True)
    return out.getvalue()


def _jpeg(picture: np.ndarray) -> str:
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture)).save(out, "JPEG", quality=QUALITY)
    return _address("jpeg", out.getvalue())


def _address(kind: str, data: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
