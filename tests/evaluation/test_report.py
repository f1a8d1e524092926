"""Tests that the table computes the paper's numbers from known rows, and marks missing values."""

from __future__ import annotations

import json
import re
import time

import cv2
import numpy as np
import pytest

from mitigate.core.markdown import markdown_of
from mitigate.corruptions import DEPTH, INSTRUCTION, NAMES, RGB
from mitigate.corruptions.registry import fault_names, unseen_names
from mitigate.evaluation import report, rows, table
from mitigate.evaluation.report import markdown, sections, write
from mitigate.evaluation.sections import Difference
from tests.evaluation.made_rows import cell, column, row

ALL = dict.fromkeys(NAMES, 4)
HARD = {"agent": "ffff00000000", "name": "da_per_episode"}


def lines(output) -> dict[str, list[str]]:
    """Return a dict from the first cell of each table line to its other cells. If two lines have
    the same first cell, the first line is used."""
    text = markdown(sections(output))
    table_lines = [line for line in text.splitlines() if line.startswith("| ")]
    matches: dict[str, list[str]] = {}
    for line in table_lines:
        first, *rest = (part.strip() for part in line.strip("|").split("|"))
        matches.setdefault(first, rest)
    return matches


def test_table_has_the_rows_of_the_paper():
    records = column(8, ALL | {"flare": 8}) + column(5, ALL, **HARD)
    matches = lines(records)
    assert matches["Corruption"] == ["base", "da_per_episode"]
    assert [x.split(" [")[0] for x in matches["Clean SR"]] == ["80.0", "50.0"]
    assert [x.split(" [")[0] for x in matches["Clean SPL"]] == ["0.40", "0.25"]
    assert [x.split(" [")[0] for x in matches["**PRS-SR (RGB)**"]] == ["**0.56**", "**0.80**"]
    assert [x.split(" [")[0] for x in matches["**PRS-SR (Depth)**"]] == ["**0.50**", "**0.80**"]
    assert matches["Flare"] == ["80.0", "40.0"]
    assert matches["L-L w/ noise"] == ["40.0", "40.0"]
    names = list(matches)
    assert names.index("Motion blur") < names.index("**PRS-SR (Depth)**") < names.index("Multipath")
    assert (
        len([n for n in names if "PRS" not in n]) == 1 + 1 + 3 + 2 + 12
    )  # lines of the header, the separator, clean results, the means and the suite


def test_heading_states_the_conditions():
    text = markdown(sections(column(8, ALL)))
    for message in ("val_unseen", "severity 0.6", "N = 10 episodes", "seed 0", "suite 1.0"):
        assert message in text
    assert "vln: STOP and geodesic < 2.0 m" in text
    assert "`0123456789ab`" in text
    assert "N = 1 episode, seed 0" in markdown(sections(column(8, ALL)[:1]))


@pytest.mark.parametrize("says", [True, False])
def test_intervals_may_be_of_scenes(says):
    """The rows belong to two scenes with five episodes each; a row names its scene, or the episode
    id contains it."""

    def placed(output: dict) -> dict:
        scene, number = divmod(int(output["episode_id"]), 5)
        return output | (
            {"scene": f"{scene}"} if says else {"episode_id": f"{scene}-vln2-{number}"}
        )

    output = [placed(row) for row in column(5, ALL)]
    assert {rows.scene_of(row) for row in output} == {"0", "1"}
    text, plain = markdown(sections(output, drawn="scene")), markdown(sections(output))
    # two scenes are too few for the default
    assert "bootstrap over 2 scenes with their episodes" in text and "over episodes" in plain
    assert "| 50.0 [0.0, 100.0] |" in text and "| 50.0 [20.0, 80.0] |" in plain


def test_intervals_are_of_scenes_if_there_are_ten():
    output = [row | {"scene": row["episode_id"][-1]} for row in column(5, ALL)]
    several = [row | {"episode_id": f"1{row['episode_id']}"} for row in output]
    text = markdown(sections(output + several))
    assert "bootstrap over 10 scenes with their episodes" in text
    assert "bootstrap over episodes" in markdown(sections(output + several, drawn="episode"))
    assert "bootstrap over episodes" in markdown(sections(column(5, ALL)))  # unknown scenes


