"""Which texts are corrupted: those that hold a word, in English; what is said of the others."""

from __future__ import annotations

from collections.abc import Mapping


def has_word(text: object) -> bool:
    """Return whether ``text`` is a text with a letter or a digit in it."""
    return isinstance(text, str) and any(character.isalnum() for character in text)


def check_text(text: str) -> None:
    """Raise ValueError if ``text`` holds no word."""
    if not has_word(text):
        raise ValueError(
            f"The instruction is empty: {text!r:.60} holds no word. Give the sentence that the "
            "agent is to follow, or leave the episode out."
        )


def is_english(language: str | None) -> bool:
    """Return whether a language code or name is English's: "en", "en-US" ... in any case; so is
    what names none (None or empty)."""
    return not language or language.lower().startswith("en")


def passed_through(languages: Mapping[str, int]) -> str:
    """Say how many instructions of which ``languages`` were not corrupted."""
    which = ", ".join(f"{count} in {language}" for language, count in languages.items())
    return f"instructions in other languages passed through unchanged: {which}"
