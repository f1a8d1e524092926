"""Tests of ``mitigate.benchmark`` in a user's world, with agents of any class."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import partial
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium import spaces
from torch import nn

import mitigate
from mitigate.agents.adapters import insert_adapters, save_adapters
from mitigate.agents.fingerprint import contents
from mitigate.core.observation import STOP
from mitigate.encoders.plain_adapters import attach
from mitigate.evaluation import report, rows
from mitigate.evaluation.sections import sections
from mitigate.worlds.episodes import Episode, Goal, Instruction, write_episodes
from mitigate.worlds.gym import GymWorld
from mitigate.worlds.seeded import seeded_episodes
from mitigate.worlds.world import World


class Corridor(gymnasium.Env):
    """A world in which an agent succeeds if it takes action 1 once for each cell, and then action
    0."""

    def __init__(self, cells: int = 2) -> None:
        self.cells = cells
        self.observation_space = spaces.Dict({"rgb": spaces.Box(0, 255, (8, 8, 3), np.uint8)})
        self.action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.at = 0
        return self._seen(), {}

    def step(self, action):
        self.at += action
        return self._seen(), 0.0, action == 0, self.at > 5, {"won": self.at == self.cells}

    def _seen(self):
        return {"rgb": np.full((8, 8, 3), 20 * self.at, np.uint8)}


class CorridorWorld(GymWorld):
    def __init__(self, cells: int = 2) -> None:
        super().__init__(Corridor(cells), success="won")


class Holder:
    """An agent with a network attribute, which takes action 1 if its output is above 0."""

    def __init__(self, net: nn.Module) -> None:
        self.nets = {"policy": net}

    def reset(self, instruction: str) -> None:
        self.steps = 0

    @torch.no_grad()
    def act(self, observation) -> int:
        self.steps += 1
        return int(self.nets["policy"](torch.ones(1, 1)).item() > 0 and self.steps < 3)


def weight(value: float) -> nn.Linear:
    net = nn.Linear(1, 1, bias=False)
    nn.init.constant_(net.weight, value)
    return net


class Hidden(Holder):
    """An agent whose weights are in an object that the fingerprint cannot read."""

    def __init__(self, value: float) -> None:
        self.session = iter([value])

    def act(self, observation) -> int:
        return 0


EPISODES = [
    Episode(str(n), "0", "corridor", (0, 0, 0), (0, 0, 0, 1), (Goal((0, 0, 0)),), Instruction("go"),
            ((0, 0, 0), (0, 0, 0)), info={"seed": n})
    for n in range(2)
]  # fmt: skip


@pytest.fixture
def walk(tmp_path, monkeypatch) -> Callable:
    monkeypatch.chdir(tmp_path)

    def walk(agent, world=CorridorWorld, **options):
        options = {"listed": EPISODES, "suite": ["spatter"], "out": "rows"} | options
        return mitigate.benchmark(agent, world=world, **options)

    return walk


def test_benchmark_requires_episodes_of_a_custom_world(walk):
    with pytest.raises(
        ValueError, match=r"cannot run in CorridorWorld. Pass episodes of your world: listed="
    ):
        walk(Holder(weight(1)), listed=None)
    assert walk(Holder(weight(1))).split == "CorridorWorld"
    output = walk(Holder(weight(1)), lambda: GymWorld(Corridor(), success="won"), out="others")
    assert output.split == "Corridor"
    assert walk(Holder(weight(1)), split="mine", out="third").split == "mine"


def test_benchmark_names_what_a_world_or_an_agent_lacks(walk):
    class Bare(World):
        sensors = CorridorWorld().sensors

        def reset(self, episode):
            return {}

    with pytest.raises(ValueError, match="Bare must define step, measures, rule"):
        walk(Holder(weight(1)), Bare)
    agent = Holder(weight(1))
    agent.sensors = ("rbg",)
    with pytest.raises(ValueError, match="There is no sensor 'rbg'. Did you mean rgb"):
        walk(agent)


def test_benchmark_reads_episodes_from_a_file(walk):
    write_episodes("mine.json", EPISODES)
    assert walk(Holder(weight(1)), listed="mine.json").rows == walk(Holder(weight(1))).rows


@pytest.mark.slow
def test_documented_policy_and_environment_work(tmp_path):
    page = (Path(__file__).parents[3] / "docs/leaderboard.md").read_text(encoding="utf-8")
    code = re.search(r"on one screen\n.*?```python\n(.*?)```", page, re.DOTALL)[1]
    (tmp_path / "hall.py").write_text(code)
    for repeated in (False, True):
        done = subprocess.run(
            [sys.executable, "hall.py"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(Path(mitigate.__file__).parents[1])},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        depth = re.search(r"PRS-SR \(Depth\): ([\d.]+)", done.stdout)
        assert "Clean SR: 100.0" in done.stdout and float(depth[1]) < 0.9
        assert ("all already done" in done.stdout) == repeated


def test_benchmark_runs_each_seeded_episode(walk):
    entry = walk(Holder(weight(1)), listed=seeded_episodes(range(3)), suite=["spatter"])
    assert entry.episodes == 3 and entry.rows["count"] == 6


def test_benchmark_rejects_a_world_with_other_arguments(walk):
    assert walk(Holder(weight(1)), partial(CorridorWorld, 2)).SR["clean"][0] == 1
    with pytest.raises(ValueError, match=r"another world: .*argument\.0 was '2' and is '3'"):
        walk(Holder(weight(1)), partial(CorridorWorld, 3))


class Fixed(Corridor):
    """A corridor whose spaces are class attributes."""

    observation_space = spaces.Dict({"rgb": spaces.Box(0, 255, (8, 8, 3), np.uint8)})
    action_space = spaces.Discrete(2)

    def __init__(self) -> None:
        self.cells = 2


def make_fixed() -> GymWorld:
    return GymWorld(Fixed(), success="won")


def test_benchmark_reuses_rows_of_an_environment_with_spaces_of_its_class(
    walk, monkeypatch, capsys
):
    first = walk(Holder(weight(1)), make_fixed)
    assert "cannot be read" not in capsys.readouterr().out
    Fixed.action_space.seed(1)
    assert walk(Holder(weight(1)), make_fixed).rows == first.rows
    assert "all already done" in capsys.readouterr().out
    narrow = spaces.Dict({"rgb": spaces.Box(0, 250, (8, 8, 3), np.uint8)})
    monkeypatch.setattr(Fixed, "observation_space", narrow)
    with pytest.raises(ValueError, match=r"another world: the class attributes of .* were changed"):
        walk(Holder(weight(1)), make_fixed)


def test_benchmark_does_not_reuse_rows_of_other_weights(walk):
    first, second = walk(Holder(weight(1))), walk(Holder(weight(-1)))
    assert (first.SR["clean"][0], second.SR["clean"][0]) == (1, 0)
    assert first.agents != second.agents


def test_benchmark_does_not_reuse_rows_of_unreadable_agents(walk):
    class Told(Hidden):
        settings = {"weights": "the first"}

    walk(Hidden(1))
    with pytest.raises(ValueError, match=r"this Hidden, session \(.*cannot be read. Give version="):
        walk(Hidden(2))
    for _ in range(2):
        walk(Told(1), out="told")


def test_benchmark_reuses_rows_of_a_version_only(walk, capsys):
    first = walk(Hidden(1), version="1")
    capsys.readouterr()
    assert walk(Hidden(1), version="1").agents == first.agents
    assert "all already done" in capsys.readouterr().out
    assert walk(Hidden(2), version="2").agents != first.agents
    with pytest.raises(ValueError, match="version must be a non-empty string, got 2"):
        walk(Hidden(2), version=2)


def test_benchmark_does_not_reuse_rows_after_a_forward_hook(walk, capsys):
    agent = Holder(weight(1))
    walk(agent)
    agent.nets["policy"].register_forward_hook(lambda module, inputs, output: -output)
    hooked = walk(agent)
    assert hooked.SR["clean"][0] == 0
    assert "nets.policy.forward hook 0 (a forward hook" in capsys.readouterr().out
    with pytest.raises(ValueError, match=r"forward hook.*cannot be read. Give version="):
        walk(agent)
    assert walk(agent, version="hooked").SR["clean"][0] == 0


def test_benchmark_does_not_reuse_rows_after_adapters_were_attached(walk, tmp_path):
    class Encoding(Holder):
        def act(self, observation) -> int:
            return int(self.nets["policy"](torch.ones(1, 4, 2, 2)).sum() > 99)  # STOP at once

    def encoder() -> nn.Module:
        torch.manual_seed(0)
        return nn.Sequential(nn.Conv2d(4, 4, 1)).eval()

    model = encoder()
    insert_adapters(model, ["0"])
    save_adapters(model, tmp_path / "adapters")
    agent = Encoding(encoder())
    first = walk(agent)
    attach(agent.nets["policy"], tmp_path / "adapters")
    assert walk(agent).agents != first.agents


def test_benchmark_requires_all_state_to_be_readable(walk):
    for number, beside in enumerate((weight(1), np.zeros(3))):
        first, other = Hidden(1), Hidden(2)
        first.mean = other.mean = beside
        walk(first, out=f"rows{number}")
        with pytest.raises(ValueError, match="session .* cannot be read"):
            walk(other, out=f"rows{number}")


class Counting(Hidden):
    """An agent with an array that changes during an episode."""

    def __init__(self) -> None:
        self.total = np.zeros(3)

    def act(self, observation) -> int:
        self.total += 1
        return 0


def test_fingerprint_ignores_changes_by_episodes(walk):
    hashes = {one["agent"] for _ in range(2) for one in walk(Counting()).agents}
    assert len(hashes) == 1  # both agents were new objects, which had not run an episode
    agent = Counting()
    assert {one["agent"] for _ in range(3) for one in walk(agent).agents} == hashes


class Near(Holder):
    """An agent with settings in plain attributes, which are not weights."""

    def __init__(self, near: float, *others: object) -> None:
        super().__init__(weight(1))
        self.near, self.others = near, [*others, {"names": {"a", "b", "c"}}]


class Mood(Enum):
    CALM = object()  # the repr of these objects differs between processes


def leaky(slope: float) -> nn.Module:
    return nn.Sequential(nn.LeakyReLU(slope))


@pytest.mark.parametrize(
    "other",
    [
        Near(2.0),
        *(Near(1.0, one) for one in ("x", Path("x"), re.compile("a"), range(3), Mood.CALM, Near)),
        *(Near(1.0, np.random.default_rng(seed)) for seed in (0, 1)),
        Near(1.0, leaky(0.1)),
    ],
)
def test_fingerprint_covers_changed_attributes(walk, other, capsys):
    first = walk(Near(1.0))
    assert "another agent" not in capsys.readouterr().out
    assert walk(Near(1.0)).agents == first.agents != walk(other).agents
    assert "with another class, code, weights, attributes" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"a": [1, Path("x")]}, {"a": [1, Path("y")]}),
        (np.zeros(2), np.ones(2)),
        (leaky(0.1), leaky(0.9)),
        (int, float),
    ],
)
def test_fingerprint_covers_nested_attributes(one, other):
    output = [contents(Near(1.0, content)).parts for content in (one, one, other)]
    assert output[0] == output[1] != output[2]


@dataclass(eq=True)
class Counter:
    """An agent that is not hashable and counts its steps."""

    steps: int = 0

    def reset(self, instruction):
        self.now = instruction

    def act(self, observation):
        self.steps += 1
        return STOP


def test_fingerprint_ignores_changes_by_episodes_of_other_worlds(walk, capsys):
    agent = Counter()
    for _ in range(2):
        for guard in ("none", "rules"):
            walk(agent, safeguard=guard)
        walk(agent, lambda: GymWorld(Corridor(), success="won"), out="other")
    assert "another agent" not in capsys.readouterr().out
    agent.steps = -5
    walk(agent)
    assert "another agent" in capsys.readouterr().out


def test_interrupted_benchmark_keeps_the_fingerprint(walk, monkeypatch, capsys):
    agent, listed = Counter(), seeded_episodes(range(3))
    walk(agent, listed=listed)

    def stopped(*arguments):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("mitigate.evaluation.benchmark.FolderLock", stopped)
        with pytest.raises(KeyboardInterrupt):
            walk(agent, listed=listed)
    walk(agent, listed=listed)
    assert "another agent" not in capsys.readouterr().out


def test_benchmark_accepts_a_restorer_and_a_safeguard(walk):
    alone, behind = walk(Holder(weight(1))), walk(Holder(weight(1)), safeguard="classifier")
    assert behind.name == "Holder+classifier" and behind.agents != alone.agents
    restored = walk(Holder(weight(1)), restore="checkpoints/restorer:rgb")
    assert restored.name == "Holder+restorer-rgb" and len(restored.agents) == 1
    filtered = walk(Holder(weight(1)), restore="tests.guards.filters:median")
    assert filtered.name == "Holder+filters.median" and filtered.agents != restored.agents


@pytest.mark.parametrize("option", ["severity=0.3", "restore=x", "suite=quick", "workers=2"])
def test_benchmark_rejects_other_options(walk, option):
    with pytest.raises(ValueError, match=f"{option} has no effect here"):
        walk(Holder(weight(1)), options=[option])


def test_benchmark_reports_episodes_that_a_limit_cut(walk, capsys):
    walk(Holder(weight(1)), lambda: GymWorld(Corridor(), success="won", limit=1))
    assert "Holder: 4 of 4 episodes were cut by limit=1" in capsys.readouterr().out
    records = rows.read(Path("rows/rows.jsonl"))
    assert {(row["cut"], row["limit"], row["success"]) for row in records} == {(1, 1, 0)}
    assert "Holder: 4 of 4 episodes were cut by limit=1" in report.markdown(sections(records))
    walk(Holder(weight(1)), lambda: GymWorld(Corridor(), success="won", limit=9), out="whole")
    assert "were cut" not in capsys.readouterr().out


def test_episodes_may_be_some_of_those_listed(walk):
    listed = seeded_episodes(range(9))
    counts = {n: walk(Holder(weight(1)), listed=listed, episodes=n).episodes for n in (4, None)}
    assert counts == {4: 4, None: 9}
    with pytest.raises(
        ValueError, match=r"listed must contain only Episode objects, got 7.*seeded_episodes"
    ):
        walk(Holder(weight(1)), listed=[7])


def test_benchmark_rejects_a_bare_gymnasium_environment(walk):
    with pytest.raises(ValueError, match=r"Corridor is not a world: .*GymWorld\(Corridor\(...\)"):
        walk(Holder(weight(1)), Corridor)


class Moody(nn.Module):
    """A layer that returns 0 in eval mode and 1 in train mode, and records statistics of its
    inputs."""

    def __init__(self) -> None:
        super().__init__()
        self.norm = nn.BatchNorm1d(1)

    def forward(self, x):
        return self.norm(x) * 0 + float(self.training)


def test_benchmark_restores_the_mode_of_networks(walk):
    net = Moody()
    net.norm.eval()
    before = {name: value.clone() for name, value in net.state_dict().items()}
    walk(Holder(net))
    assert {row["steps"] for row in rows.read(Path("rows/rows.jsonl"))} == {1}
    assert net.training and not net.norm.training
    assert all(torch.equal(value, before[name]) for name, value in net.state_dict().items())


ENV = f"""
name: corridor
world: {{_target_: {__name__}.CorridorWorld, _partial_: true}}
split: CorridorWorld
episodes: {{CorridorWorld: nowhere.json}}
"""


def test_entry_holds_the_sensors_of_a_custom_world(walk):
    assert walk(Holder(weight(1))).sensors == ("rgb: 8 x 8 x 3 uint8",)


def make_corridor() -> CorridorWorld:
    return CorridorWorld()


def test_world_function_of_a_config_uses_its_episodes(walk):
    Path("mine/env").mkdir(parents=True)
    write_episodes("val.json", EPISODES)
    output = ENV.replace(".CorridorWorld", ".make_corridor").replace("nowhere.json", "val.json")
    Path("mine/env/made.yaml").write_text(output)
    options = ["--config-dir=mine", "env=made"]
    for world in (None, CorridorWorld):
        assert walk(Holder(weight(1)), world, listed=None, options=options, out=f"of{world}")
    with pytest.raises(ValueError, match="cannot run in Corridor. Pass episodes of your world"):
        walk(
            Holder(weight(1)),
            lambda: GymWorld(Corridor(), success="won"),
            listed=None,
            options=options,
        )
