"""Tests of pairs of corruptions: their order, random numbers, and options that accept them."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core import conf
from mitigate.corruptions import (
    CLEAN,
    Corruption,
    Key,
    Schedule,
    corrupt,
    corrupt_normalised,
    corrupt_observation,
    registry,
)
from mitigate.corruptions.folders import Settings
from mitigate.evaluation import evaluate
from mitigate.worlds.habitat import corrupt_habitat

KEY = Key(3, "episode-7", 4)


def test_pair_of_two_sensors_corrupts_each_separately(panorama):
    obs = {"rgb": panorama[0], "depth": panorama[1], "pose": np.array([0, 0, 0.4])}
    both = corrupt_observation(obs, Corruption("flare+missing_data", 0.6), KEY)
    for name, entry in (("flare", "rgb"), ("missing_data", "depth")):
        alone = corrupt_observation(obs, Corruption(name, 0.6), KEY)
        assert both[entry].tobytes() == alone[entry].tobytes()
    assert both["pose"] is obs["pose"]


def test_pair_of_one_sensor_applies_the_first_first(panorama):
    obs = {"rgb": panorama[0]}
    output = corrupt_observation(obs, Corruption("overexposure+spatter", 0.6), KEY)["rgb"]
    bright = corrupt(panorama[0], "overexposure", 0.6, key=KEY)
    assert (output == corrupt(bright, "spatter", 0.6, key=KEY)).all()
    other = corrupt_observation(obs, Corruption("spatter+overexposure", 0.6), KEY)["rgb"]
    assert (output != other).any()


def test_pair_lists_its_parts():
    pair = Corruption("low_light+missing_data", 0.6)
    assert [(part.name, part.severity) for part in pair.parts] == [
        ("low_light", 0.6),
        ("missing_data", 0.6),
    ]
    assert pair.modalities == ("rgb", "depth") and pair.modality == "rgb+depth"
    assert Corruption("spatter+flare", 0.6).modality == "rgb"
    assert Corruption("spatter+mask", 0.6).modalities == ("rgb", "instruction")
    assert CLEAN.parts == CLEAN.modalities == () and CLEAN.modality == "none"
    assert registry.title("low_light_noise+haze") == "L-L w/ noise + Haze"


def test_pair_row_has_the_version_of_its_unseen_parts():
    assert registry.version("spatter+flare") == registry.version("clean") == {}
    assert registry.version("spatter+haze") == {"version": "1"}
    assert registry.version("haze+ripple") == {"version": "1+1"}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("spatter+fogg", "There is no corruption 'fogg'"),
        ("spatter+clean", "other than 'clean', got"),
        ("clean+flare", "Name the other corruption alone"),
        ("spatter+spatter", "two different corruptions"),
        ("spatter+flare+haze", "two different corruptions"),
        ("spatter+", "There is no corruption ''"),
    ],
)
def test_pair_rejects_invalid_names(name, message):
    with pytest.raises(ValueError, match=message):
        Corruption(name, 0.5)


def test_pair_is_rejected_where_one_corruption_is_required(panorama):
    for call in (
        lambda: corrupt(panorama[0], "spatter+flare", 0.5, key=0),
        lambda: Schedule("per_frame", 0.6, names=("spatter+flare",)),
        lambda: Settings("spatter+flare", 0.5),
    ):
        with pytest.raises(ValueError, match="must be a single corruption, got the pair"):
            call()


def test_missing_sensor_names_the_part_that_needs_it(panorama):
    with pytest.raises(ValueError, match="'missing_data' needs the entry 'depth'"):
        corrupt_observation({"rgb": panorama[0]}, Corruption("flare+missing_data", 0.5), KEY)


def test_normalised_depth_and_habitat_take_pairs(panorama):
    pair = Corruption("spatter+missing_data", 0.6)
    obs = {"rgb": panorama[0], "depth": np.clip(panorama[1] / 10, 0, 1)}
    output = corrupt_normalised(obs, pair, KEY)
    assert np.nanmax(output["depth"][1:]) <= 1.0 and (output["depth"] == 0).mean() > 0.1
    cameras = {"rgb": panorama[0][0], "depth": obs["depth"][0]}
    seen = corrupt_habitat(cameras, pair, KEY)
    assert (seen["rgb"] == output["rgb"][0]).all()
    assert seen["depth"].tobytes() == output["depth"][0].tobytes()


def test_suite_pairs_has_eight_of_the_standard_suite():
    cfg = conf.load_config("evaluate", ["suite=pairs"])
    clean, *pairs = cfg.suite.conditions
    assert clean == "clean" and len(pairs) == 8
    for pair in evaluate.conditions(pairs, 0.6, None):
        assert len(pair.parts) == 2 and not registry.version(pair.name)


def test_evaluation_accepts_pairs_at_one_severity():
    result = evaluate.conditions(["clean", "haze+flare", "multipath+ripple"], 0.9, 0.8)
    assert [(c.name, c.severity) for c in result] == [
        ("clean", 0),
        ("haze+flare", 0.9),
        ("multipath+ripple", 0.8),
    ]
    with pytest.raises(ValueError, match="have the same severity"):
        evaluate.conditions(["spatter+ripple"], 0.9, 0.8)
    with pytest.raises(ValueError, match="mean spatter"):
        evaluate.conditions(["flare+spater"], 0.9, None)


def test_command_line_accepts_a_pair():
    cfg = conf.load_config("evaluate", ["conditions=[clean,low_light+missing_data]"])
    assert list(cfg.conditions) == ["clean", "low_light+missing_data"]


def test_repeated_condition_runs_once():
    result = evaluate.conditions(["clean", "spatter+flare", "clean", "spatter+flare"], 0.6, None)
    assert result == [CLEAN, Corruption("spatter+flare", 0.6)]
