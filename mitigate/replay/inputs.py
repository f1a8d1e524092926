"""Open the agents and the drives of a replay, and check that they are compatible."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mitigate.core.build import imported
from mitigate.core.contracts import missing_members
from mitigate.core.names import name_of, short
from mitigate.core.progress import say
from mitigate.guards.guard import NO_GUARDS, Guards

if TYPE_CHECKING:
    from mitigate.replay.replay import ReplayConfig
    from mitigate.worlds.recorded import Recording, Source

CONTRACT = (
    "an agent is an object with reset(instruction) and act(observation) "
    "(docs/bring-your-own.md); mitigate.as_policy makes one of a trained policy"
)


def load_agents(agents: Any) -> dict[str, Any]:
    """Load agents by unique names.

    Args:
        agents: An agent, a folder of weights, or ``module:callable`` for a function that returns
            an agent. Several agents are given as a list, or as a mapping from names to agents.

    Raises:
        FileNotFoundError: If there are no weights at a path.
        ValueError: If two agents have the same name, or an object is not an agent.
    """
    if not isinstance(agents, Mapping):
        listed = list(agents) if isinstance(agents, (list, tuple)) else [agents]
        agents = dict(zip(_unique_names(listed), listed, strict=True))
    return {name: _load(agent) for name, agent in agents.items()}


def _unique_names(agents: Sequence[Any]) -> list[str]:
    if not agents:
        raise ValueError(
            "agents must list at least one folder of weights or module:callable, got []."
        )
    texts = [str(a) if isinstance(a, (str, Path)) else type(a).__name__ for a in agents]
    if len(set(texts)) < len(texts):
        raise ValueError(
            f"agents must be different, got [{','.join(texts)}]. In Python, give names: "
            "agents={'before': ..., 'after': ...}."
        )
    names = [name_of(text) for text in texts]
    return names if len(set(names)) == len(names) else [text.rstrip("/") for text in texts]


def _load(agent: Any) -> Any:
    """Return the agent that is given as an object, a folder of weights, or ``module:callable``."""
    from mitigate.agents.loading import load

    if not isinstance(agent, (str, Path)):
        _check_agent(agent, f"agents contains {short(agent)}")
        return agent
    if ":" in str(agent) and not Path(agent).exists():
        instance = imported(str(agent), "agents")()
        _check_agent(instance, f"agents={agent} returned {short(instance)}")
        return instance
    try:
        return load(agent)
    except FileNotFoundError as error:
        raise FileNotFoundError(
            f"{error} For your own agent, write agents=[module:callable], such as "
            "agents=[my_policy:load]."
        ) from error


def _check_agent(agent: Any, what: str) -> None:
    missing = missing_members(agent, ("reset", "act"))
    if missing or isinstance(agent, type):
        lacking = "is a class, not an object" if isinstance(agent, type) else f"lacks {missing[0]}"
        raise ValueError(f"{what}, which {lacking}: {CONTRACT}.")


def views_of(agent: Any) -> int:
    """Return the number of camera views that an agent reads; the default is 1."""
    from mitigate.agents.agent import as_agent

    return as_agent(agent).views or 1


def open_drives(config: ReplayConfig, paths: Iterable[str | Path]) -> list[Source]:
    """Open every drive at ``paths`` without reading its frames.

    Raises:
        FileNotFoundError: If a drive does not exist.
        ValueError: If a drive is damaged, or two drives have the same name.
    """
    from mitigate.worlds.recorded import open_recording

    sources: list[Source] = []
    for path in paths:
        sources += open_recording(
            path,
            instruction=config.instruction or None,
            topics={k: v for k, v in vars(config.topics).items() if v is not None},
            hfov=config.hfov,
            unit=config.unit,
            yaw=config.yaw,
            cameras=config.cameras,
            episodes=config.episodes,
            tolerance=config.tolerance,
        )
    names = Counter(source.name for source in sources)
    if twice := [name for name, count in names.items() if count > 1]:
        raise ValueError(f"Two drives have the name {twice[0]!r}. Rename one.")
    return sources


def check_drives(
    sources: Sequence[Source], agents: Mapping[str, Any], guards: Guards = NO_GUARDS
) -> None:
    """Check that each drive has an instruction and the frames that the agents and guards need.

    Raises:
        ValueError: If a drive has no instruction, or lacks frames.
    """
    from mitigate.agents.agent import as_agent
    from mitigate.worlds.recorded import kinds

    for source in sources:
        for name, agent in agents.items():
            recorded = kinds(source, views_of(agent))
            if guards:
                guards.check_shown(recorded, source.name)
            for sensor in {"rgb", "depth"} & {*(as_agent(agent).sensors or ())}:
                if sensor not in recorded:
                    raise ValueError(
                        f"{name} reads {sensor}, which {source.name} lacks. Name its topic "
                        f"(topics.{sensor}=), record it, or choose an agent without it, such as "
                        "agents=[checkpoints/recurrent_rgb/base] for RGB only."
                    )
        if not source.instruction:
            raise ValueError(
                f"{source.name} has no instruction. Set instruction='\"walk to the door\"'."
            )


def load_drives(
    config: ReplayConfig, sources: Sequence[Source], views: Iterable[int]
) -> dict[int, list[Recording]]:
    """Load every drive once for each number of views, and print what was read.

    A panorama has 12 views, and a single camera has 1.
    """
    from mitigate.worlds.recorded import Step, load

    step = Step(**vars(config.step))
    recordings: dict[int, list[Recording]] = {count: [] for count in views}
    for source in sources:
        for count, drives in recordings.items():
            drive = load(source, views=count, size=config.size, step=step, crop=config.crop)
            say("\n  ".join(drive.summary))
            drives.append(drive)
    return recordings