def test_scene_bootstrap_requires_scenes_in_rows():
    with pytest.raises(ValueError, match="do not name the scene of episode '0'"):
        sections(column(8, ALL), drawn="scene")


def test_prs_differences_are_paired_and_against_base():
    records = column(5, ALL, **HARD) + column(8, ALL)
    (section,) = sections(records)
    assert (section.reference, section.columns[0]) == ("base", "base")
    change = section.differences["da_per_episode"].retained["RGB", "SR"].estimate
    assert change.value == pytest.approx(4 / 5 - 4 / 8)
    same = column(8, ALL) + column(8, ALL, **HARD)
    (section,) = sections(same)
    nothing = section.differences["da_per_episode"].retained["Depth", "SPL"].estimate
    assert (nothing.low, nothing.high) == (0.0, 0.0)


def test_interval_needs_two_episodes():
    def one(wins, **agent):
        return [row(0, wins, **agent), row(0, 1, **agent, corruption="spatter", severity=0.6)]

    text = markdown(sections(one(1) + one(0, **HARD)))
    matches = lines(one(1) + one(0, **HARD))
    assert matches["Clean SR against base"] == ["–", "-100.0 [–]"]
    assert matches["**PRS-SR (RGB)**"][0].startswith("**1.00** [–]")
    assert text.count("[–]: no interval") == 1
    assert "[–]" not in markdown(sections(column(8, ALL)))


def test_difference_of_few_episodes_is_uncertain():
    def output(count):
        better = [row(e, 1, **HARD) for e in range(count)]
        return [row(e, 0 if e else 1) for e in range(count)] + better

    few, enough = (markdown(sections(output(count))) for count in (9, 10))
    assert "With fewer than 10 episodes an interval says little" in few and "| **+" not in few
    assert "Differences in bold" in enough and "| **+90.0**" in enough


def test_clean_differences_are_paired_and_against_base():
    matches = lines(column(8, ALL) + column(5, ALL, **HARD))
    first, second = matches["Clean SR against base"]
    assert first == "–" and second.strip("*").startswith("-30.0")
    (section,) = sections(column(8, ALL) + column(8, ALL, **HARD))
    same = section.differences["da_per_episode"].clean
    assert (same.low, same.high) == (0, 0)


def test_mean_sr_covers_all_blocks():
    """Unlike PRS, the mean SR is not divided by the clean SR of the agent."""
    matches = lines(column(8, ALL) + column(5, dict.fromkeys(NAMES, 6), **HARD))
    assert [cell.split(" ")[0] for cell in matches["Mean SR of 12 corruptions"]] == ["40.0", "60.0"]
    assert matches["Mean SR against base"][1].strip("*").startswith("+20.0")
    part = lines(column(8, dict.fromkeys(RGB[:3], 4)))
    assert part["Mean SR of 8 corruptions"][0].endswith("† 3/8")


def test_partial_table_lists_its_gaps():
    whole = column(8, dict.fromkeys(RGB, 4))
    cut = [r for r in whole if r["corruption"] != "flare"]
    cut = [r for r in cut if r["corruption"] != "spatter" or int(r["episode_id"]) < 3]
    matches, text = lines(cut), markdown(sections(cut))
    assert "Flare" not in matches and "Not measured: Flare." in text
    assert matches["Spatter"] == ["100.0\\*"]
    assert matches["**PRS-SR (RGB)**"][0].endswith("† 6/8")
    assert "- base, spatter at 0.6: 3 of 10 episodes" in text
    assert "Depth" not in text


def test_unfinished_episode_is_left_out():
    """If an evaluation was interrupted, some conditions of its last episode may be missing."""
    records = column(8, ALL)
    cut = [r for r in records if r["episode_id"] != "9" or r["corruption"] in ("clean", "flare")]
    (section,) = sections(cut)
    matches = section.retained["base", "RGB", "SR"]
    assert (matches.corruptions, matches.episodes) == (RGB, 9)
    assert matches.estimate.value == pytest.approx(0.5)
    assert lines(cut)["**PRS-SR (RGB)**"][0].endswith("\\*")


