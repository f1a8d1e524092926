"""Tests of the command that corrupts episode files: text, tokens, options and output files."""

from __future__ import annotations

import gzip
import json
import subprocess
import sys
import tracemalloc

import pytest

from mitigate.corruptions import Key, corrupt_instruction
from mitigate.corruptions.language.fidelity import check
from mitigate.corruptions.language.style import MANNERS
from mitigate.worlds import corrupt_episodes_command as episodes_command
from mitigate.worlds.corrupt_episodes_command import ORIGINAL, run
from mitigate.worlds.episodes import read_episodes, read_extras
from tests.r2r_ce import FOLDER, needs_r2r_ce

TEXT = "Walk past the red sofa, turn left at the door and stop by the lamp."
WORDS = [
    "<pad>",
    "<unk>",
    *sorted({"walk", "past", "the", "red", "sofa", "turn", "left", "at", "."}),
]
VOCABULARY = {
    "word2idx_dict": {word: index for index, word in enumerate(WORDS)},
    "UNK_INDEX": 1,
    "PAD_INDEX": 0,
}


def episode(index: int, **instruction) -> dict:
    return {
        "episode_id": index,
        "trajectory_id": index,
        "scene_id": "a/b.glb",
        "start_position": [0.0, 0.0, 0.0],
        "start_rotation": [0.0, 0.0, 0.0, 1.0],
        "info": {"geodesic_distance": 1.0},
        "goals": [{"position": [1.0, 0.0, 0.0], "radius": 3.0}],
        "instruction": {"instruction_text": TEXT, "instruction_tokens": [2] * 40} | instruction,
        "reference_path": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        "odd": {"kept": True},
    }


def write(path, *episodes, **extras):
    with gzip.open(path, "wt") as file:
        json.dump({"episodes": list(episodes), "instruction_vocab": VOCABULARY} | extras, file)
    return path


def raw(path) -> list[dict]:
    with gzip.open(path, "rt") as file:
        return json.load(file)["episodes"]


def test_run_changes_only_the_instruction(tmp_path):
    source = write(tmp_path / "in.json.gz", *(episode(i) for i in range(6)))
    summary = run(source, tmp_path / "out.json.gz", "black_box", 0.5, seed=4)
    for old, new in zip(raw(source), raw(tmp_path / "out.json.gz"), strict=True):
        key = Key(4, str(old["episode_id"]))
        expected = corrupt_instruction(TEXT, "black_box", 0.5, key)
        assert new["instruction"] == {"instruction_text": expected, ORIGINAL: TEXT}
        assert {k: v for k, v in new.items() if k != "instruction"} == {
            k: v for k, v in old.items() if k != "instruction"
        }
    assert (summary["episodes"], summary["changed"]) == (6, 6)
    assert summary["tokens"]["removed"] == 6
    assert any("removed" in notice for notice in episodes_command.notices(summary))
    assert read_extras(tmp_path / "out.json.gz") == read_extras(source)
    assert json.loads((tmp_path / "out.json.gz.summary.json").read_text()) == summary


@pytest.mark.parametrize("family", ["formal", "mask", "black_box"])
def test_run_with_severity_zero_changes_nothing(tmp_path, family):
    source = write(tmp_path / "in.json.gz", *(episode(i) for i in range(3)))
    summary = run(source, tmp_path / "out.json.gz", family, 0.0)
    assert raw(tmp_path / "out.json.gz") == raw(source) and summary["changed"] == 0


def test_run_tokenizes_with_the_vocabulary_of_the_file(tmp_path):
    source = write(tmp_path / "in.json.gz", episode(1))
    summary = run(source, tmp_path / "out.json.gz", "mask", 1.0, tokenizer="vocabulary")
    (got,) = raw(tmp_path / "out.json.gz")
    message = (
        got["instruction"]["instruction_text"].lower().replace(",", "").replace(".", " .").split()
    )
    index = VOCABULARY["word2idx_dict"]
    expected = [index.get(word, 1) for word in message]
    assert got["instruction"]["instruction_tokens"] == expected + [0] * (40 - len(expected))
    assert summary["tokens"]["remade"] == 1 and "[mask]" in message
    run(source, tmp_path / "long.json.gz", "black_box", 1.0, tokenizer="vocabulary")
    summary = json.loads((tmp_path / "long.json.gz.summary.json").read_text())
    (got,) = raw(tmp_path / "long.json.gz")
    assert len(got["instruction"]["instruction_tokens"]) == 40
    assert summary["tokens"]["cut_short"] == 1
    assert "truncated" in episodes_command.notices(summary)[0]


