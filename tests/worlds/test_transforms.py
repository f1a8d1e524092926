"""Tests of torchrl transforms in batched environments: masks, rows, workers, replay buffers and
devices."""

import warnings

import numpy as np
import pytest
import torch
from tensordict import TensorDict
from torchrl.data import (
    Bounded,
    Categorical,
    Composite,
    LazyMemmapStorage,
    LazyTensorStorage,
    ReplayBuffer,
    Unbounded,
)
from torchrl.envs import Compose, EnvBase, TransformedEnv
from torchrl.envs.utils import check_env_specs

from mitigate.corruptions import Corruption, DepthSensor, Key, Schedule, corrupt, corrupt_normalised
from mitigate.worlds.transforms import CorruptObservation, EpisodeCounter

HURT = Schedule("per_episode", 0.8, clean_share=0.2)


class Corridor(EnvBase):
    """A batched environment. Its frames depend on the step, and the episode of row i ends after 2 +
    i steps."""

    def __init__(self, rows: int = 3, rgb: str = "rgb", top: float = 10.0) -> None:
        super().__init__(device="cpu", batch_size=[rows])
        self.rows, self.rgb, self.top = rows, rgb, top
        self.clock = torch.zeros(rows, dtype=torch.int64)
        self.observation_spec = Composite(
            {
                rgb: Bounded(0, 255, shape=(rows, 12, 16, 3), dtype=torch.uint8),
                "depth": Bounded(0.0, top, shape=(rows, 12, 16, 1), dtype=torch.float32),
            },
            shape=(rows,),
        )
        self.action_spec = Categorical(2, shape=(rows,), dtype=torch.int64)
        self.reward_spec = Unbounded(shape=(rows, 1), dtype=torch.float32)

    def _state(self) -> TensorDict:
        grey = torch.arange(192).reshape(12, 16, 1) % 100 + 50
        moved = (grey + 10 * self.clock[:, None, None, None]).to(torch.uint8)
        depth = (moved.float() / 256.0 * self.top).clamp(0.01 * self.top, 0.9 * self.top)
        done = (self.clock >= 2 + torch.arange(self.rows))[:, None]
        return TensorDict(
            {self.rgb: moved.repeat(1, 1, 1, 3), "depth": depth, "done": done, "terminated": done},
            [self.rows],
        )

    def _reset(self, tensordict=None, **kwargs):
        mask = None if tensordict is None else tensordict.get("_reset", None)
        rows = slice(None) if mask is None else mask.flatten()
        self.clock = self.clock.clone()
        self.clock[rows] = 0
        return self._state()

    def _step(self, tensordict):
        self.clock = self.clock + 1
        return self._state().set("reward", torch.zeros(self.rows, 1))

    def _set_seed(self, seed):
        pass


def hurt_env(rows: int = 3, schedule: Schedule = HURT, **options) -> TransformedEnv:
    return TransformedEnv(
        Corridor(rows), Compose(EpisodeCounter(**options), CorruptObservation(schedule, seed=4))
    )


def seen(data: TensorDict) -> dict[tuple[int, int], tuple[torch.Tensor, torch.Tensor]]:
    """Return the frames of a rollout, keyed by (episode, frame number)."""
    return {
        (int(i["episode"]), int(i["frame"])): (i["rgb"], i["depth"])
        for i in data.reshape(-1).unbind(0)
    }


def test_transforms_pass_the_spec_check():
    check_env_specs(hurt_env())
    check_env_specs(hurt_env(1))


def test_episode_counter_advances_only_reset_rows():
    data = hurt_env().rollout(9, break_when_any_done=False)
    assert data["episode"][0, :, 0].tolist() == [0, 0, 3, 3, 6, 6, 9, 9, 12]
    assert data["frame"][0, :, 0].tolist() == [0, 1, 0, 1, 0, 1, 0, 1, 0]
    assert data["episode"][2, :, 0].tolist() == [2, 2, 2, 2, 5, 5, 5, 5, 8]
    assert data["next", "frame"][2, :, 0].tolist() == [1, 2, 3, 4, 1, 2, 3, 4, 1]


