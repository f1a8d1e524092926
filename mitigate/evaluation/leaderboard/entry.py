"""Define a leaderboard entry: the results of an agent, and the rows from which they come.

Entries are untrusted JSON files. :func:`load` checks the type, length and range of each value,
and every figure can be recomputed from the rows that the entry names.
"""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, get_type_hints

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError, with_config
from typing_extensions import TypedDict

from mitigate.core import output
from mitigate.core.files import write_text
from mitigate.core.json_files import read_json
from mitigate.core.names import counted, short
from mitigate.evaluation.bootstrap import NO_INTERVAL
from mitigate.evaluation.page.model import Numbers

FORMAT = 2  # 2: with ``listed``
# maximum size of an entry's file in bytes; an entry with 34 corruptions takes about 5,000 bytes
LARGEST = 1 << 18
# maximum PRS in an entry; the ratio grows without bound if the clean value is near 0
GREATEST_PRS = 100.0
_REWRITE = "Write it again with `mitigate leaderboard add`."
_NUMBERS = re.compile(r"\[\n\s+([\d\s.,eE+nul-]*?)\s*\n\s+\]")
_STRICT = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)


def _is_printable(text: str) -> str:
    if not text.isprintable() or text.isspace():
        raise ValueError("it must be one line of printable characters")
    return text


def _is_inside(path: str) -> str:
    if ".." in PurePosixPath(path).parts or "\\" in path or path.startswith(("/", "~")):
        raise ValueError("it must be a path below this folder")
    return path


def _is_interval(numbers: Numbers) -> Numbers:
    value, *bounds = numbers or [0.0]
    known = [bound for bound in bounds if bound is not None]
    if value is None or known != sorted(known):
        raise ValueError("it must be [value, low, high] with low <= high")
    return numbers


def _are_shares(rates: dict[str, Numbers]) -> dict[str, Numbers]:
    if any(number is not None and number > 1 for row in rates.values() for number in row or ()):
        raise ValueError("SR and SPL must be from 0 to 1")
    return rates


def _are_scores(scores: dict[str, Numbers]) -> dict[str, Numbers]:
    if not {"Clean SR", "Clean SPL"} <= scores.keys():
        raise ValueError("Clean SR and Clean SPL must be among the titles")
    _are_shares({title: scores[title] for title in scores if not title.startswith("PRS")})
    return scores


def _have_clean(rates: dict[str, Numbers]) -> dict[str, Numbers]:
    if "clean" not in rates:
        raise ValueError("clean must be among the conditions")
    return _are_shares(rates)


Line = Annotated[str, Field(min_length=1, max_length=200), AfterValidator(_is_printable)]
Text = Annotated[str, Field(max_length=2000), AfterValidator(_is_printable)]
_Link = Annotated[Text, Field(max_length=200)]
Count = Annotated[int, Field(ge=1, le=10**8)]
_Number = Annotated[float, Field(ge=0, le=GREATEST_PRS)]
_Numbers = Annotated[list[_Number | None], Field(min_length=3, max_length=3)]
_Interval = Annotated[_Numbers | None, AfterValidator(_is_interval)]
_Title = Annotated[str, Field(pattern=r"^((Clean|Mean) (SR|SPL)|PRS-(SR|SPL) \([\w ,]{1,40}\))$")]
_Condition = Annotated[str, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.+-]{0,99}$")]
_Conditions = Annotated[dict[_Condition, _Interval], Field(min_length=2, max_length=500)]
_Rates = Annotated[_Conditions, AfterValidator(_have_clean)]


@with_config(_STRICT)
class Agent(TypedDict):
    """The content hash of an agent (``agents/fingerprint.py``), and the seed in its rows."""

    agent: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]{1,64}$")]
    seed: Annotated[int, Field(ge=-(2**63), le=2**63)]


@with_config(_STRICT)
class Source(TypedDict):
    """The path of the row file (relative, or empty), its sha256 and the number of rows."""

    file: Annotated[_Link, AfterValidator(_is_inside)]
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    count: Count


