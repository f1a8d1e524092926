"""Convert prompts and answers of a language model to token ids and to padded batches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import torch
from torch import Tensor

from mitigate.guards.text.language_models.prompts import prompt_messages

if TYPE_CHECKING:
    from mitigate.guards.text.learning.data import Pair


def encode(tokenizer: Any, prompt: str, text: str) -> list[int]:
    """Return the token ids of the chat that asks the model to rewrite ``text``."""
    ids = tokenizer.apply_chat_template(
        prompt_messages(text, prompt), add_generation_prompt=True, return_dict=False
    )
    return list(ids)


def encode_pair(tokenizer: Any, prompt: str, pair: Pair) -> tuple[list[int], list[int]]:
    """Return the token ids of the prompt and of the completion, which includes an end token."""
    answer = tokenizer(pair.target, add_special_tokens=False)["input_ids"]
    return encode(tokenizer, prompt, pair.source), [*answer, tokenizer.eos_token_id]


def collate(pairs: Sequence[tuple[list[int], list[int]]], pad: int) -> dict[str, Tensor]:
    """Combine pairs (prompt, completion) into a batch that is padded on the left.

    Returns ``input_ids``, ``attention_mask`` and ``position_ids``, int64 [B, T], and
    ``completion``, bool [B, C]. ``completion`` marks which of the last C tokens belong to the
    completion. The mask is computed from positions, because the pad token may equal the end token.
    """
    rows = [[*prompt, *answer] for prompt, answer in pairs]
    width, longest = max(map(len, rows)), max(len(answer) for _, answer in pairs)
    lengths = torch.tensor([len(row) for row in rows])
    mask = (torch.arange(width) >= width - lengths[:, None]).long()
    answers = torch.tensor([len(answer) for _, answer in pairs])
    return {
        "input_ids": torch.tensor([[pad] * (width - len(row)) + row for row in rows]),
        "attention_mask": mask,
        "position_ids": (mask.cumsum(-1) - 1).clamp(min=0),
        "completion": torch.arange(longest) >= longest - answers[:, None],
    }
