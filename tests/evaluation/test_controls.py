"""Tests of the oracle and the random agent, which give upper and lower bounds for all results."""

from __future__ import annotations

import shutil

import pytest

from mitigate.core import conf
from mitigate.core.files import find
from mitigate.corruptions import CLEAN
from mitigate.evaluation import controls, rows
from mitigate.evaluation.control_agents import OracleAgent, RandomAgent
from mitigate.evaluation.episode import run_episode
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import write_episodes

SIZE = 16


def at_random(world, episode):
    agent = RandomAgent()
    agent.episode = episode.episode_id
    return run_episode(agent, world, episode, CLEAN, 0)


def test_random_agent_is_deterministic_and_rarely_succeeds():
    world, episodes = ApartmentsWorld(SIZE), load_episodes("val_unseen")[::30]
    rows = [at_random(world, e) for e in episodes]
    assert rows == [at_random(world, e) for e in episodes]
    oracle = [run_episode(OracleAgent(world), world, e, CLEAN, 0) for e in episodes]
    assert sum(r["success"] for r in rows) <= 3 < 10 == sum(r["success"] for r in oracle)


def test_random_agent_differs_between_episodes_of_one_text(monkeypatch, tmp_path):
    episodes = load_episodes("val_seen", "ogn")
    text = max(episodes, key=lambda e: sum(e.instruction == o.instruction for o in episodes))
    same = [e for e in episodes if e.instruction == text.instruction][:4]
    write_episodes(tmp_path / "same.json", same)
    arguments = [
        f"+env.episodes.same={tmp_path / 'same.json'}",
        "split=same",
        f"out={tmp_path / 'o'}",
    ]
    assert called(monkeypatch, *arguments) == 0
    records = [r for r in rows.read(tmp_path / "o" / "rows.jsonl") if r["name"] == "random"]
    assert len(records) == 4 == len({(r["steps"], r["path_length"]) for r in records})


@pytest.fixture
def walked(monkeypatch):
    """Return a list that collects the id of each episode that is run; every episode succeeds."""
    ids: list[str] = []

    def walk(agent, world, episode, *others):
        ids.append(episode.episode_id)
        return {"success": 1, "spl": 1.0}

    monkeypatch.setattr("mitigate.evaluation.evaluator.run_episode", walk)
    return ids


def called(monkeypatch, *arguments):
    monkeypatch.setattr("sys.argv", ["controls", *arguments])
    return controls.main()


def test_controls_run_only_missing_episodes(monkeypatch, tmp_path, walked, capsys):
    arguments = ["split=val_seen_ogn", f"out={tmp_path}"]
    assert called(monkeypatch, *arguments, "episodes=1") == 0
    assert called(monkeypatch, *arguments, "episodes=2") == 0
    assert len(walked) == 4 and len(set(walked)) == 2
    records = rows.read(tmp_path / "rows.jsonl")
    assert len(records) == 4 and {row["split"] for row in records} == {"val_seen_ogn"}
    assert "oracle: SR 100.0 [34.2, 100.0] %, SPL 1.00, 2 episodes" in capsys.readouterr().out


def test_controls_warn_of_conflicts_and_report_lost_rows(monkeypatch, tmp_path, walked, capsys):
    arguments = ["split=val_seen_ogn", f"out={tmp_path}", "episodes=1"]
    file = tmp_path / "rows.jsonl"
    assert called(monkeypatch, *arguments) == 0
    rows.append(file, [rows.read(file)[0] | {"success": 0, "spl": 0.0}])
    with pytest.warns(UserWarning, match="1 rows have another success"):
        assert called(monkeypatch, *arguments) == 0

    def walk(*_):
        file.unlink(missing_ok=True)
        return {"success": 1, "spl": 1.0}

    monkeypatch.setattr("mitigate.evaluation.evaluator.run_episode", walk)
    monkeypatch.setattr(rows, "append", lambda *_: None)
    assert called(monkeypatch, *arguments[:2], "episodes=2") == 2
    assert "another program removed or replaced the file" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("episodes=0", "episodes must be a whole number >= 1, or null for the whole list, got 0"),
        ("split=val_sen", "Did you mean val_seen?"),
        ("env=corridor", "There is no env 'corridor'"),
        ("--split", "Write split=VALUE"),
        ("severity=0.9", "severity=0.9 has no effect"),
        ("agent=recurrent", "agent=recurrent has no effect"),
    ],
)
def test_controls_reject_invalid_options(monkeypatch, tmp_path, capsys, option, words):
    assert called(monkeypatch, option, f"out={tmp_path}") == 2
    assert words in capsys.readouterr().err and not list(tmp_path.iterdir())


@pytest.mark.parametrize("folder", [["--config-dir", "mine"], ["--config-dir=mine"]])
def test_controls_accept_a_config_folder(monkeypatch, tmp_path, walked, capsys, folder):
    monkeypatch.chdir(tmp_path)
    usual = find("conf/env/apartments.yaml").read_text()
    (tmp_path / "mine/env").mkdir(parents=True)
    (tmp_path / "mine/env/own.yaml").write_text(usual)
    assert called(monkeypatch, *folder, "env=own", "split=val_seen", "episodes=1", "out=rows") == 0
    assert len(walked) == 2


def test_controls_reject_rows_of_another_list(monkeypatch, tmp_path, walked, capsys):
    for name, split in (("a", "val_seen"), ("b", "val_unseen")):
        source = conf.load_config("evaluate").env.episodes[split]
        shutil.copy(find(source), tmp_path / f"{name}.json.gz")
    arguments = ["split=mine", "episodes=1", f"out={tmp_path}/out"]
    assert called(monkeypatch, f"+env.episodes.mine={tmp_path}/a.json.gz", *arguments) == 0
    assert called(monkeypatch, f"+env.episodes.mine={tmp_path}/b.json.gz", *arguments) == 2
    assert "holds rows of another list of mine" in capsys.readouterr().err and len(walked) == 2
