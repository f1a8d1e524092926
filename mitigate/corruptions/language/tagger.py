"""Tag parts of speech (Universal POS) in instructions, with a built-in tagger or with spaCy.

The built-in tagger ("own") has lists of all function words, and of the verbs, adjectives and
adverbs that are common in navigation (``words.py``). If a word may belong to two classes, the
neighbouring words decide. Every other word is tagged as a noun.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from mitigate.corruptions.language import words

TOKEN = re.compile(r"\[\w+\]|<\w+>|[^\W_]+(?:['’][^\W_]+)*|[^\w\s]|_", re.UNICODE)
WORD = re.compile(r"[^\W_]")
TAGGERS = ("own", "spacy")
SENTENCE_ENDS = frozenset(".!?;:")
_NUMBER = re.compile(r"\d+(?:st|nd|rd|th)?$")
_BEFORE_NOUN = frozenset({"DET", "ADJ", "NUM"})


@dataclass(frozen=True)
class Token:
    """A word or punctuation mark: its text, start index, lower-case form and tag."""

    text: str
    start: int
    lower: str
    tag: str = "X"

    @property
    def end(self) -> int:
        """The index after the last character."""
        return self.start + len(self.text)

    @property
    def is_word(self) -> bool:
        """Whether this token is a word, and not punctuation or ``[MASK]``."""
        return bool(WORD.match(self.text))


NOTHING = Token("", 0, "")  # placeholder for the token before the first and after the last


def tokens(text: str) -> list[Token]:
    """Split ``text`` into untagged words, punctuation and special tokens such as ``[MASK]``."""
    return [
        Token(m.group(), m.start(), m.group().lower().replace("’", "'"))
        for m in TOKEN.finditer(text)
    ]


def tag(text: str) -> list[Token]:
    """Return the tokens of ``text`` with the tags of the built-in tagger."""
    untagged = tokens(text)
    tagged = [NOTHING]
    for token, after in zip(untagged, [*untagged[1:], NOTHING], strict=False):  # empty text
        tagged.append(replace(token, tag=_tag(token, tagged[-1], after)))
    return tagged[1:]


def named(name: str = "own") -> Callable[[str], list[Token]]:
    """Return the tagger ``name``: "own" (:func:`tag`) or "spacy" (an installed English pipeline).

    The default is "own", so that equal keys change the same words on every machine.
    Raises ValueError for an unknown name, or if no pipeline is installed.
    """
    if name not in TAGGERS:
        raise ValueError(f"tagger must be one of {', '.join(TAGGERS)}, got {name!r}.")
    if name == "own":
        return tag
    pipeline = _spacy()
    return lambda text: _spacy_tags(pipeline, text)


@lru_cache(maxsize=1)
def _spacy() -> Any:
    """Load an installed English spaCy pipeline; if there are several, the first one by name."""
    try:
        import spacy

        names = sorted(n for n in spacy.util.get_installed_models() if n.startswith("en_"))
    except ImportError:
        names = []
    if not names:
        raise ValueError(
            "tagger=spacy needs spaCy and an English pipeline, and none is installed. Install the "
            "extra nlp (pip install -e '.[nlp]') and a pipeline such as en_core_web_sm, or use "
            "tagger=own."
        )
    return spacy.load(names[0], exclude=["ner", "lemmatizer"])


def _spacy_tags(pipeline: Any, text: str) -> list[Token]:
    """Return the tokens of the built-in tagger with the tags of ``pipeline``.

    Words in ``OVERRIDES``, which the pipeline often tags wrongly, keep the built-in tag.
    """
    places = {token.idx: token.pos_ for token in pipeline(text)}
    return [
        token
        if token.lower in words.OVERRIDES or token.start not in places
        else replace(token, tag=places[token.start])
        for token in tag(text)
    ]


def _tag(token: Token, before: Token, after: Token) -> str:
    word = token.lower
    if not token.is_word:
        return "X" if len(word) > 1 else "PUNCT"
    if _NUMBER.match(word):
        return "NUM" if word.isdigit() else "ADJ"
    if word.endswith(("'m", "'re", "'ve", "'ll", "'d")):
        return "PRON"
    if word == "there":
        return "PRON" if after.lower in ("is", "are", "will") else "ADV"
    if word == "back":
        return "NOUN" if _determined(before) and not _can_be_noun(after) else "ADV"
    if word == "passed" and before.tag == "AUX":
        return "VERB"
    if word in words.AMBIGUOUS:
        return _by_context(word, before, after)
    if word in words.TAGS:
        return words.TAGS[word]
    if word.endswith("ly"):
        return "ADV"
    if word.endswith("ing") and not _determined(before):
        return "VERB"
    if word.endswith(("ed", "ish", "ous", "ful", "less")) and after.is_word:
        return "ADJ"
    return "NOUN"


def _by_context(word: str, before: Token, after: Token) -> str:
    """Choose between the two classes of a word by its neighbours.

    After a determiner, for example, the word is a noun.
    """
    first, second = words.AMBIGUOUS[word]
    if word in ("left", "right"):
        return _side(before, after)
    if word == "to":
        return "PART" if after.lower in words.VERBS else "ADP"
    if (first, second) == ("DET", "PRON"):
        return first if _begins_noun(after) else second
    if (first, second) == ("ADP", "ADV"):
        return first if after.lower == "of" or _begins_noun(after) else second
    if (first, second) == ("VERB", "NOUN"):
        is_command = before.tag in ("PART", "AUX")
        return first if is_command or not (_determined(before) or _governed(before)) else second
    if (first, second) == ("ADJ", "NOUN"):
        return first if _can_be_noun(after) else second
    return first if _determined(before) or before.tag == "AUX" else second


def _side(before: Token, after: Token) -> str:
    """Tag the word "left" or "right"; after "the" or "your", it is a noun or an adjective."""
    if before.lower in words.POSSESSORS:
        return "ADJ" if _can_be_noun(after) else "NOUN"
    if before.lower in ("have", "has", "you've", "having"):
        return "VERB"
    return "ADV"


def _determined(before: Token) -> bool:
    return before.tag in _BEFORE_NOUN or before.lower in words.POSSESSORS


def _governed(before: Token) -> bool:
    return before.lower in ("of", "with", "to", "by", "from", "in", "at")


def _begins_noun(after: Token) -> bool:
    if not after.is_word:
        return False
    known = words.TAGS.get(after.lower)
    return known in (None, "DET", "ADJ", "NUM", "PRON") or after.lower in words.AMBIGUOUS_NOUNS


def _can_be_noun(after: Token) -> bool:
    if not after.is_word:
        return False
    if after.lower in words.AMBIGUOUS:
        return after.lower in words.AMBIGUOUS_NOUNS
    return words.TAGS.get(after.lower) in (None, "ADJ", "NUM")
