"""Tests of loops without Habitat: no frame stays clean, no episode is lost, and no invalid result
is stored."""

import sys

import pytest

from mitigate.bridge.condition import Subset, hash_episode
from mitigate.bridge.results import OWN, read, rows
from mitigate.bridge.server import Listener
from mitigate.corruptions import Corruption

from .conftest import condition, python

BEGIN = """
import os, sys, numpy, mitigate_hook
rgb = numpy.full((16, 16, 3), 90, 'uint8')
depth = numpy.full((16, 16, 1), 2.0, 'float32')
"""


def run_loop(tmp_path, code, settings=None):
    """Run a program with a loop over episodes, and return its process and its reports."""
    with Listener(settings or condition("spatter"), tmp_path / "events", patience=5.0) as listener:
        process = python(listener, BEGIN + code)
    return process, read(tmp_path / "events")


@pytest.mark.parametrize(
    ("entry", "name", "shape"),
    [
        ("'image': rgb.transpose(2, 0, 1)", "image", "(3, 16, 16)"),
        ("'frames': numpy.stack([rgb] * 4)", "frames", "(4, 16, 16, 3)"),
        ("'cam2': {'rgb': rgb}", "cam2.rgb", ""),
        ("'left': [rgb, rgb]", "left", ""),
        ("'left': ['a word', (0, rgb)]", "left.1.1", ""),
        ("'left': rgb.tolist()", "left", "(16, 16, 3)"),
        ("'left': numpy.array([None, rgb], object)", "left.1", ""),
        ("'features': numpy.zeros((12, 768))", "features", ""),
        ("'deep': {'a': [{'b': rgb[..., 0]}]}", "deep.a.0.b", "(16, 16)"),
    ],
)
def test_corrupt_stops_for_an_undescribed_frame(tmp_path, entry, name, shape):
    code = f"mitigate_hook.connect('a').corrupt({{'rgb': rgb, {entry}}})\nprint('went on')"
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 97 and "went on" not in process.stdout
    words = f"the entry {name} of an observation may be a frame {shape}"
    assert words in process.stdout and words in reports.problems[0]


@pytest.mark.parametrize("cameras", [None, {"pixels": {"type": "rgb"}}, {"top": {"type": "rgb"}}])
def test_corrupt_advises_to_pass_a_dict_of_frames_by_itself(tmp_path, cameras):
    code = "observation = {'pixels': {'top': rgb}}\nepisode = mitigate_hook.connect('a')\n"
    advice = "episode.corrupt(observation['pixels'], cameras={'top': {'type': 'rgb'}})"
    _, reports = run_loop(tmp_path, f"{code}episode.corrupt(observation, cameras={cameras})")
    assert f"pixels is a dict. Pass it by itself: {advice}" in reports.problems[0]
    process, _ = run_loop(tmp_path, f"{code}print(({advice}['top'] != rgb).any())")
    assert process.stdout.strip() == "True"


@pytest.mark.parametrize("frame", ["rgb.transpose(2, 0, 1)", "rgb[None]", "rgb.tolist()"])
def test_corrupt_stops_for_a_frame_of_another_format(tmp_path, frame):
    code = f"mitigate_hook.connect('a').corrupt({{'rgb': {frame}}})\nprint('went on')"
    process, _ = run_loop(tmp_path, code)
    assert process.returncode == 97 and "went on" not in process.stdout


def test_corrupt_leaves_other_entries_unchanged(tmp_path):
    code = (
        "seen = mitigate_hook.connect('a').corrupt({'rgb': rgb, 'pose': numpy.eye(4), 'word': 'x',"
        "'path': numpy.zeros((50, 3)), 'state': numpy.zeros((1, 512)), 'all': [1, None, {}],"
        "'map': {'rgb': rgb}}, cameras={'map': {'type': 'other'}})\n"
        "print(sorted(seen), (seen['map']['rgb'] == rgb).all(), (seen['rgb'] != rgb).any())"
    )
    process, _ = run_loop(tmp_path, code)
    assert process.stdout.strip().endswith("True True"), process.stdout


