"""Tests of ``mitigate run --check``, which prints a program's instruction and plots its frames."""

import shlex
import sys

import cv2
import numpy as np
import pytest

from mitigate.bridge import check as drawing
from mitigate.bridge.cameras import Rig
from mitigate.bridge.check import check
from mitigate.corruptions import Corruption

from .conftest import AGENT, LAB, config


@pytest.mark.slow
def test_check_describes_and_draws_a_program(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PYTHONPATH", str(LAB))
    typed = config(f"out={tmp_path}", "conditions=[spatter,multipath,white_box]")
    sheet = check(typed, shlex.split(f"{AGENT} --cameras 2"))
    printed = capsys.readouterr().out
    assert "rgb: rgb, rgb_30; 32 x 32 x 3 uint8, hfov 90, 2 as one panorama" in printed
    assert "depth: depth, depth_30" in printed and "0 to 1 for 0 to 10 m" in printed
    assert "instruction 'Walk to the door 0.'" in printed
    assert "white_box-s0.6: not applicable" in printed and "spatter-s0.6: applies" in printed
    # four rows: clean RGB, clean depth, and two corruptions
    assert cv2.imread(str(sheet)).shape[0] == 4 * 164


@pytest.mark.parametrize("name", ["file", "allow_pickle", "heading", "a/b", "é"])
def test_check_draws_cameras_of_any_name(name, tmp_path):
    cameras, program = {name: {"type": "rgb"}}, tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook, numpy\n"
        f"frames = {{{name!r}: numpy.full((8, 8, 3), 90, 'uint8')}}\n"
        f"mitigate_hook.connect('a').corrupt(frames, cameras={cameras})\n"
    )
    typed = config(f"out={tmp_path}/o", "conditions=[spatter]")
    assert cv2.imread(str(check(typed, [sys.executable, str(program)]))) is not None


def test_check_draws_only_the_first_call(tmp_path, capsys):
    program = tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook, numpy\n"
        "met = mitigate_hook.connect('a')\n"
        "met.corrupt({'rgb': numpy.full((16, 16, 3), 90, 'uint8')})\n"
        "met.corrupt({'depth': numpy.ones((16, 16), 'float32')})\n"
        "met.finish(1)\n"
    )
    typed = config(f"out={tmp_path}/o", "conditions=[spatter,gaussian_noise]")
    sheet = check(typed, [sys.executable, str(program)])
    assert cv2.imread(str(sheet)).shape[0] == 2 * 164  # clean and spatter
    assert "no depth frame: no depth corruption is plotted" in capsys.readouterr().out


def test_check_reports_a_program_without_cameras(tmp_path, capsys):
    program = tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook\nmitigate_hook.connect('a').corrupt({'pose': [0, 0]})\n"
    )
    typed = config(f"out={tmp_path}/o", "conditions=[spatter]")
    assert check(typed, [sys.executable, str(program)]) is None
    assert "nothing to plot" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "command", "words"),
    [
        ("conditions=[spatter]", "", "A command is missing"),
        ("severity=0", "nav", "severity=0 changes nothing"),
        ("rule=nope", "nav", "There is no rule 'nope'"),
        ("turn=up", "nav", "There is no turn 'up'"),
        ("corruption=flare conditions=[spatter]", "nav", "both name conditions"),
    ],
)
def test_check_rejects_invalid_options_as_run_does(run, tmp_path, options, command, words):
    typed = config(f"out={tmp_path}", *options.split())
    with pytest.raises(ValueError, match=words):
        check(typed, command.split())
    assert words in run(tmp_path, options, command).stderr


@pytest.mark.parametrize(
    ("depth", "words"),
    [
        ("numpy.linspace(0.05, 0.35, 81)", "seen 0.05 to 0.35 (median 0.20) m - is it normalised"),
        ("numpy.linspace(0.5, 4.5, 81)", "seen 0.50 to 4.50 (median 2.50) m\n"),
        ("numpy.zeros(81)", "the frames hold only holes"),
    ],
)
def test_check_reports_the_range_of_depth(tmp_path, capsys, depth, words):
    program = tmp_path / "agent.py"
    program.write_text(
        "import mitigate_hook, numpy\n"
        f"depth = {depth}.reshape(9, 9, 1).astype('float32')\n"
        "mitigate_hook.connect('a').corrupt({'depth': depth})\n"
    )
    typed = config(f"out={tmp_path}/o", "conditions=[clean]")
    check(typed, [sys.executable, str(program)])
    assert words in capsys.readouterr().out


def test_draw_sheet_draws_a_corrupted_call(monkeypatch):
    named = []
    rig = Rig([{"name": "left", "type": "rgb", "shape": [8, 8, 3], "dtype": "uint8"}])

    def late(group, views, corruption, key, heading, stream):
        return views + 1 if corruption.name == "spatter" and key.frame == 3 else views

    def note(axes, names, group, views):
        named.append((*names, group.cameras[0].name))

    monkeypatch.setattr(drawing, "corrupt_group", late)
    monkeypatch.setattr(drawing, "_draw_row", note)
    frames = {"camera left": np.full((8, 8, 3), 90, np.uint8), "heading": np.array([])}
    drawing.draw_sheet(rig, frames, [Corruption("spatter", 0.6), Corruption("flare", 0.6)], {}, 0)
    assert named == [
        ("clean rgb", "left"),
        ("spatter", "at call 3", "left"),
        ("flare", "no change in 40 calls", "left"),
    ]
