"""Harden an image encoder from frames alone: corrupted frames must give the clean ones' features.

    L = w_feat mean of (f(corrupted) - f0(clean))^2 / v + w_gate BCE(gates, corrupted or not)

f0 is the encoder as it came, and v how much its clean features differ between frames: a loss of 1
is that of features that say nothing of the frame. Nothing else is needed: no label, action,
instruction or policy. Some frames stay clean (``schedule.clean_share``): clean features must stay
where the rest of an agent expects them; adapters with a gate learn to leave those frames alone.
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
from mitigate.training import success
from mitigate.training.objective import Objective, check_weights

SHOWN = 12  # frames in the log's picture
MOST_KEPT = 1 << 30  # bytes of clean features kept from the start; more are computed at each step
LOOKED_AT = 48  # frames that tell how much features differ where not all are kept (ours)


def frame_source(
    agent: Encoder,
    world: Callable[[], Any],
    episodes: Mapping[str, str] | None = None,
    split: str = "val_unseen",
    label: str | None = None,
) -> Source:
    """Return the source of an encoder's frames (``source_of``)."""
    return source_of(world, agent.sensor, episodes, split, label)


class HardenEncoder(Objective):
    """Give for corrupted frames the features of the clean ones.

    Args:
        agent: the encoder; its adapters, or all of its weights, are trained in place.
        source: where frames come from.
        schedule: of corruptions; those of the encoder's sensor are drawn.
        frames: read once, from the training scenes. Of files the unseen ones are read too, so that
            an invalid one is found at once.
        batch: frames per step.
        micro_batch: of them in memory at once.
        seed: of frames and corruptions.
        w_feat: weight of the error of features.
        w_gate: weight of the gates' loss.
        per_channel: whether v is of each channel, so that all count alike, or the mean of all.

    Raises:
        ValueError: for an invalid number, and for a schedule that does not fit.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"source": frame_source}
    here = True  # the frames are in this process
    needs = ("choose_trained", "sensor", "model")
    otherwise = (
        "This recipe takes an image encoder in an agent's place: agent=efficientnet_lite0, or "
        "agent=encoder with agent.model=... for one of your own (docs/encoder.md)."
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
                f"recipe.micro_batch ({micro_batch}) must be from 1 to recipe.batch ({batch}), and "
                f"recipe.frames ({frames}) at least 1."
            )
        check_weights(w_feat=w_feat, w_gate=w_gate)
        success.refuse(schedule)
        self.agent = agent
        self.batch_size = batch
        self.micro = micro_batch
        agent.requires_grad_(False)  # of parameters of TorchScript that train there is no copy
        self.teacher = as_agent(agent).as_teacher().eval()
        agent.choose_trained()
        names = tuple(name for name in schedule.names if modality(name) == agent.sensor)
        if not names:
            raise ValueError(
                f"schedule.names has no corruption of {agent.sensor}, which this encoder sees."
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
        found = {"encoder_sha256": checkpoint.weights_sha(self.teacher)}
        if self.source.files:
            assert self.frames is not None
            found["frames_sha256"] = self.frames.sha256()
        return found

    def start(self) -> None:
        if self.frames is None:
            self.frames = collect(self.source, TRAIN, self.count, self.seed)
        device, self.targets = next(self.teacher.parameters(), torch.zeros(())).device, None
        clean = torch.from_numpy(self.frames.frames).split(self.micro)
        some = clean[: -(-LOOKED_AT // self.micro)]
        first = torch.cat([self._clean(part.to(device)) for part in some])
        self.variance = variance(first, self.per_channel)
        if first[0].numel() * first.element_size() * len(self.frames) > MOST_KEPT:
            return
        with Progress("clean features", len(self.frames), unit="frame") as progress:
            self.targets = first.new_empty(len(self.frames), *first.shape[1:])
            for at, part in enumerate(clean):
                start = at * self.micro
                self.targets[start : start + len(part)] = self._clean(part.to(device))
                progress.advance(len(part))
        self.variance = variance(self.targets, self.per_channel)

    @torch.no_grad()
    def _clean(self, frames: Tensor) -> Tensor:
        return self.teacher(frames).float()

    def jobs(self, step: int) -> list[tuple[int, int, int]]:
        """Step, place and number of each frame."""
        assert self.frames is not None, "start() reads the frames"
        rng = generator(self.seed, "encoder batch", step)
        chosen = rng.integers(len(self.frames), size=self.batch_size).tolist()
        return [(step, place, index) for place, index in enumerate(chosen)]

    def work(self, job: tuple[int, int, int]) -> tuple[int, np.ndarray]:
        """The number of a frame, and the frame corrupted."""
        step, place, index = job
        assert self.frames is not None
        corruption, key = self.schedule.draw(self.seed, f"{step}-{place}", 0)
        return index, corrupted(self.frames, index, corruption, key, self.agent.far())

    def collate(self, step: int, pieces: list[tuple[int, np.ndarray]]) -> dict[str, Any]:
        assert self.frames is not None
        chosen, changed = [index for index, _ in pieces], [frame for _, frame in pieces]
        clean = [self.frames.frames[index] for index in chosen]
        # black-out spares some
        hit = [float(not np.array_equal(a, b)) for a, b in zip(changed, clean, strict=True)]
        self._last = np.stack(changed[:SHOWN])
        return {
            "frames": torch.from_numpy(np.stack(changed)),
            **self._wanted(np.array(chosen), clean),
            "corrupted": torch.tensor(hit),
            "episode_ids": [self.frames.names[self.frames.scene[index]] for index in chosen],
        }

    def weight(self, batch: dict[str, Any]) -> float:
        """Frames."""
        return float(len(batch["frames"]))

    def _wanted(self, chosen: np.ndarray, clean: list[np.ndarray]) -> dict[str, Tensor]:
        """The clean features of a step's frames, or the frames to compute them from."""
        if self.targets is None:
            return {"clean": torch.from_numpy(np.stack(clean))}
        return {"wanted": self.targets[torch.from_numpy(chosen).to(self.targets.device)]}

    def micro_batches(self, batch: dict[str, Any]) -> list[dict[str, Any]]:
        """Parts of the step's frames, each with its share of them."""
        tensors = {name: batch[name].split(self.micro) for name in batch if name != "episode_ids"}
        parts = [
            dict(zip(tensors, part, strict=True)) for part in zip(*tensors.values(), strict=True)
        ]
        return [{**part, "share": len(part["frames"]) / self.weight(batch)} for part in parts]

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        wanted = batch["wanted"] if "wanted" in batch else self._clean(batch["clean"])
        gates: list[Tensor] = []
        handles = [
            module.register_forward_hook(lambda _, given, out: gates.append(out))
            for module in self.agent.modules()
            if isinstance(module, Gate)
        ]
        try:
            found = self.agent(batch["frames"])
        finally:
            for handle in handles:
                handle.remove()
        values = {"feat": ((found.float() - wanted).square() / self.variance).mean()}
        loss = self.w_feat * values["feat"]
        if gates:
            hit = batch["corrupted"]
            values["gate"] = torch.stack(
                [F.binary_cross_entropy_with_logits(gate.float(), hit) for gate in gates]
            ).mean()
            loss = loss + self.w_gate * values["gate"]
        values = {"loss": loss, **values, "cosine": cosine(found, wanted).mean()}
        return {name: value * batch.get("share", 1.0) for name, value in values.items()}

    def evaluate(self, step: int) -> dict[str, float]:
        """1 if the encoder's own weights are what they were, as they must be with adapters."""
        return {"backbone_unchanged": float(backbone_sha(self.agent.model) == self.backbone)}

    def figures(self, step: int) -> dict[str, np.ndarray]:
        return {} if self._last is None else {"frames": side_by_side(self._last)}


def variance(clean: Tensor, per_channel: bool) -> Tensor:
    """How much features ``[n, C]``, ``[n, C, h, w]`` or ``[n, T, C]`` differ between frames, at the
    same place: of each channel, in a shape that divides them, or the mean of all, a number. A
    channel that hardly differs counts as if it had a hundredth of the mean."""
    each = clean.var(0)
    channel = 0 if each.dim() == 3 else each.dim() - 1
    others = [axis for axis in range(each.dim()) if axis != channel]
    each = each.mean(others, keepdim=True) if others else each
    mean = each.mean().clamp(min=1e-12)
    return each.clamp(min=0.01 * float(mean)) if per_channel else mean


def cosine(found: Tensor, wanted: Tensor) -> Tensor:
    """Cosine [n] between the features of each frame."""
    return nn.functional.cosine_similarity(found.float().flatten(1), wanted.float().flatten(1))