def test_columns_are_compared_on_common_episodes():
    few = [r for r in column(8, ALL, **HARD) if int(r["episode_id"]) < 5]
    (section,) = sections(column(8, ALL) + few)
    gained = section.differences["da_per_episode"].retained["RGB", "SR"]
    assert (gained.episodes, gained.estimate.value) == (5, 0.0)
    assert section.retained["base", "RGB", "SR"].episodes == 10


def test_prs_near_the_floor_is_marked():
    records = column(1, dict.fromkeys(NAMES, 1), **HARD) + column(0, dict.fromkeys(NAMES, 0))
    matches = lines(records)
    # a clean SR of 0.10 is not below the performance floor
    assert matches["**PRS-SR (RGB)**"][1].endswith("]")
    assert "‡" in matches["**PRS-SR (RGB)**"][0]
    assert matches["**PRS-SR (RGB)**"][0].startswith("undefined")
    assert "performance floor" in markdown(sections(records))


@pytest.mark.parametrize("key", ["split", "suite", "rule"])
def test_results_under_other_rules_are_not_mixed(key):
    other = column(2, ALL, **{key: "another"})
    first, second = sections(column(8, ALL) + other)
    assert {first.value("base", "clean"), second.value("base", "clean")} == {0.8, 0.2}


def test_each_severity_has_a_table():
    records = column(8, ALL, 0.3) + column(8, dict.fromkeys(NAMES, 2), 0.9)
    mild, strong = sections(records)
    assert (mild.severity, strong.severity) == (0.3, 0.9)
    assert mild.retained["base", "RGB", "SR"].estimate.value == pytest.approx(0.5)
    assert strong.retained["base", "RGB", "SR"].estimate.value == pytest.approx(0.25)


def test_agents_of_one_name_are_distinguished():
    records = column(8, ALL) + column(4, ALL, agent="ba9876543210")
    assert lines(records)["Corruption"] == ["base (012345)", "base (ba9876)"]


def test_agents_with_distinct_seeds_share_a_column():
    """The agents differ only in the seed of their recipe, so they form one column."""
    records = column(8, ALL) + column(4, ALL, agent="ba9876543210", seed=1)
    (section,) = sections(records)
    assert section.columns == ("base",)
    assert section.value("base", "clean") == pytest.approx(0.6)
    assert "`0123456789ab` `ba9876543210`" in markdown([section])


def test_seeds_are_averaged_within_an_episode():
    records = column(8, ALL) + column(4, ALL, seed=1)
    (section,) = sections(records)
    assert section.value("base", "clean") == pytest.approx(0.6)
    assert section.clean["base", "SR"].value == pytest.approx(0.6)
    assert "seed 0, 1" in markdown([section])
    gap = row(3, True, seed=1, corruption="flare", severity=0.6)
    lacking = [r for r in records if rows.identity(r) != rows.identity(gap)]
    (section,) = sections(lacking)
    assert [(gap.corruption, gap.have) for gap in section.gaps] == [("flare", 9)]


def test_table_lists_values_seed_by_seed():
    records = column(8, ALL) + column(5, ALL, seed=1) + column(8, ALL, **HARD)
    matches = lines(records)
    assert matches["Clean SR, seed by seed"] == ["80.0 / 50.0", "–"]
    assert matches["PRS-SR, seed by seed"] == ["0.50 / 0.80", "–"]
    none = dict.fromkeys(("clean", *ALL), 0)
    matches = lines(column(8, ALL) + column(0, none, seed=1))
    assert matches["PRS-SR, seed by seed"] == ["0.50 / undefined"]
    assert "seed by seed" not in markdown(sections(column(8, ALL)))