def test_corrupt_infers_the_type_from_the_name(tmp_path):
    code = (
        "met = mitigate_hook.connect('a')\n"
        "seen = met.corrupt({'depth': depth}, cameras={'depth': {'hfov': 79}})\n"
        "print((seen['depth'] != depth).any())\n"
        "met.corrupt({'left': rgb}, cameras={'left': {'type': 'color'}})"
    )
    process, reports = run_loop(tmp_path, code, condition("missing_data"))
    assert process.stdout.startswith("True") and process.returncode == 97
    assert "got 'color'" in reports.problems[0]


def test_reports_count_an_episode_lost_at_its_first_frame(tmp_path):
    code = (
        "for name in 'abc':\n    episode = mitigate_hook.connect(name)\n"
        "    episode.corrupt({'rgb': rgb})\n"
        "    if name != 'a': episode.finish(success=1)\n"
    )
    _, reports = run_loop(tmp_path, code)
    assert reports.lost == ["a"] and sorted(reports.ends) == ["b", "c"]


@pytest.mark.parametrize("processes", [1, 2])
def test_reports_name_an_episode_that_ends_twice(tmp_path, processes):
    code = (
        f"for n in range(2):\n    if {processes} == 1 or os.fork() == 0:\n"
        "        episode = mitigate_hook.connect('a')\n        episode.corrupt({'rgb': rgb})\n"
        f"        episode.finish(success=1)\n        if {processes} == 2: os._exit(0)\n"
        f"if {processes} == 2: os.wait(), os.wait()\n"
    )
    _, reports = run_loop(tmp_path, code)
    assert "must have its own name, but a ended twice" in reports.problems[0]


def test_finish_without_a_frame_accepts_only_failure(tmp_path):
    process, reports = run_loop(tmp_path, "mitigate_hook.connect('a').finish(success=False)")
    assert process.returncode == 0 and reports.ends["a"]["metrics"]["success"] == 0
    process, reports = run_loop(tmp_path, "mitigate_hook.connect('b').finish(success=True)")
    assert process.returncode == 97
    assert "none of its frames. Call episode.corrupt() at each step" in reports.problems[0]


def test_stop_reports_its_reason_to_the_server(tmp_path):
    code = (
        "if os.fork() == 0:\n"
        "    mitigate_hook.connect('a').corrupt({'rgb': rgb, 'left': rgb})\n"
        "os.wait()\n"
        "episode = mitigate_hook.connect('b')\nepisode.corrupt({'rgb': rgb})\n"
        "episode.finish(success=True)"
    )
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 0 and list(reports.ends) == ["b"]
    assert len(reports.problems) == 1 and "the entry left of an observation" in reports.problems[0]


def test_episode_stops_in_another_process(tmp_path):
    code = (
        "episode = mitigate_hook.connect('a')\n"
        "if os.fork() == 0:\n    episode.corrupt({'rgb': rgb})\n    os._exit(0)\n"
        "sys.exit(os.wait()[1] >> 8)"
    )
    process, reports = run_loop(tmp_path, code)
    assert (
        process.returncode == 97 and "in the process that runs the episode" in reports.problems[0]
    )


def test_corrupt_stops_after_finish(tmp_path):
    code = (
        "episode = mitigate_hook.connect('a')\nepisode.corrupt({'rgb': rgb})\n"
        "episode.finish(success=True)\nepisode.corrupt({'rgb': rgb})"
    )
    process, _ = run_loop(tmp_path, code)
    assert process.returncode == 97 and "episode a is finished" in process.stdout


RESULTS = BEGIN + (
    "episode = mitigate_hook.connect('a')\nepisode.corrupt({'rgb': rgb})\n"
    "try:\n    episode.finish(%s)\nexcept ValueError as error:\n    print('refused:', error)"
)


