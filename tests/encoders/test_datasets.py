"""Tests of LeRobot datasets as sources of training frames."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core import conf
from mitigate.encoders.datasets import DatasetFrames
from mitigate.encoders.sources import TRAIN, UNSEEN, FolderFrames, collect, source_of
from mitigate.training import train
from tests.lerobot_files import DEPTH, FRONT, LENGTHS, WRIST, depth, rgb, write_dataset

pytest.importorskip("pyarrow", reason="needs pyarrow: pip install -e '.[lerobot]'")
pytest.importorskip("av", reason="needs av: pip install -e '.[lerobot]'")


@pytest.fixture(scope="module", params=["video", "image"])
def folder(request, tmp_path_factory):
    path = tmp_path_factory.mktemp(request.param) / "cups"
    return write_dataset(path, with_depth=True, stored=request.param)


def test_episodes_are_scenes_and_the_last_are_unseen(folder):
    source = source_of(lambda: DatasetFrames(str(folder), WRIST), "rgb", None, "unseen", None)
    assert list(source.scenes(TRAIN)) == ["episode-000000", "episode-000001"]
    assert list(source.scenes(UNSEEN)) == ["episode-000002"]


def test_frames_are_those_of_the_chosen_camera(folder):
    frames = collect(DatasetFrames(str(folder), WRIST), TRAIN, 10, 0)
    expected = [rgb(WRIST, episode, n) for episode in (0, 1) for n in range(LENGTHS[episode])]
    assert all(any(np.array_equal(frame, e) for e in expected) for frame in frames.frames)
    again = collect(DatasetFrames(str(folder), WRIST), TRAIN, 10, 0)
    assert np.array_equal(frames.frames, again.frames) and len(np.unique(frames.scene)) == 2


def test_depth_is_in_metres_and_resized(folder):
    frames = collect(DatasetFrames(str(folder), sensor="depth", size=16), UNSEEN, 5, 0)
    assert frames.frames.shape == (5, 16, 16, 1) and frames.frames.dtype == np.float32
    assert frames.frames.max() == pytest.approx(depth(2, 4).max() / 1000, rel=0.05)


def test_a_single_episode_is_split_into_blocks(folder):
    source = DatasetFrames(str(folder), FRONT, episodes=[0], held_out=0.5)
    names = [*source.scenes(TRAIN), *source.scenes(UNSEEN)]
    assert len(names) == LENGTHS[0] and len(source.scenes(UNSEEN)) == 3
    (frame,) = collect(source, UNSEEN, 1, 0).frames
    assert any(np.array_equal(frame, rgb(FRONT, 0, n)) for n in (3, 4, 5))


def test_several_cameras_need_a_choice(folder):
    with pytest.raises(ValueError, match=rf"env.camera must name one.*{FRONT}, {WRIST}, {DEPTH}"):
        DatasetFrames(str(folder))
    with pytest.raises(ValueError, match="one of the rgb cameras.*because 0 cameras match"):
        DatasetFrames(str(folder), DEPTH)


def test_a_folder_source_names_the_env_for_datasets(folder):
    with pytest.raises(ValueError, match="is a LeRobot dataset: env=lerobot env.path="):
        FolderFrames(str(folder))


@pytest.mark.slow
def test_recipe_encoder_trains_on_a_dataset(folder, tmp_path):
    options = [
        *("recipe=encoder", "env=lerobot", f"env.path={folder}", f"env.camera={FRONT}"),
        *("env.size=32", "agent=encoder", "agent.output=pool"),
        "agent.model=tests.encoders.shapes:tiny",
        *("stages.encoder.recipe.frames=10", "stages.encoder.recipe.batch=4"),
        *("stages.encoder.recipe.micro_batch=4", "trainer.steps=2", "evaluation.episodes=1"),
        *(f"runs={tmp_path}", "workers=0"),
    ]
    out = train.run(conf.load_config("train", options))
    assert (out / "features.md").is_file()
