"""Tests of programs without habitat-lab, of loops without Habitat, and of adapters in an agent's
encoder."""

import hashlib
import json
import sys

import numpy as np
import pytest
import torch
from torch import nn

from mitigate.agents.adapters import insert_adapters, save_adapters
from mitigate.bridge.results import OWN, read, rows
from mitigate.bridge.run import run as run_command
from mitigate.bridge.server import Listener
from mitigate.corruptions import Corruption, Key, corrupt
from mitigate.worlds.measures import RULES
from tests.encoders.test_token_adapters import shaken

from .conftest import condition, config, python

WMNAV = "import sys, WMNav_env; WMNav_env.WMNavEnv().run_experiment(sys.argv[1])"


def test_wmnav_is_corrupted_and_measured_without_a_lab(tmp_path):
    with Listener(condition("low_light"), tmp_path) as listener:
        result = python(listener, WMNAV, tmp_path / "seen.json")
    assert result.returncode == 0 and "went on" not in result.stdout, result.stdout
    seen = json.loads((tmp_path / "seen.json").read_text())
    assert len(seen) == 6
    assert all(colour[0] < 130 and colour[3] == 255 for colour, _ in seen)
    reports = read(tmp_path)
    assert sorted(reports.ends) == ["x0/0", "x0/1", "x1/2"]
    label = {"agent": "a", "name": "wmnav", "split": "s", "seed": 0}
    result_rows = rows(reports, Corruption("low_light", 0.6), label, None)
    own_rows = [row for row in result_rows if row["rule"] == OWN]
    assert [(row["success"], row["spl"]) for row in own_rows] == [(1.0, 0.75)] * 3
    common = {row["rule"] for row in result_rows} - {OWN}
    # only WMNav's rule applies, because the goals are category names
    assert common == {str(RULES["wmnav"])}


def test_wmnav_hears_the_corrupted_category(tmp_path):
    with Listener(condition("black_box", 0.2), tmp_path) as listener:
        python(listener, WMNAV, tmp_path / "seen.json")
    words = [object_ for _, object_ in json.loads((tmp_path / "seen.json").read_text())]
    assert all(word.endswith(" chair") and len(word) > 12 for word in words)


def test_habitat_sim_without_the_lab_requires_connect(tmp_path):
    code = "import habitat_sim; habitat_sim.Simulator().get_sensor_observations()"
    with Listener(condition("spatter"), tmp_path) as listener:
        result = python(listener, code)
    assert result.returncode == 97 and "mitigate_hook.connect(" in result.stdout


LOOP = """
import hashlib, json, sys, numpy, mitigate_hook
episode = mitigate_hook.connect("17", scene="a/x.glb", instruction="Go to the door.")
rgb = (numpy.arange(16 * 20 * 3) % 251).reshape(16, 20, 3).astype("uint8")
shown = [episode.corrupt({"rgb": rgb, "other": 5}, heading=0.3) for _ in range(2)]
assert list(shown[0]) == ["rgb", "other"] and shown[0]["other"] == 5
print(episode.instruction, *[hashlib.sha256(s["rgb"].tobytes()).hexdigest() for s in shown])
episode.finish(success=True, spl=0.5)
"""


def test_loop_needs_three_calls(tmp_path):
    with Listener(condition("low_light_noise"), tmp_path) as listener:
        result = python(listener, LOOP)
    assert result.returncode == 0, result.stdout
    rgb = (np.arange(16 * 20 * 3) % 251).reshape(16, 20, 3).astype("uint8")
    frames = [
        corrupt(rgb, "low_light_noise", 0.6, key=Key(0, "x.glb/17", n), heading=0.3)
        for n in range(2)
    ]
    expected = " ".join(hashlib.sha256(frame.tobytes()).hexdigest() for frame in frames)
    assert result.stdout.strip() == f"Go to the door. {expected}"
    assert read(tmp_path).ends["x/17"]["metrics"] == {"success": 1.0, "spl": 0.5}


BEGIN = "import numpy, mitigate_hook\nrgb = numpy.full((16, 16, 3), 90, 'uint8')\n"


@pytest.mark.parametrize(
    ("loop", "words"),
    [
        ("a = mitigate_hook.connect('a'); b = mitigate_hook.connect('b'); a.corrupt({'rgb': rgb})",
         "episode a ended when the next one began"),
        ("mitigate_hook.connect('a').corrupt({'rgb': rgb, 'left': rgb})",
         "the entry left of an observation may be a frame"),
        ("mitigate_hook.connect('a').corrupt({'rgb': rgb}, heading='north')",
         "a frame could not be corrupted"),
        ("mitigate_hook.connect('a').corrupt({'rgb': rgb}, cameras={'rgb': 5})", ""),
    ],
)  # fmt: skip
def test_loop_errors_let_no_clean_frame_through(tmp_path, loop, words):
    code = f"{BEGIN}try:\n    {loop}\nexcept AttributeError:\n    raise\nprint('went on')"
    with Listener(condition("spatter"), tmp_path) as listener:
        result = python(listener, code)
    assert result.returncode != 0 and words in result.stdout and "went on" not in result.stdout


