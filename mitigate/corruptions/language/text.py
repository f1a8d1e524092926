"""Check that texts can be corrupted: they must be in English and hold a word."""

from __future__ import annotations

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


def is_english(language: str | None) -> bool:
    """Return whether a language code or name means English.

    "en" and "en-US" do, in any case, and so does a missing language (None or empty).
    """
    return not language or language.lower().startswith("en")


def passed_through(languages: Mapping[str, int]) -> str:
    """Return a message with the number of instructions per language that were not corrupted."""
    which = ", ".join(f"{count} in {language}" for language, count in languages.items())
    return f"instructions in other languages passed through unchanged: {which}"
