"""Tests that clean frames are unchanged, and that other frames are corrected and their holes
filled."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import torch

from mitigate.core import folders
from mitigate.core.observation import DEPTH, RGB, Observation
from mitigate.corruptions import CLEAN, Corruption, DepthSensor, Key, corrupt_observation
from mitigate.guards.frames import choices, ring
from mitigate.guards.frames.restorer import Restorer, load_restorer
from mitigate.guards.guard import Guarded, Guards
from mitigate.guards.opening import open_restorer
from mitigate.training.reports import restorer as report
from mitigate.worlds.world import Corrupted
from tests.guards.frames.conftest import opened

SHIPPED = Path(__file__).parents[3] / "checkpoints/restorer"
SHAPES = [(64, 64), (50, 70), (120, 160)]


def frames(sensor: str, *shape: int) -> np.ndarray:
    rng = np.random.default_rng(0)
    if sensor == RGB:
        return rng.integers(20, 230, (*shape, 3), np.uint8)
    return rng.uniform(0.5, 9.0, (*shape, 1)).astype(np.float32)


@pytest.mark.parametrize("sensor", [RGB, DEPTH])
def test_clean_frame_is_returned_as_the_same_object(untrained, sensor):
    opened(untrained, 1e9)
    frame = frames(sensor, 12, 64, 64)
    before = frame.copy()
    output = untrained({sensor: frame, "pose": "as it came"})
    assert output[sensor] is frame and output["pose"] == "as it came"
    assert np.array_equal(frame, before)


@pytest.mark.parametrize("sensor", [RGB, DEPTH])
@pytest.mark.parametrize("shape", SHAPES)
def test_untrained_restorer_hardly_changes_a_frame(untrained, sensor, shape):
    for full in (shape, (1, *shape), (3, *shape)):
        frame = frames(sensor, *full)
        output = untrained.restore(sensor, frame)
        assert output.shape == frame.shape and output.dtype == frame.dtype and output is not frame
        moved = np.abs(output.astype(float) - frame).mean()
        assert moved <= (3.0 if sensor == RGB else 0.1)


def wall(metres: float, hole: bool = False) -> np.ndarray:
    """Return depth of a wall with sensor noise of 2 cm; with ``hole``, 4 % of the pixels are
    missing."""
    noise = np.random.default_rng(0).normal(0, 0.02, (96, 96))
    output = (metres + noise).astype(np.float32)
    output[40:60, 40:60] *= not hole
    return output


@pytest.mark.filterwarnings("ignore:More than")
@pytest.mark.parametrize("metres", [9.0, 9.9, 11.0, 20.0])
@pytest.mark.parametrize("hole", [False, True])
def test_far_wall_gets_no_invented_obstacle(metres, hole):
    """Without the gate, the shipped network, which was trained in apartments, would predict a wall
    at 1.2 m."""
    frame = wall(metres, hole)
    assert load_restorer(SHIPPED).restore(DEPTH, frame) is frame


def test_near_wall_with_a_hole_is_filled():
    output = load_restorer(SHIPPED).restore(DEPTH, wall(3.0, hole=True))
    assert np.abs(output - 3).max() < 0.5


def test_depth_mostly_out_of_range_is_kept_with_a_warning(untrained):
    frame = wall(5.0)
    frame[:9] = 12.0  # 9.4 % of the frame, which is not enough for a warning
    assert untrained.restore(DEPTH, frame).max() <= 10
    frame[:10] = 12.0
    with pytest.warns(UserWarning, match="farther than 10 m"):
        assert untrained.restore(DEPTH, frame) is frame


def test_restorer_leaves_frames_without_a_reading(untrained):
    for nothing in (0.0, np.nan, np.inf):
        frame = np.full((40, 48), nothing, np.float32)
        assert untrained.restore(DEPTH, frame) is frame


def test_depth_may_lack_its_last_axis_and_gets_no_holes(untrained):
    frame = frames(DEPTH, 40, 48)[..., 0]
    frame[10:20, 10:20], frame[0, 0], frame[1, 1] = 0.0, np.nan, np.inf
    output = untrained.restore(DEPTH, frame)
    assert output.shape == (40, 48) and np.isfinite(output).all() and (output > 0).all()
    assert 0.5 < output[10:20, 10:20].mean() < 9.0


@pytest.mark.parametrize(
    ("sensor", "frame", "words"),
    [
        (RGB, np.zeros((8, 8, 3), np.float32), "uint8"),
        (DEPTH, np.zeros((8, 8, 1), np.uint16), "float32 in metres"),
        (DEPTH, np.full((8, 8), 2500, np.float32), "in millimetres"),
        (RGB, torch.zeros(8, 8, 3, dtype=torch.uint8), r"not Tensor: .*numpy\(\)"),
        (DEPTH, [[1.0]], "must be a numpy array, not list"),
        (RGB, None, "must be a numpy array, not NoneType"),
        (RGB, np.zeros((8, 8), np.uint8), r"\[H, W, 3\]"),
        (RGB, np.zeros((37, 8, 8, 3), np.uint8), "36 views"),
        ("sound", np.zeros(3), "rgb, depth, not for sound"),
    ],
)
def test_frames_of_another_form_are_refused(untrained, sensor, frame, words):
    with pytest.raises((TypeError, ValueError, KeyError), match=words):
        untrained.restore(sensor, frame)


def test_large_frame_keeps_its_detail():
    restorer = opened(Restorer([RGB], width=8, size=32).eval())
    net = restorer.nets[RGB]
    with torch.no_grad():
        net.net.head.bias.view(-1, 4)[:3] = np.log(2.0)  # sets every gain to 2
        net.net.head.bias.view(-1, 4)[6:] = -100.0  # nothing is lost
    frame = frames(RGB, 128, 128) // 2
    output = restorer.restore(RGB, frame)
    assert np.abs(output.astype(int) - 2 * frame.astype(int)).max() <= 1


@pytest.mark.parametrize("sensor", [RGB, DEPTH])
def test_lost_view_is_filled_from_its_neighbours(panorama, sensor):
    values = torch.from_numpy(panorama[sensor]).float().permute(0, 3, 1, 2)
    values = values / (255 if sensor == RGB else 10)
    trust = torch.ones_like(values[:, :1])
    trust[0] = 0
    other, sure = ring.from_neighbours(values, trust, sensor == DEPTH)
    seen = sure[0] > 0.9
    assert seen.float().mean() > 0.9
    error = ((other[0] - values[0]).abs() * seen).mean()
    assert error < (0.35 if sensor == RGB else 0.05) * (values[0] - values[0].mean()).abs().mean()


@pytest.mark.parametrize("sensor", [RGB, DEPTH])
def test_inconsistent_view_of_a_panorama_is_detected(panorama, sensor):
    values = torch.from_numpy(panorama[sensor]).float().permute(0, 3, 1, 2)
    values = (values / (255 if sensor == RGB else 10)).clamp(max=1)
    valid = torch.ones_like(values[:, :1])
    wrong = values.clone()
    wrong[3, :, 20:40, 20:40] = (wrong[3, :, 20:40, 20:40] + 0.5) % 1

    def outside(displayed):
        low, high, seen = ring.compared(displayed, valid, sensor == DEPTH)
        assert seen.mean() > 0.95
        return (low - displayed).clamp(min=0) + (displayed - high).clamp(min=0)

    before, after = outside(values), outside(wrong)
    assert before.mean() < (0.04 if sensor == RGB else 0.002)
    assert after[3, :, 22:38, 22:38].mean() > 0.25
    others = [v for v in range(12) if v != 3]
    assert after[others].mean() < before[others].mean() + 0.01


@pytest.mark.parametrize("sensor", [RGB, DEPTH])
def test_speck_in_one_view_is_removed_by_untrained_restorer(untrained, panorama, sensor):
    rng, clean = np.random.default_rng(0), panorama[sensor]
    specks = rng.random(clean.shape[:3]) < 0.05
    frames = clean.copy()
    frames[specks] = np.where(clean[specks] > clean.max() / 2, clean.max() * 0.02, clean.max())
    output = untrained.restore(sensor, frames)
    before, after = (np.abs(f.astype(float) - clean)[specks].mean() for f in (frames, output))
    assert after < 0.35 * before
    alone = untrained.restore(sensor, frames[4])
    assert np.abs(alone.astype(float) - frames[4])[specks[4]].mean() < 0.1 * before


def test_pixel_seen_by_one_view_is_not_compared():
    values, valid = torch.rand(12, 1, 16, 16), torch.zeros(12, 1, 16, 16)
    valid[5] = 1
    low, high, seen = ring.compared(values, valid, True)
    assert not seen[5].any() and torch.equal(low[5], values[5]) and torch.equal(high[5], values[5])
    assert seen[4].any() and seen[6].any()


def test_hole_takes_the_mean_around_it():
    values = torch.zeros(1, 1, 32, 32)
    values[..., 16:] = 1.0
    trust = torch.ones_like(values)
    trust[..., 10:20, 2:8] = trust[..., 10:20, 24:30] = 0
    filled = ring.from_around(torch.where(trust > 0, values, 0.5), trust)
    assert filled[0, 0, 15, 5] < 0.15 and filled[0, 0, 15, 27] > 0.85


def test_world_is_restored_when_its_frames_are_read(untrained, panorama):
    class Still:
        sensors: dict = {}
        reads = 0

        def reset(self, episode):
            def output():
                self.reads += 1
                return {RGB: panorama[RGB]}

            return Observation({"pose": panorama["pose"]}, output, (RGB,))

    class Episode:
        episode_id = "1"

    still = Still()
    met = Corrupted(still, Corruption("foreign_object", 0.6), 0)
    observed = Guarded(met, Guards([untrained])).reset(Episode())
    assert still.reads == 0 and observed["pose"] is panorama["pose"]
    assert not np.array_equal(observed[RGB], met.last[RGB]) and still.reads == 1
    assert np.array_equal(observed.clean[RGB], panorama[RGB])


# folders -----------------------------------------------------------------------------------------


def test_folder_reloads_the_same_restorer(untrained, tmp_path):
    opened(untrained, 0.25)
    untrained.save(tmp_path, half=True)
    loaded = load_restorer(tmp_path)
    assert loaded.hash == untrained.hash and loaded.nets[RGB].threshold == 0.25
    frame = frames(RGB, 12, 64, 64)
    opened(untrained), opened(loaded)
    assert np.array_equal(loaded.restore(RGB, frame), untrained.restore(RGB, frame))


def damaged_weights(folder: Path) -> None:
    file = folder / "model.safetensors"
    raw = bytearray(file.read_bytes())
    raw[-3] ^= 1
    file.write_bytes(bytes(raw))


def damaged_sum(folder: Path) -> None:
    (folder / "manifest.json").write_text("x")


def no_sum(folder: Path) -> None:
    (folder / "manifest.json").unlink()


def card_with(**changed):
    def change(folder: Path) -> None:
        card = json.loads((folder / "card.json").read_text())
        settings = {k: v for k, v in changed.items() if k in card["settings"]}
        card = {**card, **{k: v for k, v in changed.items() if k not in settings}}
        card["settings"] |= settings
        (folder / "card.json").write_text(json.dumps(card))
        folders.seal(folder, "restorer")

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (damaged_weights, "truncated or damaged"),
        (damaged_sum, "cannot be compared with its manifest .* Fetch the folder again"),
        (no_sum, "not listed in the manifest.json"),
        (card_with(hash="0" * 12), "do not match its card"),
        (card_with(width=1 << 30), "whole number from 4 to 128"),
        (card_with(width=16), "do not fit"),
        (card_with(far="many"), "far=.* must be metres"),
        (card_with(sensors=["rgb", "sound"]), "must name rgb, depth"),
        (card_with(format=1), "format 4"),
        (lambda folder: (folder / "card.json").unlink(), "card.json missing"),
    ],
)
def test_damaged_folder_is_rejected(untrained, tmp_path, change, words):
    untrained.save(tmp_path)
    change(tmp_path)
    with pytest.raises((ValueError, FileNotFoundError), match=words) as error:
        load_restorer(tmp_path)
    # the message must not advise deleting a file, because the folder needs all files
    assert "delete" not in str(error.value)


# shipped weights ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def shipped(tmp_path_factory):
    copied = tmp_path_factory.mktemp("shipped") / "restorer"
    shutil.copytree(SHIPPED, copied)
    return load_restorer(copied)


def test_restorer_of_a_missing_sensor_is_rejected(tmp_path):
    Restorer(sensors=[DEPTH], depth_width=4).save(tmp_path / "mine")
    with pytest.raises(ValueError, match="is for depth, but the world shows rgb, pose: omit"):
        open_restorer(str(tmp_path / "mine"), (RGB, "pose"))
    assert open_restorer(str(tmp_path / "mine"), (RGB, DEPTH)) is not None
    assert open_restorer(None, (RGB,)) is None


def test_single_sensor_gives_another_restorer(tmp_path):
    model = Restorer(width=4, depth_width=4)
    model.save(tmp_path / "mine")
    whole = open_restorer(str(tmp_path / "mine"))
    alone = open_restorer(f"{tmp_path / 'mine'}:rgb")
    assert list(alone.nets) == ["rgb"] and alone.hash not in (whole.hash, model.hash)
    depth = np.zeros((8, 8, 1), np.float32)
    rgb = np.zeros((8, 8, 3), np.uint8)
    assert alone({"rgb": rgb, "depth": depth})["depth"] is depth
    assert choices.label(f"{tmp_path / 'mine'}:rgb") == "mine-rgb"
    assert choices.label("runs/a/agent") == "a"
    with pytest.raises(ValueError, match="restores none|is for rgb"):
        open_restorer(f"{tmp_path / 'mine'}:rgb", ["depth"])
    Restorer(["depth"], depth_width=4).save(tmp_path / "depth")
    with pytest.raises(ValueError, match="for depth, not for rgb"):
        open_restorer(f"{tmp_path / 'depth'}:rgb")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--suite", "fulll"], "no suite 'fulll'. Did you mean full?"),
        (["--suite", "instructions"], "suite=instructions corrupts no frames of rgb, depth"),
        (["--split", "nowhere"], "no split 'nowhere'"),
    ],
)
def test_report_names_the_error_and_writes_nothing(tmp_path, options, words):
    with pytest.raises(ValueError, match=words):
        report.main([str(SHIPPED), "--out", str(tmp_path / "out"), *options])
    assert not [*tmp_path.iterdir()]


def test_restorer_report_rejects_a_count_below_one(tmp_path, capsys):
    with pytest.raises(SystemExit):
        report.main([str(SHIPPED), "--out", str(tmp_path / "out"), "--count", "0"])
    assert "--count" in capsys.readouterr().err and not [*tmp_path.iterdir()]


def test_shipped_restorer_keeps_a_clean_panorama(shipped, panorama):
    output = shipped(panorama)
    assert output[RGB] is panorama[RGB] and output[DEPTH] is panorama[DEPTH]


@pytest.mark.parametrize(
    ("name", "sensor", "left"),
    [
        ("foreign_object", RGB, 0.35),
        ("low_light_noise", RGB, 0.75),
        ("black_out", RGB, 0.4),
        ("missing_data", DEPTH, 0.25),
    ],
)
def test_shipped_restorer_removes_part_of_a_corruption(shipped, panorama, name, sensor, left):
    frames = corrupt_observation(panorama, Corruption(name, 0.6), Key(0, "test"))
    output = shipped(frames)
    errors = [np.abs(f[sensor].astype(float) - panorama[sensor]).mean() for f in (frames, output)]
    assert errors[1] < left * errors[0]
    other = DEPTH if sensor == RGB else RGB
    assert output[other] is panorama[other]


def test_clean_is_no_corruption_to_the_shipped_one(shipped, panorama):
    seen = corrupt_observation(panorama, CLEAN, Key(0, "test"))
    dark = corrupt_observation(panorama, Corruption("low_light", 0.8), Key(0, "test"))
    assert shipped.restore(RGB, seen[RGB]) is seen[RGB]
    assert shipped.restore(RGB, dark[RGB]) is not dark[RGB]


def test_report_corrupts_depth_up_to_the_world_range(panorama):
    near = {**panorama, DEPTH: np.minimum(panorama[DEPTH], 5.0)}
    lost = Corruption("missing_data", 1.0)
    far = [
        report.Instants([near], depth).corrupted(0, lost, 0)[DEPTH].max()
        for depth in (DepthSensor(z_max=5.0), DepthSensor())
    ]
    assert far == [5.0, 10.0]


@pytest.mark.parametrize("met", [[CLEAN], [CLEAN, Corruption("flare", 0.6)]])
def test_report_without_fitting_corruption_has_no_picture(tmp_path, panorama, met):
    """The restorer is for depth. If training used no depth corruption, the report has no
    picture."""
    only = opened(Restorer([DEPTH], depth_width=4).eval())
    report.write(only, report.Instants([panorama]), met, 0, tmp_path, "one")
    assert [path.name for path in tmp_path.iterdir()] == ["restoration.md"]
    assert "Clean" in (tmp_path / "restoration.md").read_text()
    met = [*met, Corruption("missing_data", 0.6)]
    report.write(only, report.Instants([panorama]), met, 0, tmp_path, "one")
    assert (tmp_path / "restoration.jpg").is_file()
