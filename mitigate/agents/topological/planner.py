"""The cross-modal planner scores [stop] and the ghosts of the map, given the instruction.

The structure follows ETPNav. RGB and depth embeddings are summed per view and go through a panorama
transformer. The embedding of a node is the mean over its views; for a ghost node, it is the mean
over the views that face the ghost. A cross-modal transformer then reads the map and the text. The
12 views of the current panorama are additional tokens (as in DUET's fine branch).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from mitigate.agents.agent import Batch
from mitigate.agents.attention import Layer, TextReader
from mitigate.agents.fusion import weigher
from mitigate.agents.text import CONCEPTS, Vocabulary
from mitigate.agents.topological.mapping import GEOMETRY, SIGHTINGS, Decision
from mitigate.core.observation import VIEW_STEP_DEGREES, VIEWS


@dataclass
class DecisionBatch(Batch):
    """A batch of padded decisions; the order of tokens is [stop], nodes (N), ghosts (G)."""

    episode: Tensor  # int [B], index of each decision's text
    panorama: Tensor  # int [B], index of the current panorama
    nodes: Tensor  # int [B, N], panorama index or -1
    sightings: Tensor  # int [B, G, 4], flat view index (panorama * 12 + view) or -1
    geometry: Tensor  # float [B, 1 + N + G, GEOMETRY]
    valid: Tensor  # bool [B, 1 + N + G], False for padding
    allowed: Tensor  # bool [B, 1 + N + G], the tokens that may be chosen: stop and ghosts


def collate(decisions: list[Decision], episodes: list[int], offsets: list[int]) -> DecisionBatch:
    """Pad decisions and join them into a batch.

    ``episodes[i]`` is the index of the text of decision i, and ``offsets[i]`` is the index of the
    first panorama of its episode.
    """
    n = max(len(d.nodes) for d in decisions)
    g = max(1, max(len(d.ghosts) for d in decisions))
    b = len(decisions)
    nodes = np.full((b, n), -1, np.int64)
    sightings = np.full((b, g, SIGHTINGS), -1, np.int64)
    valid = np.zeros((b, 1 + n + g), bool)
    for row, (d, offset) in enumerate(zip(decisions, offsets, strict=True)):
        nodes[row, : len(d.nodes)] = d.nodes + offset
        flat = (d.sightings[..., 0] + offset) * VIEWS + d.sightings[..., 1]
        sightings[row, : len(d.ghosts)] = np.where(d.sightings[..., 0] >= 0, flat, -1)
        valid[row, : 1 + len(d.nodes)] = True
        valid[row, 1 + n : 1 + n + len(d.ghosts)] = True
    geometry = np.zeros((b, 1 + n + g, GEOMETRY), np.float32)
    geometry[valid] = np.concatenate([d.geometry for d in decisions])
    allowed = valid.copy()
    allowed[:, 1 : 1 + n] = False
    current = np.array([d.panorama + o for d, o in zip(decisions, offsets, strict=True)])
    arrays = (np.array(episodes), current, nodes, sightings, geometry, valid, allowed)
    return DecisionBatch(*(torch.from_numpy(a) for a in arrays))


class Planner(TextReader):
    """Score [stop] and ghost nodes; the module's docstring describes the structure.

    Args:
        rgb_width: number of RGB features per view.
        depth_width: number of depth features per view.
        width: width of all layers.
        heads: attention heads.
        text_layers: transformer layers over the text.
        layers: cross-modal layers.
        dropout: dropout rate.
        fusion: keyword arguments of ``fusion.weigher`` (rate, cap, learned). Views with reliable
            encoder features then get higher weights. If None, all views have equal weights.
        vocabulary: words of the instructions, or None for the default vocabulary.
    """

    yaws: Tensor

    def __init__(
        self,
        rgb_width: int = 128,
        depth_width: int = 128,
        width: int = 128,
        heads: int = 4,
        text_layers: int = 2,
        layers: int = 3,
        dropout: float = 0.1,
        fusion: dict[str, Any] | None = None,
        vocabulary: Vocabulary | None = None,
    ) -> None:
        super().__init__(vocabulary or Vocabulary(), width, heads, text_layers, dropout)
        self.widths = (rgb_width, len(CONCEPTS), depth_width)
        self.seen, self.close, self.kinds = (nn.Linear(width, width, bias=False) for _ in range(3))
        self.rgb, self.depth = nn.Linear(rgb_width, width), nn.Linear(depth_width, width)
        self.yaw = nn.Linear(4, width)
        self.panorama = nn.ModuleList([Layer(width, heads, False, dropout)])
        self.view_norm = nn.LayerNorm(width)
        self.geometry = nn.Sequential(
            nn.Linear(GEOMETRY, width), nn.GELU(), nn.Linear(width, width)
        )
        self.view_kind = nn.Parameter(torch.zeros(width))
        self.layers = nn.ModuleList([Layer(width, heads, True, dropout) for _ in range(layers)])
        self.norm = nn.LayerNorm(width)
        self.score = nn.Sequential(nn.Linear(width, width), nn.GELU(), nn.Linear(width, 1))
        self.stop = nn.Sequential(nn.Linear(width, width), nn.GELU(), nn.Linear(width, 1))
        self.distance = nn.Linear(width, 1)
        self.grounding = nn.Linear(width, 1)
        # created last, so that the initial values of other weights do not change
        self.fusion = None if fusion is None else weigher(rgb_width + depth_width, **fusion)
        yaws = torch.arange(VIEWS) * math.radians(VIEW_STEP_DEGREES)
        self.register_buffer(
            "yaws",
            torch.stack([yaws.sin(), yaws.cos(), (2 * yaws).sin(), (2 * yaws).cos()], 1),
            persistent=False,
        )

    @property
    def embedding_width(self) -> int:
        """The number of output channels of :meth:`embed_views`."""
        return self.view_kind.numel() + (self.fusion is not None)

    def embed_views(self, views: Tensor) -> Tensor:
        """Return view tokens [P, 12, width] of view features [P, 12, view_width].

        With ``fusion``, one more channel holds the reliability of each view.
        """
        rgb, concepts, depth = views.split(self.widths, -1)
        seen, close, others = self.concept_features(concepts)
        x = seen + close + others + self.rgb(rgb) + self.depth(depth) + self.yaw(self.yaws)
        for layer in self.panorama:
            x = layer(x, None)
        x = self.view_norm(x)
        if self.fusion is None:
            return x
        weights = self.fusion(torch.cat([rgb, depth], -1).float())
        return torch.cat([x, weights.unsqueeze(-1).to(x.dtype)], -1)

    def forward(
        self, text: tuple[Tensor, Tensor], views: Tensor, batch: DecisionBatch
    ) -> dict[str, Tensor]:
        """Score every token.

        Args:
            text: the result of ``read``.
            views: [P, 12, ...], the result of ``embed_views``.
            batch: the padded decisions.

        Returns:
            "logits" [B, 1 + N + G], -inf for tokens that are not allowed; "distance" [B, 1 + N +
            G], the predicted metres to the goal, divided by 5; "grounding" [B, 12], one logit per
            view for whether it shows the goal's landmark; "nodes" [B, 1 + N + G, width], the
            features that distillation compares.
        """
        weights = None if self.fusion is None else views[..., -1:]
        views = views if self.fusion is None else views[..., :-1]
        x = self._tokens(views, weights, batch)
        size = x.shape[1]
        x = torch.cat([x, views[batch.panorama] + self.view_kind], 1)
        mask = F.pad(batch.valid, (0, VIEWS), value=True)
        for layer in self.layers:
            x = layer(x, mask, (text[0], text[1][batch.episode], batch.episode))
        x = self.norm(x)
        tokens, current = x[:, :size], x[:, size:]
        logits = (
            torch.cat([self.stop(tokens[:, :1]), self.score(tokens[:, 1:])], 1).squeeze(-1).float()
        )
        logits = logits.masked_fill(~batch.allowed, float("-inf"))
        return {
            "logits": logits,
            "distance": self.distance(tokens).squeeze(-1).float(),
            "grounding": self.grounding(current).squeeze(-1).float(),
            "nodes": tokens,
        }

    def _tokens(self, views: Tensor, weights: Tensor | None, batch: DecisionBatch) -> Tensor:
        known = (batch.sightings >= 0).unsqueeze(-1)
        places = batch.sightings.clamp(min=0)
        if weights is None:
            means = views.mean(1)
            ghosts = (views.flatten(0, 1)[places] * known).sum(2) / known.sum(2).clamp(min=1)
        else:
            means = (views * weights).sum(1)  # the weights of a panorama sum to 1
            shares = weights.flatten(0, 1)[places] * known
            total = shares.sum(2)
            ghosts = (views.flatten(0, 1)[places] * shares).sum(2) / total.where(total > 0, 1)
        nodes = means[batch.nodes.clamp(min=0)]
        here = means[batch.panorama].unsqueeze(1)
        return torch.cat([here, nodes, ghosts], 1) + self.geometry(batch.geometry)
