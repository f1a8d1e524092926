"""Tests that a hardened checkpoint reloads to the same outputs.

If the outputs differ, the folder is not written, or loading rejects it.
"""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from pathlib import Path

import pytest
import torch
import yaml
from omegaconf import DictConfig, OmegaConf
from safetensors.torch import save_file
from torch.export.pt2_archive._package import load_pt2

import mitigate
from mitigate.agents import adapters, building, loading
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import build, checkpoint, folders
from mitigate.core.files import sha256
from mitigate.core.observation import DEPTH, POSE, RGB, VIEWS
from mitigate.evaluation import rows
from mitigate.shipping import card as cards
from mitigate.shipping import export, export_command, programs

# one pytest worker exports for all workers
pytestmark = pytest.mark.xdist_group("export")

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/deployment.md"
SIZE = 64
ROWS = "ab" * 6  # the agent's hash in the rows of `whole`
TINY = {"width": 16, "planner": {"heads": 2, "text_layers": 1, "layers": 1}}
ADAPTERS = {
    "target_modules": [r"depth_encoder\.stages\.0"],
    "ring": [r"rgb_encoder\.stages\.2"],
    "gates": [r"rgb_encoder\.stem"],
}


def finished_run(folder: Path, agent: TopologicalAgent, settings: dict, **others) -> Path:
    """Write a run folder as `make train` does."""
    checkpoint.save_weights(agent, folder / "agent")
    node = {"_target_": loading.TARGET, **settings}
    cfg = {
        "name": "tiny",
        "severity": 0.6,
        "severity_depth": None,
        "seed": 3,
        "init": None,
        "agent": node,
        "env": {"size": SIZE},
        "stages": {"one": {"recipe": {"steps": 2}}},
        **others,
    }
    (folder / "config.yaml").write_text(yaml.safe_dump(cfg), encoding="utf-8")
    return folder


def a_row(agent: str, episode: int, corruption: str, success: float) -> dict:
    return {
        "agent": agent,
        "name": "x",
        "corruption": corruption,
        "split": "val_unseen",
        "severity": 0.0 if corruption == "clean" else 0.6,
        "episode_id": str(episode),
        "seed": 0,
        "suite": "1.1",
        "rule": "vln",
        "success": success,
        "spl": success,
    }


def observation() -> dict:
    rng = torch.Generator().manual_seed(5)
    rgb = torch.randint(0, 256, (VIEWS, SIZE, SIZE, 3), generator=rng).to(torch.uint8)
    depth = 4 * torch.rand(VIEWS, SIZE, SIZE, 1, generator=rng)
    pose = torch.zeros(3)
    return {RGB: rgb.numpy(), DEPTH: depth.numpy(), POSE: pose.numpy()}


def python(code: str, *arguments: object, cwd: Path = ROOT) -> str:
    """Return the output of ``code`` in a separate process."""
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


class StandIn(torch.nn.Module):
    """A simple network that replaces an agent's networks, because tracing those takes half a
    minute."""

    def __init__(self, names: tuple[str, ...]) -> None:
        super().__init__()
        self.names = names

    def forward(self, *inputs: torch.Tensor) -> tuple[torch.Tensor, ...]:
        return tuple(inputs[0].float() + number for number, _ in enumerate(self.names))


def stand_in_programs(agent: TopologicalAgent, size: int) -> dict:
    """Replacement for ``programs.export_programs``, which is slow and has separate tests."""
    value = programs.probe(agent, size)
    return {
        name: torch.export.export(
            StandIn(names),
            tuple(value[key] for key in programs.INPUTS[name]),
            dynamic_shapes=(programs.free_dimensions(name),),
        )
        for name, names in programs.OUTPUTS.items()
    }


def check_here(draft: Path, outputs: dict) -> None:
    """Replacement for ``export._reload`` that checks the agent in this process."""
    agent = loading.load_hardened(draft)
    again = programs.outputs(programs.networks(agent), programs.probe(agent, SIZE))
    assert programs.difference(outputs, again) <= export.RELOADED


