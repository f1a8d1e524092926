"""Harden an image encoder with frames only. The encoder learns to output the clean features for
corrupted frames.

    L = w_feat * mean((f(corrupted) - f0(clean))^2 / v) + w_gate * BCE(gates, is_corrupted)

f0 is the original encoder, and v is the variance of f0(clean) across frames. Therefore features
that do not depend on the frame have a loss of 1. No label, action, instruction or policy is needed.
A fraction ``schedule.clean_share`` of the frames stays clean, because the rest of an agent expects
that the features of clean frames do not change. Adapters with a gate learn to leave these frames
unchanged.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.adapter_layers import Gate
from mitigate.agents.adapters import backbone_sha
from mitigate.agents.agent import as_agent
from mitigate.core import checkpoint
from mitigate.core.pictures import side_by_side
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule
from mitigate.corruptions.registry import modality
from mitigate.encoders.model import Encoder
from mitigate.encoders.sources import TRAIN, UNSEEN, Frames, Source, collect, corrupted, source_of
from mitigate.training.objective import Objective, check_weights
from mitigate.training.success import reject_success_distributed

SHOWN = 12  # number of frames in the logged picture
# maximum number of bytes of cached clean features; larger amounts are computed again at each step
MOST_KEPT = 1 << 30
# number of frames from which the variance is estimated if features are not cached (heuristic)
VARIANCE_FRAMES = 48


def frame_source(
    agent: Encoder,
    world: Callable[[], Any],
    episodes: Mapping[str, str] | None = None,
    split: str = "val_unseen",
    label: str | None = None,
) -> Source:
    """Return the source of the frames for an encoder (see ``source_of``)."""
    return source_of(world, agent.sensor, episodes, split, label)


class HardenEncoder(Objective):
    """Train an encoder to output the clean features for corrupted frames.

    Args:
        agent: the encoder. Its adapters, or all of its weights, are trained in place.
        source: source of the frames.
        schedule: schedule of corruptions. Only corruptions of the encoder's sensor are used.
        frames: number of frames, which are read once from the training scenes. Held-out files are
            also read at the start, so that invalid files are found early.
        batch: number of frames per step.
        micro_batch: number of frames that are processed at once.
        seed: seed of frames and corruptions.
        w_feat: weight of the feature loss.
        w_gate: weight of the gate loss.
        per_channel: whether the loss is divided by the variance of each channel, so that all
            channels have equal weight. If false, it is divided by the mean variance.

    Raises:
        ValueError: If a number is invalid, or if the schedule has no corruption of the encoder's
            sensor.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"source": frame_source}
    here = True  # jobs run in this process, because it holds the frames
    needs = ("choose_trained", "sensor", "model")
    otherwise = (
        "This recipe trains an image encoder: set agent=efficientnet_lite0, or agent=encoder with "
        "agent.model=... for your own encoder (docs/encoder.md)."
    )

    def __init__(
        self,
        agent: Encoder,
        source: Source,
        schedule: Schedule,
        frames: int = 4800,
        batch: int = 48,
        micro_batch: int = 48,
        seed: int = 0,
        w_feat: float = 1.0,
        w_gate: float = 0.1,
        per_channel: bool = False,
    ) -> None:
        super().__init__()
        if not 1 <= micro_batch <= batch or frames < 1:
            raise ValueError(
                f"micro_batch must be from 1 to batch ({batch}), got {micro_batch}; "
                f"frames must be >= 1, got {frames}."
            )
        check_weights(w_feat=w_feat, w_gate=w_gate)
        reject_success_distributed(schedule)
        self.agent = agent
        self.batch_size = batch
        self.micro_batch = micro_batch
        # freeze first, so that the teacher, which is a copy, is frozen too
        agent.requires_grad_(False)
        self.teacher = as_agent(agent).as_teacher().eval()
        agent.choose_trained()
        names = tuple(name for name in schedule.names if modality(name) == agent.sensor)
        if not names:
            raise ValueError(
                f"schedule.names must contain a corruption of {agent.sensor}, which this encoder "
                "reads."
            )
        self.schedule = dataclasses.replace(schedule, names=names)
        self.source = source
        self.count = frames
        self.seed = seed
        self.w_feat = w_feat
        self.w_gate = w_gate
        self.per_channel = per_channel
        self.frames: Frames | None = None
        if self.source.files:
            self.frames = collect(self.source, TRAIN, frames, seed)
            collect(self.source, UNSEEN, frames, seed)
        self.targets: Tensor | None = None
        self.variance = torch.ones(())
        self.backbone = backbone_sha(agent.model)
        self._last: np.ndarray | None = None

    def identity(self) -> dict[str, str]:
        hashes = {"encoder_sha256": checkpoint.weights_sha(self.teacher)}
        if self.source.files:
            assert self.frames is not None
            hashes["frames_sha256"] = self.frames.sha256()
        return hashes

    def start(self) -> None:
        if self.frames is None:
            self.frames = collect(self.source, TRAIN, self.count, self.seed)
        device = next(self.teacher.parameters(), torch.zeros(())).device
        self.targets = None
        clean = torch.from_numpy(self.frames.frames).split(self.micro_batch)
        some = clean[: -(-VARIANCE_FRAMES // self.micro_batch)]
        first = torch.cat([self._clean(part.to(device)) for part in some])
        self.variance = variance(first, self.per_channel)
        if first[0].numel() * first.element_size() * len(self.frames) > MOST_KEPT:
            return
        with Progress("clean features", len(self.frames), unit="frame") as progress:
            self.targets = first.new_empty(len(self.frames), *first.shape[1:])
            for at, part in enumerate(clean):
                start = at * self.micro_batch
                self.targets[start : start + len(part)] = self._clean(part.to(device))
                progress.advance(len(part))
        self.variance = variance(self.targets, self.per_channel)

    @torch.no_grad()
    def _clean(self, frames: Tensor) -> Tensor:
        return self.teacher(frames).float()

    def jobs(self, step: int) -> list[tuple[int, int, int]]:
        """Return one job per frame: a tuple (step, position in the batch, index of the frame)."""
        assert self.frames is not None, "start() reads the frames"
        rng = generator(self.seed, "encoder batch", step)
        chosen = rng.integers(len(self.frames), size=self.batch_size).tolist()
        return [(step, place, index) for place, index in enumerate(chosen)]

    def work(self, job: tuple[int, int, int]) -> tuple[int, np.ndarray]:
        """Return the index of a frame, and the corrupted frame."""
        step, place, index = job
        assert self.frames is not None
        corruption, key = self.schedule.draw(self.seed, f"{step}-{place}", 0)
        return index, corrupted(self.frames, index, corruption, key, self.agent.far())

    def collate(self, step: int, pieces: list[tuple[int, np.ndarray]]) -> dict[str, Any]:
        assert self.frames is not None
        chosen = [index for index, _ in pieces]
        changed = [frame for _, frame in pieces]
        clean = [self.frames.frames[index] for index in chosen]
        # Compare pixels, because the corruption black-out leaves some frames unchanged.
        hit = [float(not np.array_equal(a, b)) for a, b in zip(changed, clean, strict=True)]
        self._last = np.stack(changed[:SHOWN])
        if self.targets is None:
            targets = {"clean": torch.from_numpy(np.stack(clean))}
        else:
            targets = {"target": self.targets[torch.tensor(chosen, device=self.targets.device)]}
        return {
            "frames": torch.from_numpy(np.stack(changed)),
            **targets,
            "corrupted": torch.tensor(hit),
            "episode_ids": [self.frames.names[self.frames.scene[index]] for index in chosen],
        }

    def weight(self, batch: dict[str, Any]) -> float:
        """Return the number of frames in the batch."""
        return float(len(batch["frames"]))

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Split the frames of a step into parts of at most ``micro_batch`` frames, and return each
        part with its fraction of all frames.
        """
        tensors = {
            name: batch[name].split(self.micro_batch) for name in batch if name != "episode_ids"
        }
        parts = [
            dict(zip(tensors, part, strict=True)) for part in zip(*tensors.values(), strict=True)
        ]
        return [{**part, "share": len(part["frames"]) / self.weight(batch)} for part in parts]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        target = batch["target"] if "target" in batch else self._clean(batch["clean"])
        gates: list[Tensor] = []
        handles = [
            module.register_forward_hook(lambda _, _inputs, out: gates.append(out))
            for module in self.agent.modules()
            if isinstance(module, Gate)
        ]
        try:
            features = self.agent(batch["frames"])
        finally:
            for handle in handles:
                handle.remove()
        values = {"feat": ((features.float() - target).square() / self.variance).mean()}
        loss = self.w_feat * values["feat"]
        if gates:
            corrupted = batch["corrupted"]
            values["gate"] = torch.stack(
                [F.binary_cross_entropy_with_logits(gate.float(), corrupted) for gate in gates]
            ).mean()
            loss = loss + self.w_gate * values["gate"]
        values = {"loss": loss, **values, "cosine": cosine(features, target).mean()}
        return {name: value * batch.get("share", 1.0) for name, value in values.items()}

    def evaluate(self, step: int) -> dict[str, float]:
        """Return whether the encoder's own weights are unchanged, as 1 or 0. If adapters are
        trained, these weights must not change.
        """
        return {"backbone_unchanged": float(backbone_sha(self.agent.model) == self.backbone)}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return {} if self._last is None else {"frames": side_by_side(self._last)}


def variance(clean: Tensor, per_channel: bool) -> Tensor:
    """Return the variance of features across frames, computed separately for each position.

    Args:
        clean: features of shape [n, C], [n, C, h, w] or [n, T, C].
        per_channel: whether to return the variance of each channel. It is at least 0.01 times the
            mean variance, and its shape broadcasts with the features. If false, return the mean
            variance.
    """
    each = clean.var(0)
    channel = 0 if each.dim() == 3 else each.dim() - 1
    others = [axis for axis in range(each.dim()) if axis != channel]
    each = each.mean(others, keepdim=True) if others else each
    mean = each.mean().clamp(min=1e-12)
    return each.clamp(min=0.01 * float(mean)) if per_channel else mean


def cosine(features: Tensor, target: Tensor) -> Tensor:
    """Return the cosine similarity [n] of two features for each of n frames."""
    return nn.functional.cosine_similarity(features.float().flatten(1), target.float().flatten(1))
