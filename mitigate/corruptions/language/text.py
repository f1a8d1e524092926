"""Check that texts can be corrupted: they must be in English and hold a word."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping


def has_word(text: object) -> bool:
    """Return whether ``text`` is a string with a letter or digit."""
    return isinstance(text, str) and any(character.isalnum() for character in text)


def check_text(text: str) -> None:
    """Raise ValueError if ``text`` holds no word."""
    if not has_word(text):
        raise ValueError(
            f"The instruction is empty: {text!r:.60} holds no word. Give the sentence that the "
            "agent is to follow, or leave the episode out."
        )


def is_english(language: str | None, text: str = "") -> bool:
    """Return whether a language code or name means English.

    "en" and "en-US" do, in any case. Without a language (None or empty), ``text`` must not be in
    another script: at least half of its letters must be Latin.
    """
    if language:
        return language.lower().startswith("en")
    letters = [character for character in text if character.isalpha()]
    latin = sum(unicodedata.name(letter, "").startswith("LATIN") for letter in letters)
    return 2 * latin >= len(letters)


UNMARKED = "an unknown language (not in Latin script)"  # of texts without a language


def passed_through(languages: Mapping[str, int]) -> str:
    """Return a message with the number of instructions per language that were not corrupted."""
    which = ", ".join(f"{count} in {language}" for language, count in languages.items())
    return f"instructions in other languages passed through unchanged: {which}"