def copy_programs(whole: Path, draft: Path) -> tuple[dict, dict]:
    """Replacement for ``export._programs`` that copies the programs of ``whole`` into a folder of
    adapters."""
    for name in (loading.PROGRAM, loading.INPUTS):
        shutil.copy(whole / name, draft)
    card = loading.read_card(whole)
    return {"checked": card["checked"], "latency_ms": card["latency_ms"]}, {}


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Path:
    """A folder with two exported agents, `whole` and `adapted`, and their runs. The programs are
    simple networks."""
    place = tmp_path_factory.mktemp("export")
    torch.manual_seed(0)
    agent = TopologicalAgent(**TINY)
    base = checkpoint.save_weights(deepcopy(agent).half(), place / "base")
    run = finished_run(place / "runs/whole", agent, TINY, init=str(base.parent))
    sha = checkpoint.weights_sha(agent)
    matches = [a_row(ROWS, e, c, float(e > 1)) for e in range(8) for c in ("clean", "spatter")]
    matches = [{**row, "weights": sha} for row in matches]
    rows.write(run / "rows.jsonl", [*matches, a_row("0123456789ab", 0, "clean", 0.0)])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(programs, "TIMED", 2)
        patch.setattr(programs, "export_programs", stand_in_programs)
        patch.setattr(export, "_reload", check_here)
        export.export(run, "whole", out=place / "hardened")

    agent = TopologicalAgent(**TINY)
    checkpoint.load_weights(agent, base)
    adapters.insert_adapters(agent, **ADAPTERS)
    for parameter in adapters.adapter_parameters(agent):
        torch.nn.init.normal_(parameter, std=0.05)
    settings = {**TINY, "adapters": ADAPTERS}
    finished_run(place / "runs/adapted", agent, settings, init=str(base.parent))
    whole = place / "hardened/whole"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "_programs", lambda draft, *_: copy_programs(whole, draft))
        patch.setattr(export, "_reload", lambda *_: None)
        export.export(place / "runs/adapted", "adapted", out=place / "hardened")
    return place


@pytest.fixture(scope="module")
def traced(place) -> Path:
    """The folder `whole` with real exported programs. The export takes half a minute."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(programs, "TIMED", 2)
        return export.export(place / "runs/whole", "whole", out=place / "traced")


@pytest.fixture(scope="module")
def exported(place) -> dict:
    """The exported programs of the agent `whole`. Simple networks replace the real programs."""
    return load_pt2(str(place / "hardened/whole/program.pt2")).exported_programs


@pytest.fixture
def copied(place, tmp_path) -> Path:
    """A copy of the folder `whole`, for tests that change files in it."""
    return Path(shutil.copytree(place / "hardened/whole", tmp_path / "whole"))


def resign(folder: Path, **changes) -> None:
    """Change entries of the card, and update the card's sha256 in the manifest."""
    card = json.loads((folder / "card.json").read_text())
    (folder / "card.json").write_text(json.dumps({**card, **changes}))
    folders.seal(folder, "hardened")


def relist(folder: Path, change) -> None:
    """Change the manifest's list."""
    manifest = json.loads((folder / folders.MANIFEST).read_text())
    change(manifest["files"])
    (folder / folders.MANIFEST).write_text(json.dumps(manifest))


def node_of(settings: dict) -> DictConfig:
    """Return the config of a topological agent with ``settings``."""
    return OmegaConf.create({"_target_": loading.TARGET, **settings})


def test_card_describes_the_agent_and_lists_every_file(place):
    folder = place / "hardened/whole"
    card = loading.check_hardened(folder)
    assert card["recipe"] == "tiny" and card["seed"] == 3 and card["license"] == "Apache-2.0"
    assert card["base"]["sha256"] == sha256(place / "base/model.safetensors")
    listed = folders.check(folder).files
    assert listed.keys() | {folders.MANIFEST} == {p.name for p in folder.iterdir()}
    (entry,) = card["metrics"]
    assert entry["episodes"] == 8 and entry["clean"]["SR"][0] == 0.75
    assert entry["clean"]["SR"][1] < 0.75 < entry["clean"]["SR"][2]
    assert entry["PRS"]["PRS-SR (RGB, 1 of 8)"][0] == 1.0  # spatter alone
    text = (folder / "README.md").read_text()
    before, after = card["run_agent"], card["agent"]
    assert card["rows_agent"] == [ROWS] and before != after  # rounded to float16
    assert f"weights is `{after}` (`{before}` before rounding)." in text
    assert f"Result rows name this agent `{ROWS}`." in text
    assert "Clean SR | 0.750 [" in text and "spatter" in text.lower()
    assert f'mitigate.load_hardened("{folder}")' in text
    for kind in ("eager", "exported"):
        for name in ("perceive", "decide"):
            assert card["latency_ms"][kind][name]["cpu"] > 0
    assert sha256(folder / "model.safetensors") == listed["model.safetensors"].sha256
    tensors = (folder / "model.safetensors").stat().st_size
    assert tensors < 0.6 * (place / "runs/whole/agent/model.safetensors").stat().st_size