def test_run_uses_a_named_tokenizer(tmp_path):
    transformers = pytest.importorskip("transformers")
    letters = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "<hole>", "walk", "past", "left", "turn"]
    (tmp_path / "vocab.txt").write_text("\n".join(letters))
    tokenizer = transformers.BertTokenizer(str(tmp_path / "vocab.txt"), mask_token="<hole>")
    tokenizer.save_pretrained(tmp_path / "named")
    source = write(tmp_path / "in.json.gz", episode(1))
    run(source, tmp_path / "out.json.gz", "mask", 1.0, tokenizer=str(tmp_path / "named"))
    (got,) = raw(tmp_path / "out.json.gz")
    text, tokens = (got["instruction"][f"instruction_{kind}"] for kind in ("text", "tokens"))
    assert "<hole>" in text and len(tokens) == 40
    assert tokens[: len(tokenizer(text)["input_ids"])] == tokenizer(text)["input_ids"]
    spoken = {"instruction_text": "Gehe links.", "language": "de-DE"}
    source = write(tmp_path / "in.json.gz", *(episode(i) for i in range(8)), episode(8, **spoken))
    for severity in (0.0, 0.5):  # at severity 0 too, instructions must have the agent's tokens
        run(source, tmp_path / "o.json", "formal", severity, tokenizer=str(tmp_path / "named"))
        for got in json.loads((tmp_path / "o.json").read_text())["episodes"]:
            text, tokens = (got["instruction"][f"instruction_{x}"] for x in ("text", "tokens"))
            cut = tokenizer(text, truncation=True, max_length=40)["input_ids"]
            # truncation keeps the end token (3)
            assert tokens == (cut + [0] * 40)[:40] and 3 in tokens


def test_run_counts_other_languages(tmp_path):
    rxr = {"timed_instruction": [{"word": "Walk", "start_time": 0.1}]}
    source = write(
        tmp_path / "in.json.gz",
        episode(1, language="hi-IN", instruction_text="आगे बढ़ें"),
        episode(2, language="te-IN", instruction_text="ముందుకు"),
        episode(3, language="hi-IN", instruction_text="रुकें", **rxr),
        episode(4, language="en-IN", **rxr),
    )
    summary = run(source, tmp_path / "out.json.gz", "capitalize", 1.0)
    old, new = raw(source), raw(tmp_path / "out.json.gz")
    assert new[:3] == old[:3] and new[3]["instruction"]["language"] == "en-IN"
    # removed, because it contains the clean words with their times
    assert "timed_instruction" not in new[3]["instruction"]
    assert summary["skipped_languages"] == {"hi-IN": 2, "te-IN": 1} and summary["changed"] == 1
    assert "2 in hi-IN, 1 in te-IN" in episodes_command.notices(summary)[0]


def test_run_reports_the_gate_of_a_style(tmp_path):
    source = write(tmp_path / "in.json.gz", *(episode(i) for i in range(40)))
    gate = run(source, tmp_path / "out.json.gz", "formal", 0.5)["gate"]
    assert 10 < gate["rewrites"] < 30 and gate["pass_rate"] == 1.0
    assert gate["clauses"] == 3 * gate["rewrites"] and gate["kept_original"] == 0


@pytest.mark.slow
def test_run_memory_does_not_grow_with_the_file(tmp_path):
    peaks = []
    for count in (150, 1200):
        source = write(
            tmp_path / f"{count}.json.gz", *(episode(i, note="x" * 10_000) for i in range(count))
        )
        tracemalloc.start()
        run(source, tmp_path / f"{count}-out.json.gz", "mask", 0.5)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < peaks[0] + 1_000_000, peaks  # although the larger file has 10 MB more


def test_run_counts_instructions_without_words(tmp_path):
    source = write(
        tmp_path / "in.json.gz", episode(1), *(episode(i + 2, instruction_text=t) for i, t in
        enumerate(("  ", "...")))
    )  # fmt: skip
    for name in ("formal", "mask", "black_box"):
        summary = run(source, tmp_path / "out.json.gz", name, 1.0)
        assert raw(tmp_path / "out.json.gz")[1:] == raw(source)[1:]
        assert (summary["blank"], summary["changed"]) == (2, 1)
        assert "2 instructions have no word" in episodes_command.notices(summary)[0]