def test_corrupt_accepts_a_numpy_heading_and_other_entries(tmp_path):
    code = BEGIN + (
        "seen = mitigate_hook.connect('a').corrupt({'rgb': rgb, 'left': rgb}, "
        "heading=numpy.float32(0.3), cameras={'left': {'type': 'other'}})\n"
        "print((seen['rgb'] != rgb).any(), (seen['left'] == rgb).all())"
    )
    with Listener(condition("spatter"), tmp_path) as listener:
        assert python(listener, code).stdout.strip() == "True True"


def test_reports_count_an_unfinished_episode(tmp_path):
    code = BEGIN + (
        "for name in 'ab':\n    episode = mitigate_hook.connect(name)\n"
        "    for _ in range(3): episode.corrupt({'rgb': rgb})\n"
        "episode.finish(success=1, spl=1.0)"
    )
    with Listener(condition("spatter"), tmp_path) as listener:
        python(listener, code)
    assert read(tmp_path).lost == ["a"] and list(read(tmp_path).ends) == ["b"]


def test_connect_raises_outside_a_run():
    from mitigate.bridge.hook import mitigate_hook

    with pytest.raises(RuntimeError, match="mitigate run"):
        mitigate_hook.connect("1")


ENCODER = """
import hashlib, sys, torch, mitigate_hook
from torch import nn
class Encoder(nn.Module):
    def __init__(self):
        super().__init__()
        self.model = nn.Sequential(nn.Conv2d(3, 8, 3), nn.ReLU(), nn.Conv2d(8, 8, 3))
    def forward(self, frames):
        return self.model(frames)
"""
PROGRAM = """
import sys, numpy, torch, mitigate_hook, their_encoder
encoder = their_encoder.Encoder().eval()
encoder.load_state_dict(torch.load(sys.argv[1], weights_only=True))
episode = mitigate_hook.connect("1")
rgb = episode.corrupt({"rgb": numpy.full((9, 9, 3), 90, "uint8")})["rgb"]
with torch.no_grad():
    features = encoder(torch.from_numpy(rgb).permute(2, 0, 1)[None] / 255)
torch.save(features, sys.argv[2])
episode.finish(success=1, spl=1.0)
"""


@pytest.mark.slow
def test_adapters_are_attached_to_an_encoder(tmp_path, monkeypatch):
    (tmp_path / "their_encoder.py").write_text(ENCODER)
    (tmp_path / "program.py").write_text(PROGRAM)
    torch.manual_seed(0)
    model = nn.Sequential(nn.Conv2d(3, 8, 3), nn.ReLU(), nn.Conv2d(8, 8, 3)).eval()
    torch.save({f"model.{n}": t for n, t in model.state_dict().items()}, tmp_path / "w.pt")
    frames = torch.full((1, 3, 9, 9), 90 / 255)
    with torch.no_grad():
        before = model(frames)
        insert_adapters(model, ["2"], run=lambda n: model(frames.expand(n, -1, -1, -1)))
        save_adapters(shaken(model), tmp_path / "adapters")
        expected = model(frames)
    monkeypatch.chdir(tmp_path)
    command = [sys.executable, "program.py", "w.pt", "{out}/features.pt"]

    def features(name, place):
        options = [f"out={tmp_path / name}", "conditions=[clean]"]
        options += [f"adapters={tmp_path / 'adapters'}:{place}"]
        run_command(config(*options), command)
        return torch.load(tmp_path / name / "conditions/clean/features.pt", weights_only=True)

    adapted = features("adapted", "their_encoder:Encoder.model")
    assert torch.equal(adapted, expected) and not torch.equal(adapted, before)
    with pytest.raises(ValueError, match="there is no visual: its modules there are model"):
        features("wrong", "their_encoder:Encoder.visual")
    with pytest.raises(ValueError, match="must be FOLDER:package.module:Class.attribute"):
        features("unclear", "Encoder")


@pytest.mark.slow
def test_adapters_that_do_not_fit_stop_an_agent_that_catches_errors(tmp_path, monkeypatch):
    call = "    features = encoder(torch.from_numpy(rgb).permute(2, 0, 1)[None] / 255)\n"
    assert call in PROGRAM
    again = f"    try:\n    {call}    except RuntimeError:\n    {call}"
    (tmp_path / "their_encoder.py").write_text(ENCODER)
    (tmp_path / "program.py").write_text(PROGRAM.replace(call, again))
    model = nn.Sequential(nn.Conv2d(3, 8, 3), nn.ReLU(), nn.Conv2d(8, 8, 3)).eval()
    torch.save({f"model.{n}": t for n, t in model.state_dict().items()}, tmp_path / "w.pt")
    frames = torch.full((1, 3, 9, 9), 90 / 255)
    insert_adapters(model, ["2"], run=lambda n: model(frames.expand(n, -1, -1, -1)))
    save_adapters(shaken(model), tmp_path / "adapters")
    monkeypatch.chdir(tmp_path)
    options = [f"out={tmp_path / 'out'}", "conditions=[clean]"]
    options += [f"adapters={tmp_path / 'adapters'}:their_encoder:Encoder.model.2"]
    command = [sys.executable, "program.py", "w.pt", "{out}/features.pt"]
    with pytest.raises(ValueError, match="the adapters do not fit Encoder"):
        run_command(config(*options), command)
