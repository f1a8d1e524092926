"""Tests that the page contains the results of all rows, and a limited number of episodes."""

from __future__ import annotations

import base64
import json
import re
import time

import numpy as np
import pytest

from mitigate.agents.fingerprint import fingerprint
from mitigate.corruptions import Corruption
from mitigate.evaluation import table
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.page import command, document
from mitigate.evaluation.page.document import report
from mitigate.evaluation.page.model import curve_figures, shortened
from mitigate.evaluation.page.walks import KINDS, choose, walk_again
from mitigate.evaluation.rows import write
from mitigate.evaluation.sections import sections
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode
from tests.evaluation.made_rows import cell, column, row
from tests.evaluation.straight import Straight


def page_data(text: str) -> tuple[dict, np.ndarray]:
    """Return the JSON data of a page, and the packed data of its episodes as one flat array."""
    data = re.search(r'id="data">(.*?)</script>', text, re.S)
    packed = re.search(r'id="packed">(.*?)</script>', text, re.S)
    assert data and packed
    return json.loads(data[1]), np.frombuffer(base64.b64decode(packed[1]), "<u2")


@pytest.fixture(scope="module")
def rows() -> list[dict]:
    base = column(8, {"spatter": 2, "missing_data": 7}, steps=41)
    return base + column(6, {"spatter": 6, "missing_data": 5}, name="hard", agent="ba9876543210")