@pytest.mark.parametrize("name", ["whole", "adapted"])
def test_loaded_agent_acts_as_the_trained_one(place, name):
    trained = loading.build_from(place / "runs" / name / "config.yaml").eval()
    checkpoint.load_weights(trained, place / "runs" / name / "agent")
    state = torch.random.get_rng_state()
    loaded = mitigate.load_hardened(place / "hardened" / name)
    assert torch.equal(state, torch.random.get_rng_state()) and not loaded.training
    probe = programs.probe(trained, SIZE)
    one, two = (programs.outputs(programs.networks(a), probe) for a in (trained, loaded))
    gap = programs.difference(one, two)
    assert gap == 0.0 if name == "adapted" else 0.0 < gap < 0.05  # float16
    actions = []
    for agent in (trained, loaded):
        agent.reset("walk past the red sofa and stop by the table")
        actions.append(agent.act(observation()))
    assert actions[0] == actions[1] and actions[0] in range(4)


def test_adapter_folder_holds_no_backbone_and_needs_its_base(place, tmp_path):
    folder = place / "hardened/adapted"
    assert loading.check_hardened(folder)["adapters_only"]
    assert not (folder / "model.safetensors").exists()
    other = checkpoint.save_weights(TopologicalAgent(**TINY), tmp_path / "other")
    with pytest.raises(ValueError, match="has a different one"):
        loading.load_hardened(folder, base=other)
    with pytest.raises(FileNotFoundError, match="base="):
        loading.load_hardened(folder, base=tmp_path / "nothing")
    assert adapters.adapted(loading.load_hardened(folder, base=place / "base"))


def test_evaluation_and_training_take_a_folder_of_adapters(place):
    folder = str(place / "hardened/adapted")
    node = building.settings_of(node_of({}), folder)
    agent = building.build_agent(node, weights=folder, seed=0)
    assert checkpoint.weights_sha(agent) == loading.check_hardened(Path(folder))["run_agent"]
    with pytest.raises(ValueError, match="but names others"):
        building.build_agent(node_of(TINY), weights=folder, seed=0)


@pytest.mark.slow
def test_loading_needs_neither_hydra_nor_the_simulator(place, tmp_path):
    code = """
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in sys.argv[3:]:
            raise ImportError(name + " is not here")
sys.meta_path.insert(0, Absent())
import mitigate
assert "torch" not in sys.modules
for folder in sys.argv[1:3]:
    agent = mitigate.load_hardened(folder)
    agent.reset("turn left")
    print(type(agent).__name__)
"""
    absent = ("panda3d", "direct", "hydra", "omegaconf", "torchrl", "tensordict", "cv2")
    folders = (place / "hardened" / name for name in ("whole", "adapted"))
    assert python(code, *folders, *absent, cwd=tmp_path).split() == 2 * ["TopologicalAgent"]