def test_main_warns_about_an_empty_file(tmp_path, capsys):
    source = write(tmp_path / "in.json.gz")
    line = [str(source), str(tmp_path / "o.json"), "corruption=mask", "severity=1"]
    assert episodes_command.main(line) == 0
    assert "warning: the file has no episodes" in capsys.readouterr().err


def test_summary_has_only_the_used_options(tmp_path):
    source = write(tmp_path / "in.json.gz", episode(1))
    options = {"split", "mask_token", "tagger"}
    for name, used in (
        ("formal", {}),
        ("capitalize", {"tagger": "own"}),
        ("mask", {"tagger": "own", "mask_token": "[MASK]"}),
        ("black_box", {"split": "test"}),
    ):
        summary = run(source, tmp_path / "out.json.gz", name, 1.0)
        assert {key: summary[key] for key in summary.keys() & options} == used
        assert summary["corruption"] == name


@pytest.mark.parametrize("name", ["formal", "mask", "capitalize", "black_box"])
@pytest.mark.parametrize(
    "option", [{"split": "tset"}, {"tagger": "best"}, {"mask_token": " "}, {"seed": 0.5}], ids=str
)
def test_run_rejects_invalid_options_first(tmp_path, name, option):
    source = write(tmp_path / "in.json.gz", episode(1))
    with pytest.raises(ValueError) as error:
        run(source, tmp_path / "out.json.gz", name, 0.5, **option)
    assert "Episode" not in str(error.value)


def test_run_does_not_overwrite_other_files(tmp_path):
    source, out = write(tmp_path / "in.json.gz", episode(1)), tmp_path / "out.json"
    out.write_text("precious")
    with pytest.raises(ValueError, match="was not written by corrupt_episodes.*move"):
        run(source, out, "mask", 1.0)
    assert out.read_text() == "precious"
    out.unlink()
    assert run(source, out, "mask", 1.0) == run(source, out, "mask", 1.0)


@pytest.mark.parametrize(
    "summary",
    ["{}", "[]", "null", '{"corruption": "mask"}', "not JSON", "\ud800"],
    ids=str,
)
def test_run_keeps_a_file_with_a_foreign_summary(tmp_path, summary):
    source, out = write(tmp_path / "in.json.gz", episode(1)), tmp_path / "out.json"
    out.write_text("precious")
    (tmp_path / "out.json.summary.json").write_text(summary, errors="surrogatepass")
    with pytest.raises(ValueError, match="was not written by corrupt_episodes.*move"):
        run(source, out, "mask", 1.0)
    assert out.read_text() == "precious"


def test_run_keeps_a_changed_file(tmp_path):
    source, out = write(tmp_path / "in.json.gz", episode(1)), tmp_path / "out.json"
    run(source, out, "mask", 1.0)
    out.write_text("precious")
    with pytest.raises(ValueError, match="has changed since.*move"):
        run(source, out, "mask", 1.0)
    assert out.read_text() == "precious"


def test_main_writes_nothing_after_an_interrupt(tmp_path, monkeypatch, capsys):
    def interrupted(*settings, **options):
        raise KeyboardInterrupt

    source = write(tmp_path / "in.json.gz", episode(1))
    monkeypatch.setattr(episodes_command, "corrupt_instruction", interrupted)
    line = [str(source), str(tmp_path / "o.json"), "corruption=mask", "severity=1"]
    assert episodes_command.main(line) == 130
    assert "interrupted: nothing was written" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["in.json.gz"]


@pytest.mark.parametrize(
    "wrong",
    [
        {"word2idx_dict": ["walk"]},
        {"word2idx_dict": {"walk": "2"}},
        {"word2idx_dict": {"walk": 2.5}},
        {"UNK_INDEX": None},
        {"PAD_INDEX": "0"},
    ],
    ids=str,
)
def test_run_rejects_an_invalid_vocabulary(tmp_path, wrong):
    source = write(tmp_path / "in.json.gz", episode(1), instruction_vocab=VOCABULARY | wrong)
    with pytest.raises(ValueError, match="needs the key instruction_vocab.*whole numbers"):
        run(source, tmp_path / "o.json", "mask", 1.0, tokenizer="vocabulary")


def test_run_names_the_missing_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "transformers", None)
    source = write(tmp_path / "in.json.gz", episode(1))
    with pytest.raises(ValueError, match="needs transformers.*pip install transformers"):
        run(source, tmp_path / "o.json", "mask", 1.0, tokenizer="bert")