def test_columns_are_compared_over_common_seeds():
    """Two columns are compared only over the seeds that both have, because runs with the same seed
    use the same corruption keys.
    """
    base = column(8, ALL) + column(2, dict.fromkeys(NAMES, 1), seed=1)
    matches = sections(base + column(6, ALL, **HARD))[0]
    alone = sections(column(8, ALL) + column(6, ALL, **HARD))[0]
    assert matches.differences["da_per_episode"].clean.value == pytest.approx(-0.2)
    assert matches.differences == alone.differences
    apart = sections(base + column(6, ALL, seed=7, **HARD))[0]
    assert apart.differences["da_per_episode"] == Difference(None, None, {})
    assert markdown([apart]).count("in common") == 1


def test_unfinished_seed_is_left_out_with_a_note():
    """A seed that has run only a few episodes must not reduce the episodes of a complete seed."""
    part = [r for r in column(2, ALL, seed=1) if int(r["episode_id"]) < 2]
    (section,) = sections(column(8, ALL) + part)
    assert section.value("base", "clean") == pytest.approx(0.8)
    assert section.retained["base", "RGB", "SR"].episodes == 10
    assert "Seed 1 of base is not finished and left out: 26 of 130 rows." in markdown([section])


def test_seed_counts_only_at_its_severities():
    records = column(8, ALL, 0.2) + column(8, ALL, 0.6) + column(4, ALL, 0.6, seed=1)
    mild, strong = sections(records)
    # only seed 0 counts, because only seed 0 has corrupted cells at this severity
    assert mild.value("base", "clean") == pytest.approx(0.8)
    assert mild.retained["base", "RGB", "SR"].estimate.value == pytest.approx(0.5)
    assert strong.value("base", "clean") == pytest.approx(0.6)
    assert not mild.gaps and not strong.gaps
    assert "left out" not in markdown([mild, strong])


def test_heading_names_the_agents():
    """A table contains a second training run only if that run was measured at the table's
    severity."""
    other = column(4, ALL, 0.6, seed=1, agent="eeee00000000")
    mild, strong = sections(column(8, ALL, 0.2) + column(8, ALL, 0.6) + other)
    assert "eeee00000000" not in markdown([mild]) and "eeee00000000" in markdown([strong])
    assert "Several seeds" not in markdown([mild]) and "Several seeds" in markdown([strong])