@pytest.mark.slow
def test_program_runs_a_decision_without_this_package(traced, tmp_path):
    code = """
import json, sys
import numpy, torch
from torch.export.pt2_archive._package import load_pt2
folder, given = sys.argv[1:]
inputs = json.load(open(folder + "/program.json"))["programs"]
programs = load_pt2(folder + "/program.pt2").exported_programs
given = {k: torch.from_numpy(v) for k, v in numpy.load(given).items()}
with torch.no_grad():
    frames = [given[name][:1] for name in inputs["perceive"]["inputs"]]
    views, waypoints = programs["perceive"].module()(*frames)
    given["views"] = views
    (logits,) = programs["decide"].module()(*(given[name] for name in inputs["decide"]["inputs"]))
assert not any(name.split(".")[0] in ("mitigate", "recipes") for name in sys.modules)
print(json.dumps([waypoints.sum().item(), logits[0].tolist()]))
"""
    import numpy as np

    agent = loading.load_hardened(traced)
    value = programs.probe(agent, SIZE)
    first = {  # inputs of the first decision in an episode: one panorama, one node, two ghosts
        **{name: value[name][:1] for name in ("rgb", "depth", "tokens", "episode")},
        "panorama": torch.tensor([0]),
        "nodes": torch.tensor([[0]]),
        "sightings": torch.tensor([[[3, -1, -1, -1], [7, 8, -1, -1]]]),
        "geometry": value["geometry"][:1, :4],
        "valid": torch.ones(1, 4, dtype=torch.bool),
        "allowed": torch.tensor([[True, False, True, True]]),
    }
    np.savez(tmp_path / "given.npz", **{name: t.numpy() for name, t in first.items()})
    printed = python(code, traced, tmp_path / "given.npz", cwd=tmp_path)
    waypoints, logits = json.loads(printed)
    expected = programs.outputs(programs.networks(agent), first)
    assert waypoints == pytest.approx(expected["waypoints"].sum().item(), abs=1e-2)
    assert logits == pytest.approx(expected["logits"][0].tolist(), abs=1e-4)


