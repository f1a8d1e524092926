"""Which instructions are corrupted: those in English; what is said of the others."""

from __future__ import annotations

from collections.abc import Mapping


def is_english(language: str | None) -> bool:
    """Return whether a language code or name is English's: "en", "en-US" ... in any case; so is
    what names none (None or empty)."""
    return not language or language.lower().startswith("en")


def passed_through(languages: Mapping[str, int]) -> str:
    """Say how many instructions of which ``languages`` were not corrupted."""
    which = ", ".join(f"{count} in {language}" for language, count in languages.items())
    return f"instructions in other languages passed through unchanged: {which}"
