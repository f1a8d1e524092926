"""Addresses of chat endpoints: a URL stands in names of results and in logs, so it holds no secret.

No message here repeats a URL.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from urllib.parse import urlsplit

_WRITE = (
    "Write http:// or https:// and the path up to /chat/completions, such as "
    "http://localhost:8000/v1 (as a safeguard: http://localhost:8000/v1@name-of-the-model)."
)
_MODEL = re.compile(r"[\w.:/+-]+")


def check_url(url: str) -> None:
    """Raise ValueError for an invalid URL, or a URL that holds a user, a password or a key."""
    if any(mark in url for mark in "@?#"):
        raise ValueError(
            "The endpoint's URL holds a user, a password or a key (an @, ? or # in it), which "
            "would get into the names of results. Give the key in the environment variable "
            f"OPENAI_API_KEY. {_WRITE}"
        )
    try:
        parts = urlsplit(url)
        good = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    except ValueError:
        good = False
    if not good or not url.isascii() or not url.isprintable() or " " in url:
        raise ValueError(f"What is given as the endpoint is no URL. {_WRITE}")


def check_choice(choice: str) -> None:
    """As :func:`check_url`, of a safeguard ``URL@model``; any other choice passes. To be called
    before the choice is shown or written anywhere."""
    choice = choice.removeprefix("tagger+").removeprefix("reader+")
    if not choice.lower().startswith(("http:", "https:")):
        return
    url, at, model = choice.rpartition("@")
    check_url(url if at else choice)
    if not _MODEL.fullmatch(model) or ("/" in model and not urlsplit(url).path):
        raise ValueError(  # without a path, what is before the @ may be a password
            "The name of the model behind the endpoint's last @ is none, or may be a host. "
            f"{_WRITE} Where there is no path, end the URL in a slash."
        )


def check_arguments(arguments: Iterable[str]) -> None:
    """As :func:`check_choice`, of a command line's ``safeguard=...``, before Hydra repeats it."""
    for argument in arguments:
        name, _, value = argument.lstrip("+").partition("=")
        if name == "safeguard":
            check_choice(value.strip("\"'"))
