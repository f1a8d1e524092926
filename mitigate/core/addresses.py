"""Reject passwords and keys in the addresses of chat endpoints before any output can contain them.

Messages, file names and result rows contain the address of an endpoint. No error message of this
module contains the value that it rejects.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import urlsplit

_EXAMPLE = (
    "Write http:// or https:// and the path up to /chat/completions, such as "
    "http://localhost:8000/v1 (as a safeguard: http://localhost:8000/v1@name-of-the-model)."
)
_MODEL = re.compile(r"[\w.:/+-]+")
_PLAIN = re.compile(r"(?!(?:\w+\+)*(?:https?|ftp)/)[\w./~+ -]*", re.IGNORECASE)
# a part of a reference to a variable or an option, such as ${oc.env:URL}
_REFERENCE = re.compile(r"\$|oc\.env:\w+")
# characters that can surround a value in a Hydra list, mapping, sweep or quotation
_SEPARATORS = re.compile(r"[\s,=\"'\\(){}\[\]]+")
# the option safeguard=, or a misspelling of it, at the start of an argument or in a list
_SAFEGUARD = re.compile(r"(?:^|[^a-z])saf\w*g\w*[\"']?\s*[=:]", re.IGNORECASE)
_NAME = re.compile(r"[-+~]*saf\w*g\w*=?", re.IGNORECASE)
# the separator before the next option in a list of options, and the name of that option
_NEXT = re.compile(r"[\s,\"'\[]+[\w.@+~-]+=")
# the values of other options may contain "@" or "//", but not a URL with "@"
_SECRET = re.compile(r"(?:https?|ftp)[:/]\S*[@?]", re.IGNORECASE)
_SUSPECT = re.compile(r"//|[@?#]|^(?:https?|ftp)[:/]", re.IGNORECASE)


def check_url(url: str) -> None:
    """Raise ValueError if ``url`` is not a URL, or if it contains a user, a password or a key."""
    if any(mark in url for mark in "@?#"):
        raise ValueError(
            "The endpoint's URL must not contain @, ? or #, because a user, a password or a key in "
            "the URL would become part of names in the results. Give the key in the environment "
            f"variable OPENAI_API_KEY. {_EXAMPLE}"
        )
    try:
        parts = urlsplit(url)
        valid = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    except ValueError:
        valid = False
    if not valid or not url.isascii() or not url.isprintable() or " " in url:
        raise ValueError(f"The endpoint is not a valid URL. {_EXAMPLE}")


def check_choice(choice: object) -> None:
    """Raise ValueError if a value of ``safeguard=`` is not a string or is an invalid address.

    Names, paths without special characters and existing folders are accepted. All other values must
    have the form ``URL@model``. In any other form, a password in the URL could not be recognised.
    """
    if not isinstance(choice, str):
        raise ValueError(f"safeguard must be text, got a {type(choice).__name__}. {_EXAMPLE}")
    if is_plain(choice) or _is_folder(choice):
        return
    url, at, model = choice.rpartition("@")
    if not at and "//" not in choice:
        raise ValueError(
            "This value is neither the name of an existing safeguard nor the address of an "
            f"endpoint. A name or a path consists of letters, digits and . / ~ + - _. {_EXAMPLE}"
        )
    check_url(url if at else choice)
    if not _MODEL.fullmatch(model) or not urlsplit(url).path:
        raise ValueError(  # without a path, the part before the @ may be a password
            "The endpoint needs the name of a model after the last @, and a path before it. "
            f"{_EXAMPLE} If there is no path, end the URL with a slash."
        )


def is_plain(choice: object) -> bool:
    """Return True if a value of ``safeguard=`` is certainly not the address of an endpoint.

    Only such values may be shown in messages, because an address may contain a password.
    """
    return isinstance(choice, str) and bool(_PLAIN.fullmatch(choice)) and "//" not in choice


def check_arguments(arguments: Iterable[str]) -> None:
    """Check the addresses in command-line arguments before Hydra parses and prints them.

    A parser would print an invalid argument, with its secrets, in an error message. Therefore the
    arguments are split into parts without a parser. :func:`check_choice` checks every part of a
    value of ``safeguard=``. In all other arguments that seem to contain a URL with a secret, it
    checks the parts that look like addresses.
    """
    is_value = False  # whether the previous arguments are ``safeguard`` or ``safeguard =``
    for word in arguments:
        values = [(word[match.end() :], match.start()) for match in _SAFEGUARD.finditer(word)]
        for value, start in [*values, *([(word, 0)] if is_value else [])]:
            if not _is_folder(value):
                # in a list of options, the value of safeguard= ends where the next option begins
                parts = _SEPARATORS.split(_NEXT.split(value)[0] if "=" in word[:start] else value)
                for part in parts:
                    if not _REFERENCE.fullmatch(part):
                        check_choice(part)
        if _SECRET.search(word):
            for part in filter(_SUSPECT.search, _SEPARATORS.split(word)):
                check_choice(part)
        is_value = bool(_NAME.fullmatch(word)) or (is_value and word == "=")


def _is_folder(text: str) -> bool:
    try:
        return bool(text) and Path(text).is_dir()
    except (OSError, ValueError):  # the path is too long or contains a zero byte
        return False
