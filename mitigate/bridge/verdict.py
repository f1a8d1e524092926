"""Why a condition does not count, though its command ended: one paragraph."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.results import Told
from mitigate.core.names import counted

if TYPE_CHECKING:
    from mitigate.bridge.cell import Cell

CRASH = (
    "Where the agent crashes on what it sees or hears, a loop of its own counts that as a failure: "
    "try ... except, and episode.finish(success=False) (docs/bridge.md)."
)
REASON = 100  # characters of why a condition failed, before it is told in full (ours)


def outcome(cell: Cell, problem: str, alone: bool) -> str:
    """One line on a condition that ended: its summary, or that it failed. Why is told in full at
    the end, which is now where it ran ``alone``."""
    if not problem:
        return cell.summary()
    first = problem.splitlines()[0]
    return "failed" if alone else f"failed: {first[:REASON]}{'...' * (len(first) > REASON)}"


def problem(cell: Cell, status: int) -> str:
    """Return what went wrong under a command that ended with ``status``, empty if nothing did."""
    told = cell.told()
    if told.refused:
        return told.refused[0]
    if status:
        hint = f"\n{CRASH}" if told.lost else ""
        return f"the command ended with status {status}.{cell.said()}{hint}"
    return _unseen(cell, told) or _unfinished(cell, told)


def _unseen(cell: Cell, told: Told) -> str:
    """What if nothing of the agent passed the bridge."""
    if not told.hellos and not cell.loaded:
        return (
            "the command ended, but no Python process of it loaded the hook. Does a script "
            "replace PYTHONPATH (let it append), does it run python with -E, -I or -S, or in a "
            f"container (docs/bridge.md)?{cell.said()}"
        )
    if not told.hellos:
        return (
            "the command ended, and its Python loaded the hook, but it imported neither "
            "habitat-lab nor habitat-sim and never called mitigate_hook.connect, so that nothing "
            "of it passed the bridge. A loop of your own calls three functions (docs/bridge.md)."
            f"{cell.said()}"
        )
    if mitigate_hook.ADAPTERS in cell.environment and not told.adapted:
        return (
            "the adapters were never put in: no instance of the class that adapters= names was "
            "called. Which class holds the encoder?"
        )
    if not told.ends and not told.lost:
        return (
            "the command ended without an episode. Did it find results of an earlier run? Let "
            "it write to a folder of each condition: {out} or {condition} in the command "
            f"stands for one.{cell.said()}"
        )
    return ""


def _unfinished(cell: Cell, told: Told) -> str:
    """What if episodes are not there, or say nothing."""
    if told.lost:
        return (
            f"the command ended, but {counted(len(told.lost), 'episode')} "
            f"{'was' if len(told.lost) == 1 else 'were'} left in the middle, such as "
            f"{told.lost[0]}: a process of it died, its loop gave up, or its Env was closed before "
            f"the episode was over. Run again; the condition is measured anew. {CRASH}{cell.said()}"
        )
    if told.connected > 0:
        return (
            "the command ended, but processes of it went on, and nobody knows what they left in "
            "the middle: let it wait for them, and run again."
        )
    missing = cell.missing()
    if missing:
        return (
            f"{lacking(cell, missing)}, such as {missing[0]}: a process of it died or gave up "
            "before its first step, or it draws its episodes at random (fix its seed, and choose "
            f"some by episodes=). Run again; the condition is measured anew. {CRASH}{cell.said()}"
        )
    beyond = cell.beyond()
    if beyond:
        return (
            f"{counted(len(beyond), 'episode')} ended under it that clean's run lacks, such as "
            f"{beyond[0]}: "
            "a process of clean's died or gave up before its first step, or the command draws its "
            "episodes at random (fix its seed, and choose some by episodes=). Run again; clean is "
            f"measured anew, too. {CRASH}"
        )
    if not cell.rows():
        return (
            f"of {counted(len(told.ends), 'episode')} that ended none said how it went, so there "
            "is no row: "
            "the metrics hold no success, and neither they nor the simulator a distance to a goal. "
            "Add the Success measure to the task, or call episode.finish(success=...)."
        )
    return ""


def lacking(cell: Cell, missing: list[str]) -> str:
    """Return "3 of clean's 6 episodes are missing"."""
    verb = "is" if len(missing) == 1 else "are"
    return f"{len(missing)} of clean's {counted(len(cell.of_clean()), 'episode')} {verb} missing"