@pytest.mark.parametrize(
    ("results", "words"),
    [
        ("success=1, spl=5", "spl=5): it must be a number from 0 to 1, not percent"),
        ("success=80", "not percent"),
        ("success=0.5", "it must be 1 (or True) or 0 (or False)"),
        ("success=float('nan')", "must be a number"),
        ("success='yes'", "must be a number"),
        ("success=False, spl=0.7", "the SPL of a failed episode must be 0"),
        ("success=True, path_length=-1", "must be a number >= 0"),
    ],
)
def test_finish_rejects_invalid_results(tmp_path, results, words):
    with Listener(condition("spatter"), tmp_path) as listener:
        process = python(listener, RESULTS % results)
    assert process.stdout.startswith("refused:") and words in process.stdout, process.stdout
    assert not read(tmp_path).ends


@pytest.mark.parametrize(
    ("results", "metrics"),
    [
        ("success=True", {"success": 1.0}),
        ("success=numpy.array(1), spl=numpy.float32(0.5)", {"success": 1.0, "spl": 0.5}),
        ("success='1', spl='0.5'", {"success": 1.0, "spl": 0.5}),
        ("success=0, spl=None, mine=numpy.array(7)", {"success": 0.0, "mine": 7.0}),
    ],
)
def test_finish_converts_results_to_numbers(tmp_path, results, metrics):
    with Listener(condition("spatter"), tmp_path) as listener:
        assert python(listener, RESULTS % results).stdout == ""
    assert read(tmp_path).ends["a"]["metrics"] == metrics


WANTED = """
pairs = [("a/x.glb", n) for n in range(12)]
for scene, name in mitigate_hook.wanted(pairs):
    print(name)
    episode = mitigate_hook.connect(name, scene=scene)
    episode.corrupt({"rgb": rgb})
    episode.finish(success=True)
"""


def test_wanted_returns_the_chosen_episodes(tmp_path):
    chosen = Subset(4, tmp_path, settled=0.0)
    process, reports = run_loop(tmp_path, WANTED, condition("spatter", chosen=chosen))
    assert len(reports.ends) == 4 and len(process.stdout.split()) == 4
    numbers = chosen.keep([f"x.glb/{n}" for n in range(12)])
    assert sorted(reports.ends) == sorted(f"x/{n}" for n in numbers)
    assert len(run_loop(tmp_path / "all", WANTED)[1].ends) == 12


@pytest.mark.parametrize("workers", [1, 5])
def test_wanted_does_not_depend_on_the_number_of_workers(tmp_path, workers):
    # on a busy machine, one worker may ask later than the others
    chosen = Subset(2, tmp_path, settled=0.3 if workers == 1 else 1.5)
    code = (
        f"for n in range({workers}):\n    if os.fork() == 0:\n"
        f"        pairs = [('x.glb', n) for n in range(20)][n::{workers}]\n"
        "        for scene, name in mitigate_hook.wanted(pairs):\n"
        "            episode = mitigate_hook.connect(name, scene=scene)\n"
        "            episode.corrupt({'rgb': rgb})\n            episode.finish(success=1)\n"
        f"        os._exit(0)\nfor n in range({workers}): os.wait()"
    )
    _, reports = run_loop(tmp_path, code, condition("spatter", chosen=chosen))
    places = sorted(range(20), key=lambda n: hash_episode(f"x.glb/{n}"))
    assert sorted(reports.ends) == sorted(f"x/{n}" for n in places[:2])


def test_corrupt_does_not_depend_on_the_order_of_entries(tmp_path):
    code = (
        "import hashlib\nfor order in (('rgb_b', 'rgb_a'), ('rgb_a', 'rgb_b')):\n"
        "    episode, frames = mitigate_hook.connect('a'), {'rgb_a': rgb, 'rgb_b': rgb[:8]}\n"
        "    seen = episode.corrupt({name: frames[name] for name in order})\n"
        "    print(*[hashlib.md5(seen[n].tobytes()).hexdigest() for n in ('rgb_a', 'rgb_b')])"
    )
    process, _ = run_loop(tmp_path, code)
    first, second = process.stdout.splitlines()
    assert first == second and first.split()[0] != first.split()[1]