def test_intervals_of_cells_resample_scenes():
    """Two episodes per scene have equal results, so intervals over episodes would be narrower."""
    output = []
    for name, agent, wins in (("base", "0" * 12, 8), ("hard", "1" * 12, 5)):
        for k in range(24):
            for met in ({}, {"corruption": "spatter", "severity": 0.6}):
                ids = {"episode_id": f"{k // 2}-vln2-{k}", "scene": f"{k // 2}"}
                output.append(row(k, k // 2 % 9 < wins, name=name, agent=agent) | met | ids)
    (part,) = sections(output)
    (displayed,) = page_data(report(output))[0]["sections"]
    assert "12 scenes" in dict(displayed["facts"])["Intervals"]
    change, clean = part.compare("hard", "base").clean, part.clean["hard", "SR"]
    pair, value = displayed["pairs"]["1-0"]["measures"][0], displayed["cells"][1][0][0]
    assert pair[1:3] == [shortened(change.low), shortened(change.high)]
    assert value[1:3] == [shortened(clean.low), shortened(clean.high)]


def test_values_and_differences_are_those_of_the_table(rows):
    (part,) = sections(rows)
    data, _ = page_data(report(rows))
    (displayed,) = data["sections"]
    titles = [measure["title"] for measure in displayed["measures"]]
    clean = part.clean["hard", "SR"]
    got = displayed["values"][1][titles.index("Clean SR")]
    assert got[:3] == pytest.approx([clean.value, clean.low, clean.high], abs=1e-4)
    difference = part.differences["hard"]
    moved, raised = difference.clean, difference.corrupted.estimate
    pair = displayed["pairs"]["1-0"]["measures"]
    assert pair[titles.index("Clean SR")] == pytest.approx(
        [moved.value, moved.low, moved.high], abs=1e-4
    )
    mean = pair[titles.index("Mean SR, 12 corruptions")]
    assert mean[:3] == pytest.approx([raised.value, raised.low, raised.high], abs=1e-4)
    assert mean[3] == "† 2/12"
    assert [line["label"] for line in displayed["columns"]] == ["base", "hard"]


def test_interval_without_width_adds_a_note():
    varied = column(8, {"spatter": 2})
    alike = [row(0, 1), row(0, 1, corruption="spatter", severity=0.6)]
    for displayed, reported in ((varied, False), (alike, True)):
        (part,) = page_data(report(displayed))[0]["sections"]
        assert any(note.startswith("[–]") for note in part["notes"]) == reported


def test_agents_without_a_common_seed_have_no_difference(rows):
    apart = column(6, {"spatter": 6}, name="apart", agent="cccccccccccc", seed=7)
    (displayed,) = page_data(report(rows + apart))[0]["sections"]
    assert (
        displayed["pairs"]["1-0"]
        and displayed["pairs"]["2-0"] is None
        and displayed["baselines"] == 3
    )
    assert any("without a seed in common" in note for note in displayed["notes"])
    (alone,) = page_data(report([r for r in rows + apart if r["name"] != "hard"]))[0]["sections"]
    assert alone["baselines"] == 0 and [*alone["pairs"].values()] == [None]


def test_packed_episodes_match_the_rows(rows):
    data, packed = page_data(report(rows))
    (grid,) = data["grids"]
    begin = grid["cells"]["0|spatter|0.6|0"]
    success, spl, steps = packed[3 * begin : 3 * (begin + 10)].reshape(3, 10)
    assert grid["episodes"] == [str(n) for n in range(10)]
    assert success.tolist() == [1000, 1000] + [0] * 8 and spl.tolist() == [500, 500] + [0] * 8
    assert set(steps) == {41}


def test_packed_episodes_keep_gaps(rows):
    fewer = [r for r in rows if (r["episode_id"], r["corruption"]) != ("3", "spatter")]
    data, packed = page_data(report(fewer))
    begin = data["grids"][0]["cells"]["0|spatter|0.6|0"]
    assert packed[3 * begin + 3] == 65535
    assert data["sections"][0]["cells"][0][1][2] == 9
    assert any("part of the episodes" in note for note in data["sections"][0]["notes"])


def test_page_is_bounded_and_reports_omissions(rows):
    data, packed = page_data(report(rows, most=25))
    assert len(packed) == 3 * 20 and len(data["grids"][0]["cells"]) == 2
    assert "4 cells are not in this file" in data["notes"][0]


def test_cell_is_packed_with_all_seeds_or_none(rows):
    two = [r | {"seed": seed} for seed in (0, 1) for r in rows if r["name"] == "base"]
    data, _ = page_data(report(two, most=50))
    started = sorted(data["grids"][0]["cells"])
    assert started == [f"0|{at}|{seed}" for at in ("clean|0.0", "spatter|0.6") for seed in (0, 1)]
    assert "episodes of 1 cell are not" in data["notes"][0]


def test_page_share_uses_common_episodes(rows):
    """The displayed share is the fraction of clean success that is retained, like a PRS. It uses
    only episodes that were run both clean and corrupted."""
    sure = column(10, {"spatter": 10}, name="sure", agent="cccccccccccc", spl=0.4)
    lost = [r | {"success": 0, "spl": 0.1} if r["episode_id"] == "9" else r for r in sure]
    fewer = [r for r in lost if (r["episode_id"], r["corruption"]) != ("9", "spatter")]
    (displayed,) = page_data(report(rows + fewer))[0]["sections"]
    place = [one["name"] for one in displayed["corruptions"]].index("spatter")
    assert displayed["cells"][2][place][3:] == [1.0, 1.0]
    assert displayed["cells"][0][place][3:] == [0.25, 0.25] and displayed["cells"][0][0][3:] == [
        1.0,
        1.0,
    ]
    least = [r for r in fewer if r["corruption"] == "clean" or r["episode_id"] < "5"]
    (displayed,) = page_data(report(rows + least))[0]["sections"]
    assert displayed["cells"][2][place][3:] == [None, None]  # too few episodes for a PRS


@pytest.mark.parametrize("x", [0.3125, 0.31250000001, 0.0049999999, 0.125, 1 / 3, 0.0, 37 / 900])
def test_shortened_keeps_the_displayed_text(x):
    short = shortened(x)
    assert f"{short:.2f} {100 * short:.1f}" == f"{x:.2f} {100 * x:.1f}"
    assert len(repr(short)) <= 8 or short == x


def test_page_separates_seeds_and_kinds(rows):
    more = rows + column(5, {"spatter": 4, "haze": 3}, seed=1, agent="aaaaaaaaaaaa")
    data, _ = page_data(report(more))
    seeds = {key.rpartition("|")[2] for grid in data["grids"] for key in grid["cells"]}
    assert seeds >= {"0", "1"} and len(data["sections"]) == 2


def test_curve_points_share_episodes():
    rows = cell(10) + cell(6, corruption="spatter", severity=0.4)
    rows += cell(0, 4, corruption="spatter", severity=0.8)
    ((figure,), (panel,)) = (matches := curve_figures(sections(rows))), matches[0]["panels"]
    (line,) = panel["lines"]
    assert figure["columns"] == ["base"] and line["count"] == 4
    assert [point[:2] for point in line["points"]] == [[0.0, 1.0], [0.4, 1.0], [0.8, 0.0]]


def test_page_needs_two_severities_for_a_curve(rows):
    assert curve_figures(sections(rows)) == []


def test_page_escapes_texts_and_names_no_address(rows):
    evil = "</script><script>alert(1)</script><!-- <script>"
    named = [r | {"name": evil, "episode_id": f"{evil}{r['episode_id']}"} for r in rows[:30]]
    text = report(named, title=evil)
    assert len(re.findall(r"<script", text)) == 3 and len(re.findall(r"</script", text)) == 3
    assert "<!--" not in text and page_data(text)[0]["sections"][0]["columns"][0]["label"] == evil
    addresses = set(re.findall(r"https?://[^\"'\s)]+", text))
    # the only address is the XML namespace, which no browser loads
    assert addresses == {"http://www.w3.org/2000/svg"}


def test_choose_alternates_outcomes_and_corruptions():
    first = {"spatter": "0011", "flare": "0011"}
    last = {"spatter": "0101", "flare": "0101"}
    output = [
        row(episode, won == "1", name=name, corruption=met, severity=0.6)
        for name, cells in (("base", first), ("hard", last))
        for met, wins in cells.items()
        for episode, won in zip("abcd", wins, strict=True)
    ]
    chosen = choose(output, ["base", "hard"], 9)
    # episodes are sorted by their outcome, in the order of KINDS
    assert [episode for episode, _ in chosen] == ["b", "a", "d", "c"]
    assert {met.name for _, met in chosen} == {"spatter", "flare"} and len(KINDS) == 4
    assert choose(output, ["base", "hard"], 2) == chosen[:2]


def walked_rows(agents: dict, world: ApartmentsWorld, episode: Episode) -> list[dict]:
    """Return clean and low-light rows of the agents with these hashes."""
    output = []
    for name, agent in agents.items():
        for met in (Corruption("clean", 0.0), Corruption("low_light", 0.6)):
            measures = run_episode(agent, world, episode, met, 0)
            at = {"corruption": met.name, "severity": met.severity, "name": name}
            at["agent"] = fingerprint(agent, world.sensors)
            output.append(row(episode.episode_id, 0, **at) | measures)
    return output


def test_walk_again_compares_with_the_row():
    world, (episode,) = ApartmentsWorld(16), load_episodes("val_seen")[:1]
    agents = {"base": Straight(1), "hard": Straight(3)}
    records = walked_rows(agents, world, episode)
    records[-1]["steps"] += 1  # this row now differs from the result of the new run
    (drawn,) = walk_again(agents, world, [episode], records, most=3, seed=0)
    assert [walk["agrees"] for walk in drawn["walks"]] == [True, True, False]
    assert drawn["picture"].startswith("data:image/png;base64,")
    assert drawn["kind"] == "lost by both" and drawn["title"] == "L-L w/o noise"


def test_walk_again_ignores_rows_of_other_agents():
    world, (episode,) = ApartmentsWorld(16), load_episodes("val_seen")[:1]
    agents = {"base": Straight(1)}
    records = walked_rows(agents, world, episode)
    others = [r | {"agent": "ba9876543210", "steps": r["steps"] + 1} for r in records]
    (drawn,) = walk_again(agents, world, [episode], records + others, most=3, seed=0)
    assert [walk["agrees"] for walk in drawn["walks"]] == [True, True]
    assert {walk["hash"] for walk in drawn["walks"]} == {records[0]["agent"]}
    with pytest.raises(
        ValueError, match=r"rows of base belong to the agent ba9876543210, but the given weights"
    ):
        next(walk_again(agents, world, [episode], others, most=3, seed=0))


def test_walk_again_names_the_outcome_of_one_agent():
    world, (episode,) = ApartmentsWorld(16), load_episodes("val_seen")[:1]
    agents = {"base": Straight(1)}
    (drawn,) = walk_again(
        agents, world, [episode], walked_rows(agents, world, episode), most=1, seed=0
    )
    assert drawn["kind"] == "lost"
    assert [drawn[key] for key in ("split", "seed", "severity")] == ["val_unseen", 0, 0.6]


def test_report_command_writes_one_file(tmp_path, capsys, rows):
    write(tmp_path / "rows.jsonl", rows)
    out = tmp_path / "page.html"
    assert command.main([str(tmp_path / "rows.jsonl"), "--out", str(out)]) == 0
    assert page_data(out.read_text(encoding="utf-8"))[0]["title"] == "Results"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["page.html", "rows.jsonl"]
    assert command.main([str(tmp_path / "nowhere")]) == 2
    assert "nowhere" in capsys.readouterr().err
    walk = ["--walk", "bass=checkpoints/base", "split=val_unseen"]
    assert command.main([str(tmp_path / "rows.jsonl"), *walk]) == 2
    assert "Did you mean base?" in capsys.readouterr().err


def test_report_command_accepts_a_config_folder(tmp_path, monkeypatch, rows):
    write(tmp_path / "rows.jsonl", rows)
    requests = []
    monkeypatch.setattr(command, "_walks", lambda *arguments: requests.append(arguments[-1]) or [])
    words = ["--walk", "base=x", "--config-dir", "mine", "env=own", "--out", f"{tmp_path}/p.html"]
    assert command.main([str(tmp_path / "rows.jsonl"), *words]) == 0
    assert requests == [["--config-dir=mine", "env=own"]]


def test_report_command_rejects_invalid_outputs(tmp_path, capsys, rows):
    file = tmp_path / "rows.jsonl"
    write(file, rows)
    before = file.read_bytes()
    (tmp_path / "folder.html").mkdir()
    for out in (file, tmp_path / "folder.html", tmp_path, "", tmp_path / "report"):
        assert command.main([str(file), "--out", str(out)]) == 2
        assert "must end in .html" in capsys.readouterr().err
    for out in (file / "report.html", tmp_path / f"{'x' * 300}.html"):
        assert command.main([str(file), "--out", str(out)]) == 2
        assert capsys.readouterr().err.startswith("report: ")
    assert table.main([str(file), "--out", str(file)]) == 2
    assert "File exists" in capsys.readouterr().err
    assert file.read_bytes() == before and len([*tmp_path.iterdir()]) == 2


def test_report_command_accepts_a_path_with_equals_sign(tmp_path, capsys):
    out = str(tmp_path / "out.html")
    assert command.main(["runs/severity=0.3/rows.jsonl", "--out", out]) == 2
    assert "no file or folder runs/severity=0.3/rows.jsonl" in capsys.readouterr().err
    assert not (tmp_path / "out.html").exists()


def test_page_separates_lists_of_a_split(rows):
    other = [r | {"episode_id": f"{r['episode_id']}-b", "agent": "ccccccccccc"} for r in rows[:30]]
    data, _ = page_data(report(rows + other))
    assert [part["title"] for part in data["sections"]] == [
        f"val_unseen from {begins}, severity 0.6, suite 1.0" for begins in ("0", "0-b")
    ]
    assert [len(grid["episodes"]) for grid in data["grids"]] == [10, 10]
    assert [line["label"] for line in data["sections"][0]["columns"]] == ["base", "hard"]


@pytest.mark.slow
def test_report_rejects_rows_that_no_browser_can_show(monkeypatch, tmp_path):
    """Issue T2, item 9."""
    many = column(8, {f"made_up_{n}": 2 for n in range(3000)})
    more = column(8, {f"made_up_{n}": 3 for n in range(3000)}, name="b", agent="b")
    began = time.monotonic()
    with pytest.raises(ValueError, match="The page would hold .* numbers, more than 50,000"):
        report(many + [{**r, "name": f"n{i}"} for i in range(6) for r in more])
    assert time.monotonic() - began < 60
    agents = [row(0, 1.0, name=f"n{i}", agent=f"a{i}") for i in range(3000)]
    with pytest.raises(ValueError, match="The page would hold .* numbers, more than 50,000"):
        report(agents)
    monkeypatch.setattr(document, "LARGEST_PAGE", 1000)
    with pytest.raises(ValueError, match="more than 1,000, which a browser cannot show"):
        report(column(8, {"spatter": 2}))