def test_corrupt_observation_equals_the_suite_per_row():
    clean = Corridor().rollout(9, break_when_any_done=False)
    data = hurt_env().rollout(9, break_when_any_done=False)
    changed = 0
    for part in (lambda td: td, lambda td: td["next"]):
        rows = zip(part(clean).reshape(-1).unbind(0), part(data).reshape(-1).unbind(0), strict=True)
        for before, after in rows:
            episode, frame = str(int(after["episode"])), int(after["frame"])
            drawn, key = HURT.draw(4, episode, frame)
            assert key == Key(4, episode, frame)
            expected = {name: before[name].numpy() for name in ("rgb", "depth")}
            if drawn.modality != "none":
                frames = expected[drawn.modality]
                expected[drawn.modality] = corrupt(frames, drawn.name, drawn.severity, key=key)
            for name in ("rgb", "depth"):
                assert np.array_equal(after[name].numpy(), expected[name])
                changed += not torch.equal(after[name], before[name])
    assert changed > 20


def test_corrupt_observation_applies_pairs():
    pair = Corruption("low_light+missing_data", 0.8)
    clean, hurt = Corridor().reset(), hurt_env(schedule=pair).reset()
    assert all((hurt[name] != clean[name]).any() for name in ("rgb", "depth"))


def test_pixels_do_not_depend_on_workers():
    together = seen(hurt_env(4).rollout(12, break_when_any_done=False))
    for worker in (0, 1):
        alone = seen(hurt_env(2, worker=worker, workers=2).rollout(12, break_when_any_done=False))
        firsts = {place for place in alone if place[0] < 4}
        assert {episode for episode, _ in firsts} == {2 * worker, 2 * worker + 1}
        for place in firsts & together.keys():
            hurt = HURT.draw(4, str(place[0]), place[1])[0].modality
            if hurt != "none":  # at the same step, both rows show the same scene
                index = ("rgb", "depth").index(hurt)
                assert torch.equal(alone[place][index], together[place][index])


@pytest.mark.parametrize("storage", [LazyTensorStorage, LazyMemmapStorage])
def test_replay_buffer_gives_the_same_frames(storage, tmp_path):
    env = TransformedEnv(Corridor(), EpisodeCounter())
    clean = env.rollout(7, break_when_any_done=False).reshape(-1)
    expected = hurt_env().rollout(7, break_when_any_done=False).reshape(-1)
    options = {"scratch_dir": tmp_path} if storage is LazyMemmapStorage else {}
    buffer = ReplayBuffer(storage=storage(len(clean), **options), batch_size=8)
    buffer.append_transform(CorruptObservation(HURT, seed=4))
    buffer.extend(clean)
    for _ in range(2):  # stored frames stay clean
        drawn = buffer[:]
        for name in ("rgb", "depth", ("next", "rgb"), ("next", "depth")):
            assert torch.equal(drawn[name], expected[name])
    sample, index = buffer.sample(return_info=True)
    assert torch.equal(sample["rgb"], expected["rgb"][index["index"]])


def test_corrupt_observation_accepts_names_and_normalised_depth():
    sensor = DepthSensor(0.5, 5.0)
    schedule = Schedule("per_episode", 1.0, clean_share=0.0)
    transform = CorruptObservation(schedule, rgb="pixels", sensor=sensor, normalised=True)
    env = TransformedEnv(Corridor(6, "pixels", 1.0), Compose(EpisodeCounter(), transform))
    check_env_specs(env)
    clean, data = Corridor(6, "pixels", 1.0).reset(), env.reset()
    for row in range(6):
        corruption, key = schedule.draw(0, str(int(data["episode"][row])), 0)
        frames = {"rgb": clean["pixels"][row].numpy(), "depth": clean["depth"][row].numpy()}
        expected = corrupt_normalised(frames, corruption, key, sensor)
        assert np.array_equal(data["pixels"][row].numpy(), expected["rgb"])
        assert np.array_equal(data["depth"][row].numpy(), expected["depth"])