@pytest.mark.parametrize(
    "name", ["model.safetensors", "program.pt2", "config.yaml", "README.md", "program.json"]
)
@pytest.mark.parametrize("spoil", ["flipped", "truncated", "removed"])
def test_changed_file_is_rejected_by_name(copied, name, spoil):
    file = copied / name
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 1
    if spoil == "removed":
        file.unlink()
    else:
        file.write_bytes(data if spoil == "flipped" else data[: len(data) // 2])
    if (name, spoil) == ("program.pt2", "removed"):
        loading.load_hardened(copied)  # nothing reads it
        return
    error = FileNotFoundError if spoil == "removed" else ValueError
    with pytest.raises(error, match=name.replace(".", r"\.")):
        loading.load_hardened(copied)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (lambda t: t[: len(t) // 2], "truncated or damaged"),
        (lambda t: t.replace('"seed": 3', '"seed": 4'), "sha256"),
        (lambda t: "[]", "must hold a JSON object"),
        (lambda t: "[" * 100_000, "card.json"),
        (lambda t: t.replace('"format": 2', '"format": 3'), "format 2"),
    ],
)
def test_changed_card_is_rejected(copied, text, problem):
    card = copied / "card.json"
    card.write_text(text(card.read_text()))
    with pytest.raises(ValueError, match=problem):
        loading.load_hardened(copied)


def test_folder_without_a_card_is_rejected(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"card\.json is missing"):
        loading.load_hardened(tmp_path)


def test_folder_without_a_manifest_is_rejected(copied):
    (copied / folders.MANIFEST).unlink()
    with pytest.raises(FileNotFoundError, match=r"manifest\.json is missing"):
        mitigate.load(copied)


@pytest.mark.parametrize("name", ["model.safetensors", "program.pt2", "config.yaml"])
def test_card_that_lacks_a_file_is_rejected(copied, name):
    relist(copied, lambda files: files.pop(name))
    part = "not listed in" if name == "program.pt2" else f"must list {name}"
    with pytest.raises(ValueError, match=part):
        loading.load_hardened(copied)


@pytest.mark.parametrize("name", ["../outside", "/etc/hostname", "..", "a/b"])
def test_card_names_no_file_outside_its_folder(copied, name):
    relist(copied, lambda files: files.update({name: files["config.yaml"]}))
    with pytest.raises(ValueError, match="not a plain file name"):
        loading.load_hardened(copied)


def test_config_is_data_and_names_no_other_class(copied):
    config = yaml.safe_load((copied / "config.yaml").read_text())
    config["agent"]["_target_"] = "os.system"
    (copied / "config.yaml").write_text(yaml.safe_dump(config))
    folders.seal(copied, "hardened")
    with pytest.raises(ValueError, match=r"os\.system"):
        loading.load_hardened(copied)


def test_other_vocabulary_is_rejected(copied):
    resign(copied, vocabulary="000000000000")
    with pytest.raises(ValueError, match="vocabulary"):
        loading.load_hardened(copied)


@pytest.mark.parametrize("name", ["adapters.safetensors", "adapters.json", "decide.onnx"])
def test_known_file_missing_from_the_card_is_rejected(copied, name):
    (copied / name).write_bytes(b"x")
    (copied / ".gitattributes").touch()  # the Hugging Face hub adds this file
    for read in (
        lambda: loading.load_hardened(copied),
        lambda: loading.fill(TopologicalAgent(**TINY), copied),
    ):
        with pytest.raises(ValueError, match=f"{re.escape(name)} is not listed"):
            read()


def test_adapters_missing_from_the_card_are_ignored(place, copied):
    """A folder has full weights according to its card, and also contains adapters that the card
    does not list."""
    resign(copied, base=None)
    for name in (adapters.WEIGHTS, adapters.SETTINGS):
        shutil.copy(place / "hardened/adapted" / name, copied)
    assert loading.adapters_only(place / "hardened/adapted")
    assert not loading.adapters_only(copied)
    assert cards.reference(str(copied))["sha256"] == sha256(copied / checkpoint.WEIGHTS)
    with pytest.raises(ValueError, match="not listed"):
        building.build_agent(node_of(TINY), weights=str(copied), seed=0)


def test_evaluation_and_training_refuse_a_changed_folder(copied):
    assert building.build_agent(node_of(TINY), weights=str(copied), seed=0)
    with pytest.raises(ValueError, match="another kind .hardened, not weights"):
        checkpoint.save_weights(TopologicalAgent(**TINY), copied)
    checkpoint.write_tensors(TopologicalAgent(**TINY), copied / checkpoint.WEIGHTS)
    with pytest.raises(ValueError, match="does not have the sha256"):
        building.build_agent(node_of(TINY), weights=str(copied), seed=0)


def test_folder_of_another_agent_than_its_card_is_rejected(copied):
    resign(copied, agent="0123456789ab")
    with pytest.raises(ValueError, match="'0123456789ab'"):
        loading.load_hardened(copied)
    own_value = TopologicalAgent(**TINY).eval()
    # ``fill`` does not compare the hash of the agent, because adapters may have been trained
    loading.fill(own_value, copied)


@pytest.mark.parametrize(
    "name", ["n" * 5000, "a\ud800", "a\nb"], ids=["long", "surrogate", "lines"]
)
def test_card_lists_only_valid_file_names(copied, name):
    relist(copied, lambda files: files.update({name: files["config.yaml"]}))
    with pytest.raises(ValueError, match="not a plain file name") as caught:
        loading.load_hardened(copied)
    assert str(caught.value).isprintable() and len(str(caught.value)) < 500


@pytest.mark.parametrize(
    "path", ["n" * 300, "a/" * 3000, "a\ud800"], ids=["long name", "long path", "surrogate"]
)
def test_card_names_only_a_valid_base(place, tmp_path, path):
    folder = Path(shutil.copytree(place / "hardened/adapted", tmp_path / "adapted"))
    resign(folder, base={"weights": path, "sha256": "0" * 64})
    with pytest.raises(ValueError, match="does not name the base of its adapters"):
        loading.load_hardened(folder)


def test_unfinished_run_names_what_is_missing(tmp_path):
    with pytest.raises(FileNotFoundError, match="no finished run"):
        export.export(tmp_path, "mine", out=tmp_path / "hardened")


def test_agent_folder_of_a_run_names_the_run(place, tmp_path):
    run = place / "runs/whole"
    with pytest.raises(FileNotFoundError, match=f"Name the run: {re.escape(str(run))}"):
        export.export(run / "agent", "mine", out=tmp_path)


@pytest.mark.parametrize(
    ("target", "page"),
    [
        ("mitigate.encoders.model.Encoder", "docs/encoder.md"),
        ("mitigate.guards.frames.restorer.Restorer", "docs/restoration.md"),
        ("mitigate.guards.text.language_models.model.LanguageModel", "docs/safeguard.md"),
    ],
)
@pytest.mark.parametrize("named", ["run", "run/agent"])
def test_agent_shipped_unchanged_needs_no_export(tmp_path, target, page, named):
    assert (ROOT / page).is_file() and build.locate(target)
    (tmp_path / "run/agent").mkdir(parents=True)
    for config in ("run/config.yaml", "run/agent/config.yaml"):
        (tmp_path / config).write_text(yaml.safe_dump({"agent": {"_target_": target}}))
    with pytest.raises(ValueError, match=rf"run/agent directly, as {page}"):
        export.export(tmp_path / named, "mine", out=tmp_path / "out")


def test_existing_name_stays_without_overwrite(copied, place, monkeypatch):
    run, out = place / "runs/whole", copied.parent
    with pytest.raises(ValueError, match="--overwrite"):
        export.export(run, "whole", out=out)
    monkeypatch.setattr(export, "_write", lambda draft, *_: (draft / "new").touch())
    export.export(run, "whole", out=out, overwrite=True)
    assert [p.name for p in copied.iterdir()] == ["new"]
    assert [p.name for p in out.iterdir()] == ["whole"]


@pytest.mark.parametrize("kind", ["folder", "foreign card", "file", "link", "link to nothing"])
def test_overwrite_replaces_nothing_but_a_hardened_folder(place, copied, tmp_path, kind):
    target = tmp_path / "mine"
    if kind in ("folder", "foreign card"):
        target.mkdir()
        (target / "thesis.tex").write_text("years of work")
        (target / "card.json").write_text('{"format": 4}' if kind == "foreign card" else "")
    elif kind == "file":
        target.write_text("years of work")
    else:
        target.symlink_to(copied if kind == "link" else tmp_path / "nowhere")
    before = sorted(p.name for p in tmp_path.rglob("*"))
    with pytest.raises(ValueError, match="was not replaced"):
        export.export(place / "runs/whole", "mine", out=tmp_path, overwrite=True)
    assert sorted(p.name for p in tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", ["../mine", "", ".hidden", "a/b"])
def test_name_is_one_folder(place, tmp_path, name):
    with pytest.raises(ValueError, match="name of the folder must"):
        export.export(place / "runs/whole", name, out=tmp_path)


def test_export_writes_nothing_if_reload_differs(place, exported, tmp_path, monkeypatch):
    monkeypatch.setattr(programs, "export_programs", lambda *_: exported)
    monkeypatch.setattr(programs, "TIMED", 1)
    monkeypatch.setattr(export, "_RUN", "raise ValueError('differs')")
    with pytest.raises(ValueError, match="differs"):
        export.export(place / "runs/whole", "mine", out=tmp_path)
    assert not list(tmp_path.iterdir())


def test_check_detects_other_outputs(place, tmp_path):
    """The check passes with equal outputs, because the fixture ``place`` exports with it."""
    agent = loading.load_hardened(place / "hardened/whole")
    expected = programs.outputs(programs.networks(agent), programs.probe(agent, SIZE))
    expected["logits"] = expected["logits"] + 0.01
    save_file({k: v.contiguous() for k, v in expected.items()}, tmp_path / "other.safetensors")
    with pytest.raises(ValueError, match="agent differs by 0.01"):
        export.check_outputs(str(place / "hardened/whole"), str(tmp_path / "other.safetensors"))


@pytest.mark.slow
@pytest.mark.parametrize("fusion", [{"rate": 4.0, "cap": 3.0}, {"learned": True}], ids=str)
def test_programs_weigh_views_as_the_agent_does(fusion):
    agent = TopologicalAgent(**{**TINY, "planner": {**TINY["planner"], "fusion": fusion}}).eval()
    output = {name: p.module() for name, p in programs.export_programs(agent, SIZE).items()}
    value = programs.probe(agent, SIZE)
    expected = programs.outputs(programs.networks(agent), value)
    assert programs.difference(expected, programs.outputs(output, value)) < 1e-5


def test_rows_of_another_agent_are_not_metrics(place, tmp_path):
    rows.write(tmp_path / "rows.jsonl", [a_row("0123456789ab", 0, "clean", 1.0)])
    with pytest.raises(ValueError, match="not to this agent"):
        export.export(
            place / "runs/whole", "mine", out=tmp_path / "out", rows=[tmp_path / "rows.jsonl"]
        )


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("name", 5),
        ("name", "a`b"),
        ("name", "a\nb"),
        ("severity", "high"),
        ("severity", None),
        ("severity", []),
        ("severity_depth", [0.3, "1"]),
        ("seed", "<b>"),
        ("schedule", "per_frame"),
        ("stages", [1]),
        ("stages", {"one": "two"}),
    ],
)
def test_unknown_config_entry_is_named_by_its_key(key, value):
    cfg = {"name": "tiny", "severity": 0.6, "severity_depth": None, "seed": 3} | {key: value}
    with pytest.raises(ValueError, match=rf"config\.yaml has {key}="):
        cards.facts(cfg, None)


def test_commit_is_of_this_checkout_or_not_stated(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert cards.commit() is None  # no git
    monkeypatch.undo()
    monkeypatch.setattr(cards, "ROOT", tmp_path)
    # no commit is named if the package is installed inside the repository of another project
    assert cards.commit() is None


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Limit the size of files that this process writes to ``size`` bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("full", ["weights", "programs"])
def test_full_disk_is_reported_and_leaves_nothing(
    place, exported, tmp_path, monkeypatch, capfd, full
):
    """An error is reported if the weights or the programs do not fit on the disk."""
    weights = (place / "hardened/whole" / checkpoint.WEIGHTS).stat().st_size
    most = weights // 2 if full == "weights" else weights + 1000
    command = ["export", str(place / "runs/whole"), "mine", "--out", str(tmp_path)]
    monkeypatch.setattr(programs, "TIMED", 2)
    monkeypatch.setattr(programs, "export_programs", lambda *_: exported)
    monkeypatch.setattr(programs, "package_pt2", lambda file, **_: file.write(bytes(2 * weights)))
    monkeypatch.setattr("sys.argv", command)
    with files_of_at_most(most), pytest.raises(SystemExit, match="File too large"):
        export_command.main()
    assert "frame #" not in "".join(capfd.readouterr())
    assert not [*tmp_path.iterdir()]


def git(folder, *words):
    named = ["-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", *named, *words], cwd=folder, check=True, capture_output=True)


@pytest.mark.parametrize("change", ["mitigate/agent.py", "conf/new.yaml"])
def test_card_states_uncommitted_changes(monkeypatch, tmp_path, change):
    (tmp_path / "mitigate").mkdir()
    (tmp_path / "conf").mkdir()
    (tmp_path / "mitigate/agent.py").write_text("a = 1\n")
    monkeypatch.setattr(cards, "ROOT", tmp_path)
    assert not cards.uncommitted()  # no checkout
    git(tmp_path, "init")
    assert cards.commit() is None  # no commit yet
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-m", "first")
    (tmp_path / "checkpoints").mkdir()
    (tmp_path / "checkpoints/mine").write_text("exported before")
    assert not cards.uncommitted()
    (tmp_path / change).write_text("a = 2\n")
    assert cards.uncommitted()
    monkeypatch.setenv("PATH", "")
    assert cards.commit() is None and not cards.uncommitted()


def test_readme_states_what_is_known_of_the_commit(place):
    card = loading.read_card(place / "hardened/whole")
    end = f"Exported at commit `{card['commit']}`"
    assert "uncommitted" in card

    def text_of(card: dict) -> str:
        return cards.readme(card, "hardened/whole")

    assert f"{end}." in text_of(card | {"uncommitted": False})
    assert f"{end}, with uncommitted changes." in text_of(card | {"uncommitted": True})
    assert f"{end}." in text_of({n: v for n, v in card.items() if n != "uncommitted"})
    assert "commit" not in text_of(card | {"commit": None}).partition("## ")[0]


def test_missing_teacher_is_reported(place, tmp_path):
    agent = loading.load_hardened(place / "hardened/whole")
    stages = {"one": {"recipe": {"teacher": "checkpoints/nobody"}}}
    run = finished_run(tmp_path / "run", agent, TINY, stages=stages)
    with pytest.raises(FileNotFoundError, match="checkpoints/nobody"):
        export.export(run, "mine", out=tmp_path / "out")


def test_onnx_files_do_what_the_agent_does(place, tmp_path):
    for package in ("onnx", "onnxscript", "onnxruntime"):
        pytest.importorskip(package, reason="the extra onnx is not installed")
    from mitigate.shipping.programs import check_onnx, save_onnx

    agent = loading.load_hardened(place / "hardened/adapted")
    save_onnx(agent, SIZE, tmp_path, export.EXPORTED)
    assert {file.name for file in tmp_path.iterdir()} == {"perceive.onnx", "decide.onnx"}
    with pytest.raises(ValueError, match="differ from the agent"):
        check_onnx(tmp_path, agent, SIZE, -1.0)


@pytest.mark.slow
def test_deployment_page_examples_run(traced, tmp_path, monkeypatch):
    examples = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(examples) == 3
    (tmp_path / "checkpoints/hardened").mkdir(parents=True)
    shutil.copytree(traced, tmp_path / "checkpoints/hardened/ts_distill")
    monkeypatch.chdir(tmp_path)
    encoder = torch.nn.Sequential(torch.nn.Conv2d(3, 8, 3), torch.nn.BatchNorm2d(8)).eval()
    images = torch.rand(2, 3, 8, 8)
    plain = encoder(images)
    adapters.insert_adapters(encoder, ["1"])
    for parameter in adapters.adapter_parameters(encoder):
        torch.nn.init.ones_(parameter)
    adapters.save_adapters(encoder, "my_adapters")
    adapters.remove_adapters(encoder)
    names = {"observation": observation(), "encoder": encoder, "images": images}
    for example in examples:
        exec(compile(example, str(PAGE), "exec"), names)
    assert names["action"] in range(4) and names["logits"].shape == (1, 3)
    assert names["logits"].isfinite().tolist() == [[True, False, True]]
    assert not torch.equal(names["features"], plain) and torch.equal(encoder(images), plain)


def places_in(file: Path) -> list[str]:
    """Return the paths of the checkout and of the Python environment that occur in ``file``."""
    parts = [file.read_bytes()]
    if file.suffix == ".pt2":
        with zipfile.ZipFile(file) as archive:
            parts = [archive.read(part) for part in archive.namelist()]
    return [x for x in (str(ROOT), sys.prefix) if any(x.encode() in part for part in parts)]


@pytest.mark.parametrize("name", ["whole", "adapted"])
def test_export_writes_no_path_of_this_machine(place, name):
    for file in (place / "hardened" / name).iterdir():
        if file.name != loading.PROGRAM:
            assert places_in(file) == [], file.name


@pytest.mark.slow
def test_programs_hold_no_path_of_this_machine(traced):
    """The stack traces in exported programs once contained paths of the checkout."""
    assert places_in(traced / loading.PROGRAM) == []


@pytest.mark.slow
def test_export_compares_the_programs_in_a_new_process(traced):
    card = loading.read_card(traced)
    assert card["checked"]["program_tolerance"] == export.EXPORTED
    agent = loading.load_hardened(traced)
    value = programs.probe(agent, SIZE)
    program = programs.load_programs(traced / loading.PROGRAM)
    expected = programs.outputs(programs.networks(agent), value)
    assert programs.difference(expected, programs.outputs(program, value)) <= export.EXPORTED


SHIPPED = sorted(p.name for p in (ROOT / "checkpoints/hardened").glob("[!.]*"))


@pytest.mark.parametrize("name", SHIPPED)
def test_load_hardened_loads_a_shipped_folder_without_its_program(name):
    folder = ROOT / "checkpoints/hardened" / name
    assert not (folder / loading.PROGRAM).exists(), "the tree holds no programs"
    assert loading.load_hardened(folder).vocabulary


@pytest.mark.slow
@pytest.mark.parametrize("name", ["harden", "ts_distill"])  # adapters, and all weights
def test_export_writes_the_program_of_a_shipped_folder(name, tmp_path, monkeypatch, capsys):
    folder = tmp_path / name
    shutil.copytree(ROOT / "checkpoints/hardened" / name, folder)
    before = loading.read_card(folder)
    monkeypatch.setattr(sys, "argv", ["export", str(folder), "--programs"])
    export_command.main()
    assert f"wrote {folder / loading.PROGRAM}" in capsys.readouterr().out
    agent = loading.load_hardened(folder, base=base_of(before))
    card = loading.read_card(folder)
    assert card["agent"] == before["agent"]
    assert loading.PROGRAM in folders.check(folder).files
    value = programs.probe(agent, SIZE)
    program = programs.load_programs(folder / loading.PROGRAM)
    expected = programs.outputs(programs.networks(agent), value)
    assert programs.difference(expected, programs.outputs(program, value)) <= export.EXPORTED


def base_of(card):
    return ROOT / card["base"]["weights"] if card["adapters_only"] else None


def test_export_takes_no_name_with_programs(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["export", "runs/a", "mine", "--programs"])
    with pytest.raises(SystemExit):
        export_command.main()
    assert "--programs takes one hardened folder" in capsys.readouterr().err


def test_hardened_agents_of_the_readme_are_shipped():
    assert {"conv_adapter", "stacked", "ts_distill"} <= set(SHIPPED)