def test_rows_count_an_unreachable_goal_as_failure(tmp_path):
    code = (
        "for name, metres in (('a', 1.0), ('b', numpy.inf)):\n"
        "    episode = mitigate_hook.connect(name, instruction='go')\n"
        "    episode.corrupt({'rgb': rgb})\n"
        "    episode.finish(success=name == 'a', distance_to_goal=metres, path_length=metres)"
    )
    _, reports = run_loop(tmp_path, code)
    label = {"agent": "x", "name": "n", "split": "s", "seed": 0}
    result_rows = rows(reports, Corruption("spatter", 0.6), label, None)
    assert [row["success"] for row in result_rows if row["rule"] != OWN] == [1.0, 0.0]
    assert "distance_to_goal" not in result_rows[-1]


def test_connect_stops_if_no_episodes_were_chosen(tmp_path):
    chosen = Subset(2, tmp_path, settled=0.0)
    process, _ = run_loop(tmp_path, "mitigate_hook.connect('a')", condition(chosen=chosen))
    assert process.returncode == 97 and "mitigate_hook.wanted([(scene, id), ...])" in process.stdout


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ("{'depth': depth * 1000}", "Divide millimetres by 1000"),
        ("{'depth': depth}, cameras={'depth': {'normalize_depth': True}}", "as normalised"),
        ("{'depth': depth * 100}, cameras={'depth': {'min_depth': 0, 'max_depth': 400}}", ""),
        ("{'depth': depth * 100}, cameras={'depth': {'max_depth': 400}}", ""),
        ("{'depth': depth}, cameras={'depth': {'normalise_depth': True}}", "min_depth"),
        ("{'depth': depth * 0}", ""),
    ],
)
def test_corrupt_rejects_depth_outside_its_range(tmp_path, frame, words):
    process, reports = run_loop(
        tmp_path, f"mitigate_hook.connect('a').corrupt({frame})", condition()
    )
    assert process.returncode == (97 if words else 0), process.stdout
    assert words in "".join(reports.problems)


@pytest.mark.parametrize("name", [0, ("left", 1)])
def test_corrupt_rejects_a_camera_name_that_is_not_text(tmp_path, name):
    """JSON converts such a name to a string; without this check, the frame would stay clean."""
    frame = f"{{{name!r}: rgb}}, cameras={{{name!r}: {{'type': 'rgb'}}}}"
    process, reports = run_loop(tmp_path, f"mitigate_hook.connect('a').corrupt({frame})")
    assert process.returncode == 97 and "the name of a camera must be text" in "".join(
        reports.problems
    )


def test_corrupt_accepts_numpy_descriptions(tmp_path):
    of = "{'depth': {'max_depth': numpy.float32(5), 'orientation': numpy.zeros(3)}}"
    code = "met = mitigate_hook.connect('a')\n"
    steps = f"{code}for _ in range(3): met.corrupt({{'depth': depth}}, cameras={of})"
    process, reports = run_loop(tmp_path, steps, condition())
    assert process.returncode == 0 and len(reports.cameras) == 1, process.stdout
    of = "{'depth': {'max_depth': object()}}"
    process, _ = run_loop(
        tmp_path, f"{code}met.corrupt({{'depth': depth}}, cameras={of})", condition()
    )
    assert process.returncode == 97 and "must be numbers, text and lists" in process.stdout


def test_patch_names_a_missing_encoder_class(tmp_path, monkeypatch):
    (tmp_path / "their_encoder.py").write_text("class Encoder:\n    def forward(self): pass\n")
    monkeypatch.setenv(
        "MITIGATE_ADAPTERS",
        '{"module": "their_encoder", "class": "Wrong", "folder": "", "file": "", "path": ""}',
    )
    code = f"sys.path.insert(0, {str(tmp_path)!r}); mitigate_hook.install(); import their_encoder"
    process, _ = run_loop(tmp_path, code)
    assert "names the class Wrong of their_encoder" in process.stdout
    assert "it has Encoder" in process.stdout and sys.executable not in process.stdout