@pytest.mark.slow
def test_table_accepts_seeds_and_a_reference(tmp_path, capsys):
    records = column(8, ALL) + column(2, ALL, seed=1) + column(6, ALL, **HARD)
    (tmp_path / "rows.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records))
    arguments = [str(tmp_path / "rows.jsonl"), "--out", str(tmp_path / "out")]
    assert table.main([*arguments, "--seed", "0", "--against", "da_per_episode"]) == 0
    printed = capsys.readouterr().out
    assert "| Corruption | da_per_episode | base |" in printed
    assert "| Clean SR against da_per_episode | – | +20.0" in printed and "seed 0," in printed
    for wrong, words in (
        ("--seed=4", "seeds must be among 0, 1, got 4"),
        ("--against=bas", "Did you mean"),
    ):
        assert table.main([*arguments, wrong]) == 2
        assert words in capsys.readouterr().err


def test_controls_without_corruption_get_a_clean_table():
    clean, full = sections(column(8, ALL) + cell(1, name="random", agent="random"))
    assert clean.columns == ("base", "random")
    assert full.columns == ("base",)
    assert "clean only" in markdown([clean])


def test_corruptions_outside_the_suite_have_their_own_block():
    (section,) = sections(column(8, {"fog": 2, "rain": 6}))
    assert section.blocks == {"Other": ("fog", "rain")}
    assert section.retained["base", "Other", "SR"].estimate.value == pytest.approx(0.5)


def test_white_box_is_not_applicable_without_prompt():
    spoken = dict.fromkeys((name for name in INSTRUCTION if name != "white_box"), 4)
    records = column(8, spoken)
    (section,) = sections(records)
    assert section.blocks == {"Instruction": tuple(spoken)} and section.gaps == []
    matches, text = lines(records), markdown([section])
    assert matches["**PRS-SR (Instruction)**"][0].startswith("**0.50**")
    assert matches["White-box prompt"] == ["n/a"] and matches["Black-box prompt"] == ["40.0"]
    assert "not applicable and not part of the PRS" in text
    prompted = lines(column(8, spoken | {"white_box": 8}))
    assert prompted["White-box prompt"] == ["80.0"]
    assert prompted["**PRS-SR (Instruction)**"][0].startswith("**0.56**")


@pytest.mark.slow
def test_pictures_show_what_was_measured(tmp_path):
    records = column(8, ALL, 0.3) + column(8, ALL, 0.6) + column(6, ALL, 0.6, **HARD)
    records = [r for r in records if r["corruption"] != "multipath"]
    paths = write(records, tmp_path)
    names = [path.name for path in paths]
    assert names == ["table.md", "heatmap.png", "severity.png", "heatmap-2.png"]
    for path in paths[1:]:
        picture = cv2.imread(str(path))
        assert min(picture.shape[:2]) > 300
        assert np.unique(picture[::3, ::3].reshape(-1, 3), axis=0).shape[0] > 20
        assert f"({path.name})" in paths[0].read_text("utf-8")


def test_table_command_prints_without_writing_files(tmp_path, capsys, monkeypatch):
    rows.write(tmp_path / "base.jsonl", column(8, ALL))
    monkeypatch.chdir(tmp_path)
    assert table.main(["base.jsonl", "--print-only"]) == 0
    printed = capsys.readouterr().out
    assert "| Clean SR | 80.0 " in printed and "wrote" not in printed and "![" not in printed
    assert [path.name for path in tmp_path.iterdir()] == ["base.jsonl"]


@pytest.mark.slow
def test_table_command_joins_files_and_folders(tmp_path, capsys):
    rows.append(tmp_path / "runs/base/rows.jsonl", column(8, ALL))
    rows.write(tmp_path / "hardened.jsonl.gz", column(7, ALL, **HARD))
    inputs = [str(tmp_path / "runs"), str(tmp_path / "hardened.jsonl.gz")]
    assert table.main([*inputs, "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "| Corruption | base | da_per_episode |" in printed
    assert (tmp_path / "out/table.md").read_text("utf-8") in printed
    assert (tmp_path / "out/heatmap.png").stat().st_size > 10_000


def test_table_command_reports_mistakes(tmp_path, capsys):
    assert table.main([str(tmp_path)]) == 2
    assert "No result rows under" in capsys.readouterr().err
    (tmp_path / "rows.jsonl").write_text("")
    assert table.main([str(tmp_path / "rows.jsonl")]) == 2
    assert "no result rows to show" in capsys.readouterr().err


def test_sections_do_not_depend_on_row_order():
    records = column(8, ALL) + column(5, ALL, **HARD)
    mixed = [records[i] for i in np.random.default_rng(0).permutation(len(records))]
    assert sections(mixed)[0].retained == sections(records)[0].retained
    assert set(DEPTH) | set(RGB) == {r["corruption"] for r in records} - {"clean"}
    assert row(0, True)["corruption"] == "clean"


UNSEEN = (*unseen_names("rgb"), *unseen_names("depth"))


def test_unseen_corruptions_have_a_table_of_their_own():
    records = column(8, dict.fromkeys(UNSEEN, 2), version="1") + column(8, ALL)
    suite, unseen = sections(records)
    assert (suite.kind, set(suite.blocks)) == ("", {"RGB", "Depth"})
    assert (unseen.kind, set(unseen.blocks)) == (
        "unseen corruptions",
        {"unseen RGB", "unseen depth"},
    )
    assert unseen.value("base", "clean") == 0.8
    assert unseen.retained["base", "unseen RGB", "SR"].estimate.value == pytest.approx(0.25)
    text = markdown([unseen])
    assert "## val_unseen, unseen corruptions, severity 0.6" in text
    assert f"Mean SR of {len(UNSEEN)} corruptions" in text and "†" not in text


def test_suite_figures_ignore_other_corruptions():
    """The rows of unseen corruptions have fewer seeds, missing cells and an additional agent."""
    suite = column(8, ALL) + column(6, ALL, seed=1) + column(5, ALL, **HARD)
    other = column(8, dict.fromkeys(UNSEEN, 2)) + column(5, {"spatter+haze": 1}, **HARD)
    other += column(3, {"haze": 1}, agent="eeee00000000", name="third")
    alone, among = sections(suite)[0], sections(suite + other)[0]
    assert markdown([alone]) == markdown([among])
    assert [s.columns for s in sections(suite + other)][1:] == [
        ("base", "third"),
        ("da_per_episode",),
    ]


def test_halves_of_unseen_corruptions_have_a_prs():
    validation, test = (unseen_names("rgb", half=half) for half in ("validation", "test"))
    records = column(8, dict.fromkeys(validation, 8) | dict.fromkeys(test, 4))
    matches = lines(records)
    assert matches["**PRS-SR (unseen RGB)**"][0].startswith("**0.75**")
    assert matches["PRS-SR (unseen RGB, validation)"][0].startswith("**1.00**")
    assert matches["PRS-SR (unseen RGB, test)"][0].startswith("**0.50**")
    half = lines(column(8, dict.fromkeys(test, 4)))
    # all corruptions of the validation or test half of the unseen suite are present
    assert half["**PRS-SR (unseen RGB)**"][0].endswith("]")
    assert "PRS-SR (unseen RGB, test)" not in half
    part = lines(column(8, dict.fromkeys(test[1:], 4)))
    assert part["**PRS-SR (unseen RGB)**"][0].endswith("† 5/6")


def test_pairs_have_a_table_of_their_own():
    (section,) = sections(column(8, {"spatter+missing_data": 4, "low_light+mask": 2}))
    assert section.kind == "pairs of corruptions"
    assert section.blocks == {"Pairs": ("low_light+mask", "spatter+missing_data")}
    assert "| Spatter + Missing data | 40.0 |" in markdown([section])


def test_temporal_table_does_not_miss_the_fault_that_needs_a_partner():
    """``intermittent`` exists only in pairs."""
    temporal = dict.fromkeys([n for n in fault_names("temporal") if n != "intermittent"], 4)
    (section,) = sections(column(8, temporal | {"intermittent+spatter": 4}))
    assert "†" not in markdown([section]) and "Not measured" not in markdown([section])


def test_each_corruption_can_have_intervals_and_differences():
    records = column(8, {"spatter": 4}) + column(6, {"spatter": 6}, **HARD)
    (section,) = sections(records)
    detailed = markdown([section], intervals=True)
    assert re.search(r"\| Spatter \| 40.0 \[\d+.0, \d+.0\] \| 60.0 \[\d+.0, \d+.0\] \|", detailed)
    clean = r"\| Spatter against clean \| \*\*-40.0\*\* \[-70.0, -10.0\] \| \+0.0 \[–\] \|"
    assert re.search(clean, detailed)
    assert re.search(r"\| Spatter against base \| – \| \+20.0 \[\+0.0, \+50.0\] \|", detailed)
    assert "Spatter against" not in markdown([section])


def test_intervals_leave_out_what_was_not_measured():
    """The second column lacks spatter, and one episode of flare."""
    records = column(8, {"spatter": 4, "flare": 4}) + column(6, {"flare": 6}, **HARD)[:-1]
    detailed = markdown(sections(records), intervals=True)
    assert re.search(r"\| Spatter \| 40.0 \[.*\] \| – \|", detailed)
    assert re.search(r"\| Spatter against base \| – \| – \|", detailed) is None
    assert re.search(r"\| Flare \| 40.0 \[.*\] \| 66.7 \[.*\]\\\* \|", detailed)
    assert re.search(r"\| Flare against base \| – \| \+22.2 \[.*\]\\\* \|", detailed)


HOSTILE = "a|b`c`<script>x</script>[y](http://z)![p](q)$\\frac$*#"


@pytest.mark.slow
def test_names_are_escaped_in_tables_and_pictures(tmp_path):
    mine = {"name": HOSTILE, "agent": "ffff00000000", "rule": f"{HOSTILE} |", "split": HOSTILE}
    records = [r | {"split": HOSTILE, "rule": mine["rule"]} for r in column(8, ALL)]
    text = write([*records, *column(4, ALL, **mine)], tmp_path)[0].read_text()
    displayed = next(line for line in text.splitlines() if line.startswith("| Corruption"))
    # three cells: the name column and two result columns
    assert len(re.findall(r"(?<!\\)\|", displayed)) == 4
    for mark in ("<script", "</script", "[y](", "![p]", "`c`", "\n#a"):
        assert not re.search(rf"(?<!\\){re.escape(mark)}", text)
    assert (tmp_path / "heatmap.png").is_file() and (tmp_path / "severity.png").is_file()


def test_plain_names_are_not_escaped():
    for name in ("da_per_episode", "frontier (0123ab)", "STOP and geodesic < 2.0 m", "base+rules"):
        assert markdown_of(name) == name
    assert markdown_of("a\n## b\r\n| c") == "a ## b \\| c"


def other_list(output, **changes):
    """Return copies of the rows with other episode ids."""
    return [r | changes | {"episode_id": f"{r['episode_id']}-other"} for r in output]


def test_lists_of_episodes_have_separate_tables():
    first = column(8, ALL) + column(5, ALL, **HARD)
    second = other_list(column(6, ALL), agent="aaaa00000000", seed=1) + other_list(
        column(7, ALL, **HARD), agent="bbbb00000000", seed=1
    )
    output = sections(first + second)
    assert [part.columns for part in output] == [("base", "da_per_episode")] * 2
    assert [part.differences["da_per_episode"].clean.value for part in output] == pytest.approx(
        [-0.3, 0.1]
    )
    assert not any(part.gaps for part in output)
    text = markdown(output)
    assert "## val_unseen from 0, severity 0.6" in text
    assert "## val_unseen from 0-other, severity 0.6" in text
    assert "from" not in markdown(sections(first)).splitlines()[0]


def test_lists_with_common_episodes_share_a_table():
    few = [r for r in column(5, ALL, **HARD) if r["episode_id"] in "01"]
    rest = [r for r in column(5, ALL) if r["episode_id"] in "89"]
    every = column(6, ALL, name="oracle", agent="aaaa00000000")
    assert len(sections(few + rest)) == 2
    assert len(sections(few + rest + every)) == 1


def test_rows_at_severity_zero_are_not_clean_rows():
    """A corruption may also be run at severity 0. In an earlier version, the displayed severity
    then depended on the order of a set."""
    rows = column(8, {"flare": 0}) + [
        output | {"corruption": "flare", "severity": 0.0} for output in cell(8)
    ]
    (part,) = [section for section in sections(rows) if section.severity == 0.6]
    assert part.value("base", "flare") == 0.0 and part.value("base", "clean") == 0.8


def test_columns_distinguish_hashes_with_equal_prefixes():
    rows = [*cell(8, agent="myagent-v1"), *cell(2, agent="myagent-v2")]
    (part,) = sections(rows)
    assert set(part.columns) == {"base (myagent-v1)", "base (myagent-v2)"}


def test_report_over_2000_made_up_corruptions_finishes(tmp_path):
    """Issue T2, item 9."""
    wins = {f"made_up_{number}": number % 10 for number in range(2000)}
    rows = column(9, wins) + column(8, wins, name="other", agent="a" * 12)[:-1]  # with a gap
    began = time.process_time()
    paths = report.write(rows, tmp_path)
    assert time.process_time() - began < 30
    assert [path.name for path in paths] == ["table.md"]
    text = paths[0].read_text()
    assert report.NO_PICTURE in text and "made_up_1999" in text and "other" in text


def test_report_over_many_severities_draws_a_bounded_number_of_pictures(tmp_path, monkeypatch):
    """Issue T2, item 9."""
    monkeypatch.setattr(report, "MOST_HEATMAPS", 1)
    rows = cell(9) + cell(5, corruption="spatter", severity=0.3)
    rows += cell(4, corruption="spatter", severity=0.6)
    names = [path.name for path in report.write(rows, tmp_path)]
    assert names == ["table.md", "heatmap.png", "severity.png"]
    assert (tmp_path / "table.md").read_text().count(report.NO_PICTURE) == 1
