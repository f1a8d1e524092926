"""Define landmarks, which are nouns for visible things, and their synonyms."""

from __future__ import annotations

from mitigate.corruptions.language.words import WORDS, listed

# maps a canonical name to its synonyms; phrases are matched before single nouns
SYNONYMS: dict[str, list[str]] = WORDS["landmarks"]
# nouns that are not landmarks, such as parts of a route and words in polite phrases
PLAIN = listed("no_landmarks")

CANONICAL = {form: name for name, forms in SYNONYMS.items() for form in forms if " " not in form}
PHRASES = {
    tuple(form.split()): name
    for name, forms in SYNONYMS.items()
    for form in (name, *forms)
    if " " in form
}
LONGEST = max(map(len, PHRASES))
_KEEP_S = ("ss", "us", "is", "as", "os")


def normal(noun: str) -> str:
    """Return the canonical name of a noun: the main word of its group, singular, lower case."""
    word = noun.lower().removesuffix("'s").removesuffix("s'")
    if word in CANONICAL or word in SYNONYMS:
        return CANONICAL.get(word, word)
    single = _singular(word)
    return CANONICAL.get(single, single)


def _singular(word: str) -> str:
    if len(word) < 4 or not word.endswith("s") or word.endswith(_KEEP_S):
        return word
    if word.endswith("ies"):
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "sses", "xes", "zes")):
        return word[:-2]
    if word.endswith("lves"):
        return word[:-3] + "f"
    return word[:-1]
