"""Tokenize corrupted instructions with the vocabulary of an R2R-CE file or a named tokenizer."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, TypeGuard

VOCABULARY = "vocabulary"
_WORD = re.compile(r"\[\w+\]|\w+(?:-\w+)*|[^\w\s]", re.UNICODE)


class FileVocabulary:
    """Tokenizer that uses the ``instruction_vocab`` of an R2R-CE file.

    Tokens are lower-case words and punctuation. The vocabulary has no mask token, so "[MASK]" gets
    the id of unknown words.
    """

    mask_token: str | None = None

    def __init__(self, vocabulary: Mapping[str, Any]) -> None:
        self._numbers = vocabulary["word2idx_dict"]
        self._unknown, self._pad = vocabulary["UNK_INDEX"], vocabulary["PAD_INDEX"]

    def encode(self, text: str, length: int | None) -> tuple[tuple[int, ...], bool]:
        """Return the token ids and whether they were truncated.

        If ``length`` is set, the ids are padded or truncated to this length. Unknown words get the
        id of unknown words, and unknown punctuation is removed.
        """
        ids = [
            self._numbers.get(word, self._unknown)
            for word in _WORD.findall(text.lower())
            if word in self._numbers or len(word) > 1 or word.isalnum()
        ]
        return _fitted(ids, length, self._pad)


class NamedTokenizer:
    """A tokenizer of the transformers package, loaded by folder or hub name."""

    def __init__(self, name: str) -> None:
        try:
            from transformers import AutoTokenizer
        except ImportError as error:
            raise ValueError(
                f"tokenizer={name} needs transformers, which is not installed ({error}). Run pip "
                f"install transformers, or use the vocabulary of the file (tokenizer={VOCABULARY})."
            ) from error
        try:
            self._tokenizer = AutoTokenizer.from_pretrained(name, trust_remote_code=False)
        except (OSError, ValueError) as error:
            raise ValueError(
                f"There is no tokenizer {name!r} ({' '.join(str(error).split())[:200]}): give "
                f"'{VOCABULARY}' (the vocabulary of the file), the folder of a tokenizer, or its "
                "hub name, such as bert-base-uncased for ETPNav on R2R-CE."
            ) from error
        self.mask_token: str | None = self._tokenizer.mask_token

    def encode(self, text: str, length: int | None) -> tuple[tuple[int, ...], bool]:
        """Return the token ids and whether they were truncated, as ``FileVocabulary.encode``.

        The begin and end tokens are kept if the text is truncated.
        """
        ids = list(self._tokenizer(text)["input_ids"])
        cut = length is not None and len(ids) > length
        if cut:
            ids = list(self._tokenizer(text, truncation=True, max_length=length)["input_ids"])
        return _fitted(ids, length, self._tokenizer.pad_token_id or 0)[0], cut


Tokenizer = FileVocabulary | NamedTokenizer


def tokenizer_for(name: str, extras: Mapping[str, Any]) -> Tokenizer:
    """Return the tokenizer ``name``; ``extras`` are the top-level entries of the episode file.

    Raises ValueError if the tokenizer does not exist, or the file has no vocabulary.
    """
    if name != VOCABULARY:
        return NamedTokenizer(name)
    vocabulary = extras.get("instruction_vocab")
    if not _is_vocabulary(vocabulary):
        raise ValueError(
            "tokenizer=vocabulary needs the key instruction_vocab in the file, as in R2R-CE, with "
            "word2idx_dict (a whole number for each word), UNK_INDEX and PAD_INDEX (whole "
            "numbers). This file lacks it. Leave out the option to remove the tokens, or name the "
            "agent's tokenizer."
        )
    return FileVocabulary(vocabulary)


def _is_vocabulary(entry: Any) -> TypeGuard[Mapping[str, Any]]:
    if not isinstance(entry, Mapping) or not isinstance(entry.get("word2idx_dict"), Mapping):
        return False
    numbers = (*entry["word2idx_dict"].values(), entry.get("UNK_INDEX"), entry.get("PAD_INDEX"))
    return all(type(number) is int for number in numbers)


def _fitted(ids: list[int], length: int | None, pad: int) -> tuple[tuple[int, ...], bool]:
    if length is None:
        return tuple(ids), False
    return tuple(ids[:length] + [pad] * (length - len(ids))), len(ids) > length