@dataclass(frozen=True)
class LeaderboardEntry:
    """The results of an agent on one split, suite, success rule and severity.

    Attributes:
        name: heading of the entry in the leaderboard.
        agents: for each training seed, the content hash of its agent (``agents/fingerprint.py``)
            and the seed in its rows.
        sensors: one line per sensor.
        training_data: text in which the submitter describes the agent's training data.
        episodes: number of episodes per condition.
        listed: hash of the episode ids; a table compares only entries with the same episodes.
        scores: maps the title of a score, such as "Clean SR", to [value, low, high] with the bounds
            of the 95 % interval, or to None.
        SR, SPL: the success rate and SPL of each condition, in the same format.
        rows: the rows from which the figures are computed: "file" (a relative path, or empty),
            "sha256" and "count".
        link: address of the weights or the paper.
    """

    __pydantic_config__ = _STRICT
    name: Line
    agents: Annotated[tuple[Agent, ...], Field(min_length=1, max_length=100)]
    sensors: Annotated[tuple[Line, ...], Field(max_length=20)]
    training_data: Text
    split: Line
    suite: Line
    rule: Line
    severity: Annotated[float, Field(ge=0, le=1)]
    episodes: Count
    listed: Annotated[str, Field(pattern="^[0-9a-f]{12}$")]
    scores: Annotated[dict[_Title, _Interval], AfterValidator(_are_scores)]
    SR: _Rates
    SPL: _Rates
    rows: Source
    link: _Link = ""
    version: Line = field(default_factory=lambda: version("mitigate"))
    format: Annotated[int, Field(ge=FORMAT, le=FORMAT)] = FORMAT

    def save(self, path: Path | str) -> Path:
        """Write the entry to ``path`` as JSON, atomically.

        Raises:
            ValueError: If :func:`load` would reject the entry.
        """
        text = json.dumps(asdict(self), indent=1, allow_nan=False)
        _validated(_ADAPTER, text, f"{path}: ")
        # the substitution puts each list of numbers on one line
        write_text(path, _NUMBERS.sub(lambda match: f"[{' '.join(match[1].split())}]", text) + "\n")
        return Path(path)

    def __str__(self) -> str:
        """Return a string with one line per score and corruption; success rates are in %."""
        size = f"{counted(self.episodes, 'episode')} of {self.split}"
        lines = [f"{self.name}: {size}, severity {self.severity:g} ({self.rule})"]
        rates = {f"SR under {name}": rate for name, rate in self.SR.items() if name != "clean"}
        for title, numbers in {**self.scores, **rates}.items():
            is_rate = title.endswith(" SR") or title in rates
            scale, digits, unit = (100, 1, " %") if is_rate else (1, 2, "")
            texts = ["–" if x is None else f"{scale * x:.{digits}f}" for x in numbers or ()]
            text = "undefined"
            if numbers:
                same = numbers[1] == numbers[2]
                width = NO_INTERVAL if same else f"[{texts[1]}, {texts[2]}]"
                text = f"{texts[0]} {width}{unit}"
            lines.append(f"  {title}: {text}")
        return "\n".join(lines)


def load(path: Path | str) -> LeaderboardEntry:
    """Return the entry in the untrusted JSON file ``path``.

    Raises:
        FileNotFoundError: If the file does not exist.
        ValueError: If the file has more than :data:`LARGEST` bytes, if a key is missing or unknown,
            or if a value has a wrong type, length or range. The message names the file and the key.
    """
    path = Path(path)
    if not output.is_regular(path):
        raise FileNotFoundError(f"There is no entry {path}. {_REWRITE}")
    return _validated(_ADAPTER, json.dumps(read_json(path, _REWRITE, LARGEST)), f"{path}: ")


def check_texts(**texts: Any) -> None:
    """Raise ValueError for a text (name=..., link=...) that an entry cannot hold."""
    kinds = get_type_hints(LeaderboardEntry, include_extras=True)
    for key, text in texts.items():
        _validated(TypeAdapter(kinds[key], config=_STRICT), json.dumps(text), "", key)


_ADAPTER = TypeAdapter(LeaderboardEntry)


def _validated(adapter: TypeAdapter, text: str, where: str, key: str = "it") -> Any:
    """Return the value of a JSON text; raise a ValueError that names the key if it is invalid."""
    try:
        return adapter.validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        key, *inside = [str(place) for place in first["loc"]] or [key]
        place = ".".join(inside)
        reason = ": ".join(filter(None, [place, first["msg"].removeprefix("Value error, ")]))
        raise ValueError(
            f"{where}{short(key)[1:-1]} must be valid, not {short(first['input'])} ({reason:.200})."
        ) from None
