"""What an agent is told: its instruction and tokens as a corruption and guards leave them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mitigate.corruptions import Corruption, Key, corrupt_instruction
from mitigate.corruptions.language.text import is_english
from mitigate.corruptions.language.tokens import VOCABULARY, Tokenizer, tokenizer_for
from mitigate.guards.guard import NO_GUARDS, EpisodeStart, Guards
from mitigate.worlds.episodes import read_extras

NO_TOKENIZER = (
    "the agent's episodes hold instruction tokens beside the text, and no tokenizer was named, so "
    "that it would read the old words: tokenizer=bert_config/bert-base-uncased (a folder with the "
    "tokenizer's files; ETPNav's repository has it), or tokenizer=EPISODES.json.gz for R2R-CE's "
    "own vocabulary in that file."
)


@dataclass
class Words:
    """Changes the words of episodes.

    tokenizer: for agents that read tokens; None: an agent with tokens is refused where its words
    change, since it would read the old ones. length: of padded tokens; None: as the episode's own.
    """

    tokenizer: Tokenizer | None = None
    length: int | None = None

    def heard(
        self,
        told: Mapping[str, Any],
        corruption: Corruption,
        key: Key,
        guards: Guards = NO_GUARDS,
    ) -> dict[str, Any]:
        """Return ``text`` and ``tokens`` of an episode as the agent is to have them; empty where
        they stay as they are. Raises ValueError where an agent would not hear the change.
        """
        text, tokens = told.get("text"), told.get("tokens")
        spoken = [part for part in corruption.parts if part.modality == "instruction"]
        if any(part.name == "white_box" for part in spoken):
            raise ValueError(
                "white_box is not applicable: it corrupts an agent's system prompt, which does not "
                "pass the bridge. black_box puts the same sentences in front of the instruction."
            )
        if not isinstance(text, str):
            if spoken:
                category = told.get("category")
                has = f"{category!r}, a category that agents read by number" if category else "none"
                raise ValueError(
                    f"{corruption.name} corrupts the words of an instruction, but the episode has "
                    f"{has}. Tell it, connect(..., instruction=...), or leave the corruption out."
                )
            return {}
        made = text
        for part in spoken if is_english(told.get("language")) else ():
            made = corrupt_instruction(made, part.name, part.severity, key, mask_token=self._mask())
        made = guards.begin(EpisodeStart(key, made))
        if made == text:
            return {}
        return {"text": made, "tokens": self._tokens(made, tokens)}

    def _mask(self) -> str:
        return (self.tokenizer and self.tokenizer.mask_token) or "[MASK]"

    def _tokens(self, text: str, before: list[Any] | None) -> list[int] | None:
        if before is None:
            return None
        if self.tokenizer is None:
            raise ValueError(NO_TOKENIZER)
        return list(self.tokenizer.encode(text, self.length or fixed_length(before))[0])


def tokenizer_of(name: str) -> Tokenizer:
    """Return the tokenizer in a folder or of a hub name, or the vocabulary of an R2R-CE file
    (``.json``, ``.json.gz``). Raises ValueError or FileNotFoundError if there is none."""
    if name.endswith((".json", ".json.gz")):
        return tokenizer_for(VOCABULARY, read_extras(name))
    return tokenizer_for(name, {})


def fixed_length(tokens: list[Any]) -> int | None:
    """Return the length that a dataset pads its tokens to, None if it does not pad: padding is a
    token that comes twice and more at the end."""
    repeated = len(tokens) > 2 and tokens[-1] == tokens[-2] and tokens[-1] in (0, 1)
    return len(tokens) if repeated else None
