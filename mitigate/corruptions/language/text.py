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
            f"The instruction must contain a word, got {text!r:.60}. Give the sentence that the "
            "agent should follow, or leave out the episode."
        )


def is_english(language: str | None, text: str = "") -> bool:
    """Return whether a text is in English, by its language code or language name.

    A text is in English if its code or name begins with "en", in upper or lower case: for example
    "en", "en-US" or "English". If no language is given (None or empty), at least half of the
    letters in ``text`` must be Latin.
    """
    if language:
        return language.lower().startswith("en")
    letters = [character for character in text if character.isalpha()]
    latin = sum(unicodedata.name(letter, "").startswith("LATIN") for letter in letters)
    return 2 * latin >= len(letters)


# in counts per language, the label for texts that have no language code
UNMARKED = "an unknown language (not in Latin script)"


def passed_through(languages: Mapping[str, int]) -> str:
    """Return a message that lists, per language, how many instructions were not corrupted."""
    which = ", ".join(f"{count} in {language}" for language, count in languages.items())
    return f"instructions in other languages passed through unchanged: {which}"
