"""Check that texts can be corrupted: they must be in English and contain a word."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping


def has_word(text: object) -> bool:
    """Return whether ``text`` is a string with a letter or digit."""
    return isinstance(text, str) and any(character.isalnum() for character in text)


def check_text(text: str) -> None:
    """Raise ValueError if ``text`` contains no word."""
    if not has_word(text):
        raise ValueError(
            f"The instruction is empty: {text!r:.60} holds no word. Give the sentence that the "
            "agent is to follow, or leave the episode out."
        )


def is_english(language: str | None, text: str = "") -> bool:
    """Return whether a language code or name means English.

    For example, "en" and "en-US" mean English, in upper or lower case. If no language is given
    (None or empty), at least half of the letters in ``text`` must be Latin.
    """
    if language:
        return language.lower().startswith("en")
    letters = [character for character in text if character.isalpha()]
    latin = sum(unicodedata.name(letter, "").startswith("LATIN") for letter in letters)
    return 2 * latin >= len(letters)


UNMARKED = "an unknown language (not in Latin script)"  # count of texts without a language code


def passed_through(languages: Mapping[str, int]) -> str:
    """Return a message with the number of instructions per language that were not corrupted."""
    which = ", ".join(f"{count} in {language}" for language, count in languages.items())
    return f"instructions in other languages passed through unchanged: {which}"
