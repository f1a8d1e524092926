"""Instructions that come as a page: marks of how words look are taken off, the words stay.

What looks like a programme's or a model's own markup (``<system>``, ``[INST]``, comments) is left
to the rules: it is judged with what stands in it.
"""

from __future__ import annotations

import html
import re

# struck-through words (s, del) are not meant, so these are no mere looks
_LOOKS = r"(?:b|i|u|em|strong|span|mark|small|big|sub|sup|font|tt|a|q|abbr|bdi|wbr)"
_INLINE = re.compile(
    rf"</?{_LOOKS}(?:\s+[\w-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'|[^\s<>]+))*\s*/?>", re.I
)
_BREAK = re.compile(r"\s*<br\s*/?>\s*", re.I)
# Markdown: bold and slanted words, and a page's headings and lists
_BOLD = re.compile(r"(?<![\w*])(\*\*?)(?=[^\s*])([^*\n]*[^\s*])\1(?![\w*])")
_HEADING = re.compile(r"^[ \t]*#{1,6}[ \t]+(?=[^\s\d])", re.M)
_ITEM = re.compile(r"^[ \t]*[-*+•](?: \[[ xX]?\])?[ \t]+(?=\S)(.*)$", re.M)
_NUMBERED = re.compile(r"^[ \t]*(\d{1,2})[.)][ \t]+(?=\S)(.*)$", re.M)
_NUMBER = re.compile(r"\b(?:steps?|back to|number) \d", re.I)
_ENTITY = re.compile(r"&(?:amp|nbsp|lt|gt|quot|apos|#0?39|#160|ndash|mdash|[lr][sd]quo|hellip);")
_HALF = re.compile("[\ud800-\udfff]")  # of a character in two parts, cut in the middle
_SPACES = re.compile(r"\s{20,}")  # nobody means so many (ours)
_MARKS = re.compile(r"([^\w\s])\1{9,}")


def unformatted(text: str) -> str:
    """Return ``text`` without marks of how words look, HTML's names of characters, halves of
    characters, and long runs of spaces or of one mark; itself if it has none."""
    text = _MARKS.sub(r"\1\1\1", _near(text))
    if "<" in text:
        text = _BREAK.sub("\n", _near(_INLINE.sub("", text)))
    text = _BOLD.sub(r"\2", text)
    if "\n" in text:
        text = _listed(_HEADING.sub("", text))
    if "&" in text:
        text = _ENTITY.sub(lambda m: html.unescape(m.group()).replace("\xa0", " "), text)
    return _near(_HALF.sub("", text))


def _near(text: str) -> str:
    """Return ``text`` without long runs of spaces, over which the rules are slow."""
    return _SPACES.sub(lambda m: "\n" if "\n" in m.group() else " ", text)


def _listed(text: str) -> str:
    """Return ``text`` without the marks of its lists, each item with a mark at its end; numbers go
    that count from 1, if nothing speaks of them."""
    numbers = [int(match[1]) for match in _NUMBERED.finditer(text)]
    counts = len(numbers) > 1 and numbers == [*range(1, len(numbers) + 1)]
    if counts and not _NUMBER.search(text):
        text = _NUMBERED.sub(lambda match: _closed(match[2]), text)
    return _ITEM.sub(lambda match: _closed(match[1]), text)


def _closed(item: str) -> str:
    item = item.rstrip()
    return item if item.endswith((".", "!", "?", ":", ";", ",")) else f"{item}."
