"""Run some evaluated episodes again, and plot their trajectories on floor plans for the page.

Result rows contain measures but no trajectories. Therefore agents whose weights are available run
some episodes again, with the same random keys as in the rows. The new measures are compared with
the rows, and the page reports differences.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, zip_longest
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from mitigate.agents.agent import Agent
from mitigate.agents.fingerprint import fingerprint
from mitigate.core.observation import POSE
from mitigate.corruptions import Corruption, registry
from mitigate.evaluation.episode import instruction
from mitigate.evaluation.episode_lists import GOLDEN
from mitigate.evaluation.rows import Row
from mitigate.evaluation.trajectories import DPI, Walk, draw_episode, run_agents
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World, as_world

KINDS = {  # maps (success of the first agent, success of the last agent) to the name of the outcome
    (False, True): "won back",
    (False, False): "lost by both",
    (True, True): "won by both",
    (True, False): "lost by the last",
}


def outcome(won: Sequence[bool]) -> str:
    """Return the name of the outcome; ``won`` holds the success of each agent in order."""
    if len(won) == 1:
        return "won" if won[0] else "lost"
    return KINDS[won[0], won[-1]]


def choose(rows: Sequence[Row], agents: Sequence[str], most: int) -> list[tuple[str, Corruption]]:
    """Choose at most ``most`` pairs (episode id, corruption) that the first and last agent both
    ran.

    The pairs cycle through the outcomes in :data:`KINDS`. When an outcome recurs, its next
    corruption is used. The choice follows the order of ``rows``, which must all have the same seed.
    No episode is repeated. The result is for display and is not a random sample; the tables show
    the frequencies.
    """
    first, last = (
        {
            (row["episode_id"], row["corruption"], float(row["severity"])): bool(row["success"])
            for row in rows
            if row["name"] == name and row["corruption"] != "clean"
        }
        for name in (agents[0], agents[-1])
    )
    outcomes: dict[tuple[bool, bool], dict[Corruption, list[str]]] = {kind: {} for kind in KINDS}
    for place in (place for place in first if place in last):
        episode, name, severity = place
        by_corruption = outcomes[first[place], last[place]]
        by_corruption.setdefault(Corruption(name, severity), []).append(episode)
    turns: dict[tuple[int, int], list[tuple[str, Corruption]]] = {}
    for number, by_corruption in enumerate(outcomes.values()):
        for index, (corruption, episodes) in enumerate(by_corruption.items()):
            # the offset makes the list of each outcome start at a different corruption
            turn = (index - number) % len(by_corruption)
            turns[turn, number] = [(episode, corruption) for episode in episodes]
    chosen: dict[str, Corruption] = {}
    for pair in chain(*zip_longest(*(turns[key] for key in sorted(turns)))):
        if pair is not None:
            chosen.setdefault(*pair)
    return list(chosen.items())[:most]


AGREED = ("success", "spl", "steps")  # these measures of the new runs are compared with the rows
CLOSE = 1e-6  # tolerance for the comparison, because rows hold measures rounded to six digits
COLOURS = 64  # number of colours per picture; few colours keep the page small (heuristic)


def walk_again(
    agents: Mapping[str, Agent],
    world: World,
    episodes: Sequence[Episode],
    rows: Sequence[Row],
    *,
    most: int,
    seed: int,
) -> Iterator[dict[str, Any]]:
    """Yield the page's data of each chosen episode.

    All agents run the episode under its corruption; the first agent also runs it without
    corruption.

    Args:
        agents: agents by their names in ``rows``.
        world: the world.
        episodes: the episodes of the split.
        rows: result rows of one split and success rule. Rows of other agents or seeds are ignored.
        most: maximum number of episodes.
        seed: corruption seed.

    Raises:
        ValueError: If an agent has no rows, if no episode can be chosen, or if the world has no
            poses.
    """
    if POSE not in world.sensors:
        raise ValueError(
            "Trajectories can only be plotted in a world with poses, and this world has none."
        )
    known = {episode.episode_id: episode for episode in episodes}
    spread = {episode_id: n * GOLDEN % 1 for n, episode_id in enumerate(known)}
    hashes = {name: fingerprint(agent, world.sensors) for name, agent in agents.items()}
    selected = [
        row for row in _rows_of(rows, hashes) if row["episode_id"] in known and row["seed"] == seed
    ]
    selected.sort(key=lambda row: spread[row["episode_id"]])
    chosen = choose(selected, list(agents), most)
    if not chosen:
        raise ValueError(
            f"There are no rows of {' and '.join(agents)} with seed {seed} under a corruption for "
            "these episodes. Use the names that the agents have in the rows."
        )
    index = {(r["name"], r["episode_id"], r["corruption"], r["severity"]): r for r in selected}
    for episode_id, corruption in chosen:
        with as_world(world).remembering():
            episode = known[episode_id]
            walks = list(run_agents(agents, world, episode, corruption, seed))
            figure = draw_episode(walks, world, episode, corruption, seed)
            yield {
                **{key: selected[0][key] for key in ("split", "rule", "seed")},
                "episode": episode_id,
                "instruction": episode.instruction.text,
                "heard": instruction(episode, corruption, seed),
                "corruption": corruption.name,
                "title": registry.title(corruption.name),
                "severity": corruption.severity,
                "kind": outcome([walk.won for walk in walks[1:]]),
                "walks": [
                    {**_walk(walk, episode, index), "hash": hashes[walk.agent]} for walk in walks
                ],
                "picture": _png(figure),
            }


def _rows_of(rows: Sequence[Row], hashes: Mapping[str, str]) -> list[Row]:
    """Return the rows of the agents, whose names and hashes are in ``hashes``."""
    for name, agent_hash in hashes.items():
        others = sorted({row["agent"] for row in rows if row["name"] == name})
        if others and agent_hash not in others:
            raise ValueError(
                f"The rows of {name} belong to the agent {', '.join(others)}, but the given "
                f"weights belong to the agent {agent_hash}. Pass the weights and the options "
                "(agent=..., env.views=1) with which the rows were produced."
            )
    return [row for row in rows if hashes.get(row["name"]) == row["agent"]]


def _walk(walk: Walk, episode: Episode, index: Mapping[tuple, Row]) -> dict[str, Any]:
    met = walk.corruption
    row = index.get((walk.agent, episode.episode_id, met.name, met.severity), {})
    shared = [key for key in AGREED if key in row and key in walk.measures]
    same = [abs(walk.measures[key] - row[key]) < CLOSE for key in shared]
    left = float(walk.metres_left)
    return {
        "agent": walk.agent,
        "clean": met.name == "clean",
        "won": walk.won,
        "left": round(left, 1) if np.isfinite(left) else None,
        "steps": walk.measures.get("steps"),
        "agrees": all(same) if same else None,
    }


def _png(figure: Figure) -> str:
    """Return a figure as a data URL that contains a PNG with few colours."""
    from PIL import Image

    drawn, out = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, dpi=DPI, facecolor="white", format="png")
    Image.open(drawn).convert("RGB").quantize(COLOURS).save(out, "PNG", optimize=True)
    return f"data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}"