def test_run_leaves_no_output_for_a_damaged_file(tmp_path):
    source = write(tmp_path / "in.json.gz", episode(1), episode(2) | {"start_position": "here"})
    with pytest.raises(ValueError, match="start_position"):
        run(source, tmp_path / "out.json.gz", "mask", 0.5)
    assert [path.name for path in tmp_path.iterdir()] == ["in.json.gz"]


def test_main_explains_invalid_arguments(tmp_path, capsys):
    source, out = str(write(tmp_path / "in.json.gz", episode(1))), str(tmp_path / "out.json.gz")
    for options, part in (
        (["corruption=mask"], "option severity is missing"),
        (["severity=0.5"], "Corruptions: friendly"),
        (["corruption=mask", "severity=0.5", "split=test"], "split= has no effect on mask"),
        (["corruption=black_box", "severity=0.5", "tagger=own"], "only on mask and capitalize"),
        (["corruption=mask", "severity=high"], "must be a number"),
        (["corruption=maks", "severity=0.5"], "Did you mean mask"),
        (["corruption=white_box", "severity=0.5"], "not applicable to a file"),
        (["corruption=white_box", "severity=0.5", "split=test"], "not applicable to a file"),
        (["corruption=spatter", "severity=0.5"], "mask, black_box."),
        (["corruption=mask", "severity=0.5", "seed=1.5"], "seed must be a whole number"),
        (["corruption=mask", "severity=0.5", "tokeniser=x"], "Did you mean tokenizer"),
        (["corruption=mask", "severity=0.5", "tokenizer=/none/such"], "no tokenizer '/none/such'"),
        (["corruption=mask", "severity=0.5", "tagger=best"], "own, spacy"),
    ):
        assert episodes_command.main([source, out, *options]) == 2
        error = capsys.readouterr().err
        assert part in error and "Traceback" not in error
    assert episodes_command.main([source, source, "corruption=mask", "severity=0.5"]) == 2
    assert "another name" in capsys.readouterr().err
    assert episodes_command.main([source[:-3], out, "corruption=mask", "severity=0.5"]) == 2


def test_module_runs_as_a_program(tmp_path):
    source = write(tmp_path / "in.json.gz", episode(1))
    printed = subprocess.run(
        [
            *(
                sys.executable,
                "-m",
                "mitigate.corrupt_episodes",
                source,
                tmp_path / "out.json.gz",
            ),
            *("corruption=capitalize", "severity=1"),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(printed.stdout)["changed"] == 1 and "notice" in printed.stderr


@pytest.mark.slow
@needs_r2r_ce
@pytest.mark.parametrize("family", [*MANNERS, "capitalize", "mask", "black_box"])
def test_run_corrupts_real_r2r_ce_episodes(tmp_path, family):
    source, out = FOLDER / "val_seen.json.gz", tmp_path / "out.json.gz"
    summary = run(source, out, family, 0.5, tokenizer="vocabulary")
    assert summary["episodes"] == 778 and summary["tokens"]["remade"] == summary["changed"] > 300
    for old, new in zip(read_episodes(source), read_episodes(out), strict=True):
        assert (old.goals, old.reference_path) == (new.goals, new.reference_path)
        if new.instruction.text == old.instruction.text:
            assert new.instruction == old.instruction
            continue
        assert new.instruction.extra[ORIGINAL] == old.instruction.text
        assert len(new.instruction.tokens) == len(old.instruction.tokens)
        if family != "capitalize":
            assert new.instruction.tokens != old.instruction.tokens
        if family in MANNERS:
            assert check(old.instruction.text, new.instruction.text) == []


def test_run_does_not_overwrite_with_its_summary(tmp_path, capsys):
    source = tmp_path / "q.json.summary.json"
    source.write_text(json.dumps({"episodes": []}))
    options = ["corruption=mask", "severity=0.5"]
    assert episodes_command.main([str(source), str(tmp_path / "q.json"), *options]) == 2
    assert "its summary" in capsys.readouterr().err
    other = tmp_path / "new.json.summary.json"
    other.write_text("of somebody else")
    assert episodes_command.main([str(source), str(tmp_path / "new.json"), *options]) == 2
    assert "was not written by corrupt_episodes" in capsys.readouterr().err
    assert source.read_text() == '{"episodes": []}' and other.read_text() == "of somebody else"
