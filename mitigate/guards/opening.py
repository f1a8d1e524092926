"""Build guards from the options ``safeguard=``, ``restore=`` and ``adapt=``.

Only the modules of the chosen guards are imported.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mitigate.guards.adaptation import choices as adaptations
from mitigate.guards.frames import choices as restorers
from mitigate.guards.frames.choices import HOLD, SENSORS, callable_of, parted
from mitigate.guards.guard import EpisodeStart, Guard, Guards

if TYPE_CHECKING:
    from mitigate.guards.text.guard import Safeguard

NONE = (None, "none")


class TextGuard(Guard):
    """A guard that applies a safeguard (``safeguard=``) to instructions.

    Args:
        safeguard: the safeguard that repairs instructions.
        label: part of a table's column name (:class:`Guard`).
    """

    def __init__(self, safeguard: Safeguard, label: str) -> None:
        self.safeguard = safeguard
        self.label = label

    def begin(self, episode: EpisodeStart) -> str:
        return self.begin_all([episode])[0]

    def begin_all(self, episodes: Sequence[EpisodeStart]) -> list[str]:
        decisions = self.safeguard.canonicalise_all([e.instruction for e in episodes])
        return [decision.text for decision in decisions]

    def prepared(self, episodes: Sequence[EpisodeStart]) -> Guard:
        """Compute all answers here, so that workers need no copy of the language model."""
        texts = [episode.instruction for episode in episodes]
        answers = dict(zip(texts, self.begin_all(episodes), strict=True))
        return AnsweredText(answers, self.label, self.fingerprint())

    def fingerprint(self) -> str:
        return self.safeguard.identity


class AnsweredText(Guard):
    """A guard for worker processes that contains the precomputed answers of a :class:`TextGuard`.

    Texts without a precomputed answer stay unchanged.
    """

    def __init__(self, answers: dict[str, str], label: str, fingerprint: str) -> None:
        self.answers = answers
        self.label = label
        self._fingerprint = fingerprint

    def begin(self, episode: EpisodeStart) -> str:
        return self.answers.get(episode.instruction, episode.instruction)

    def fingerprint(self) -> str:
        return self._fingerprint


def open_guards(
    safeguard: str | None,
    restore: str | None,
    sensors: Collection[str] = SENSORS,
    log: str | Path | None = None,
    adapt: str | Guard | None = None,
) -> Guards:
    """Build the guards of the three options, starting with the safeguard.

    Args:
        safeguard: value of ``safeguard=`` (``text/guard.py``), or None.
        restore: value of ``restore=`` (:func:`open_restorer`).
        sensors: names of the world's sensors.
        log: file for the decisions of the safeguard.
        adapt: a value as in ``adaptation/choices.py``, or a guard. The caller must call
            ``calibrate`` before the first episode.
    """
    guards: list[Guard] = []
    restorer = open_restorer(restore, sensors)
    if safeguard not in NONE:
        from mitigate.guards.text.choices import label
        from mitigate.guards.text.guard import open_safeguard

        if opened := open_safeguard(str(safeguard), log=log):
            guards.append(TextGuard(opened, label(str(safeguard))))
    return Guards([*guards, *([] if restorer is None else [restorer]), *open_adaptations(adapt)])


def open_restorer(choice: str | None, sensors: Collection[str] = SENSORS) -> Guard | None:
    """Build the guard that ``restore=`` selects. If ``choice`` is None or "none", return None.

    Raises:
        FileNotFoundError: If the folder contains no restorer.
        ValueError: If the restorer is damaged, the callable does not exist, or the guard changes no
            sensor in ``sensors``.
    """
    if choice in NONE:
        return None
    if choice == HOLD:
        from mitigate.guards.frames.hold import HoldLast

        guard: Guard = HoldLast()
    elif callable_of(str(choice)) is not None:
        from mitigate.guards.frames.callables import open_callable

        guard = open_callable(str(choice))
    else:
        from mitigate.guards.frames.restorer import load_restorer

        folder, only = parted(str(choice))
        restorer = load_restorer(folder)
        guard = restorer if only is None else restorer.only(only)
        guard.label = restorers.label(str(choice))
    guard.check_shown(sensors, "the world")
    return guard


def open_adaptations(choice: str | Guard | None) -> list[Guard]:
    """Return the guards that ``adapt=`` names.

    Raises:
        ValueError: If a method or a reset in ``choice`` does not exist.
    """
    if isinstance(choice, Guard):
        return [choice]
    if choice in NONE:
        return []
    from mitigate.guards.adaptation.norm import Norm
    from mitigate.guards.adaptation.recentre import Recentre
    from mitigate.guards.adaptation.tent import Tent

    kinds: dict[str, type[Norm | Tent | Recentre]] = {
        kind.kind: kind for kind in (Norm, Tent, Recentre)
    }
    return [kinds[method](reset=reset) for method, reset in adaptations.parsed(str(choice))]


def labels(
    safeguard: str | None, restore: str | None, adapt: str | Guard | None = None
) -> list[str]:
    """Return the labels of the guards that the three options name, without building the guards."""
    names = []
    if safeguard not in NONE:
        from mitigate.guards.text import choices

        names.append(choices.label(str(safeguard)))
    if restore not in NONE:
        names.append(restorers.label(str(restore)))
    if isinstance(adapt, Guard):
        names.append(adapt.label)
    elif adapt not in NONE:
        names.append(adaptations.label(str(adapt)))
    return names