def test_corrupt_observation_explains_a_missing_modality():
    data = TensorDict(
        {
            "rgb": torch.full((2, 3, 8, 8, 3), 90, dtype=torch.uint8),
            "episode": torch.arange(6).reshape(2, 3, 1),
            "frame": torch.zeros(2, 3, 1, dtype=torch.int64),
        },
        [2, 3],
    )
    out = CorruptObservation(Schedule.always("foreign_object", 1.0))(data.clone())
    reported = CorruptObservation(Corruption("foreign_object", 1.0))(data.clone())
    assert (reported["rgb"] == out["rgb"]).all()
    assert out["rgb"].shape == (2, 3, 8, 8, 3) and (out["rgb"][..., 4, 4, :] == 0).all()
    # all frames stay clean, but the corruptions of the schedule need depth
    mostly_clean = Schedule("per_frame", 0.6, clean_share=1.0)
    for schedule in (Schedule.always("multipath", 1.0), mostly_clean):
        with pytest.raises(
            ValueError, match="corrupts depth, but the data have no depth.*name the entry"
        ):
            CorruptObservation(schedule)(data)
    with pytest.raises(ValueError, match=r"names=\[motion_blur, .*black_out\]"):
        CorruptObservation(mostly_clean)(data)
    CorruptObservation(Schedule("clean", 0.0))(data)


def test_torch_backend_equals_the_numpy_backend():
    rollouts = {}
    for backend in ("numpy", "torch"):
        transform = CorruptObservation(HURT, seed=4, backend=backend)
        env = TransformedEnv(Corridor(), Compose(EpisodeCounter(), transform))
        rollouts[backend] = env.rollout(9, break_when_any_done=False)
    clean = Corridor().rollout(9, break_when_any_done=False)
    for name, most in (("rgb", 1), ("depth", 1e-4)):
        for part in (name, ("next", name)):
            pair = rollouts["torch"][part].double(), rollouts["numpy"][part].double()
            far = ((pair[0] - pair[1]).abs() > most).any(-1)
            assert far.sum() <= 0.001 * far.numel()
            assert not torch.equal(rollouts["torch"][part], clean[part])


def test_torch_backend_leaves_faults_to_numpy():
    fault = Corruption("frozen_frame", 1.0)
    seen_by = [
        TransformedEnv(
            Corridor(), Compose(EpisodeCounter(), CorruptObservation(fault, backend=backend))
        ).rollout(4)["rgb"]
        for backend in ("numpy", "torch")
    ]
    assert torch.equal(*seen_by)


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")
def test_corrupt_observation_keeps_the_device():
    data = hurt_env().rollout(3, break_when_any_done=False).exclude("next")
    stored = TransformedEnv(Corridor(), EpisodeCounter()).rollout(3, break_when_any_done=False)
    moved = CorruptObservation(HURT, seed=4, backend="numpy")(stored.exclude("next").to("cuda"))
    assert moved["rgb"].device.type == "cuda" and torch.equal(moved["rgb"].cpu(), data["rgb"])


def test_transforms_explain_invalid_use():
    with pytest.raises(ValueError, match="put an EpisodeCounter"):
        TransformedEnv(Corridor(), CorruptObservation(HURT)).reset()
    with pytest.raises(ValueError, match="worker must be 0 to 1"):
        EpisodeCounter(worker=2, workers=2)
    with pytest.raises(RuntimeError, match="not in a replay buffer"):
        EpisodeCounter()(TensorDict({}, [2]))


@pytest.mark.parametrize("far", [0.9, 3.0])
def test_replay_buffer_rejects_depth_that_may_be_normalised(far):
    """Issue T2, item 12."""
    depth = torch.linspace(0.1, far, 2 * 8 * 8).reshape(2, 8, 8, 1)
    steps = torch.arange(2)[:, None]
    data = TensorDict({"depth": depth, "episode": steps, "frame": steps}, [2])
    corrupt = CorruptObservation(Corruption("missing_data", 0.6))
    if far > 1:
        assert (corrupt(data)["depth"] != depth).any()
        return
    with pytest.raises(ValueError, match="may be normalised.*normalised=True"):
        corrupt(data)
    in_metres = CorruptObservation(Corruption("missing_data", 0.6), normalised=False)
    assert (in_metres(data)["depth"] != depth).any()


def test_episode_counter_warns_in_a_child_process(monkeypatch):
    """Issue T2, item 12."""
    monkeypatch.setattr("multiprocessing.parent_process", lambda: object())
    with pytest.warns(UserWarning, match="worker=i, workers=n"):
        EpisodeCounter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        EpisodeCounter(workers=1)
