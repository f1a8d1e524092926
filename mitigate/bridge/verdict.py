"""How a condition goes, in a line, and why one does not count, though its command ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mitigate.bridge.command import SHOWN
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.hook.mitigate_hook import CLOSE, RESET
from mitigate.bridge.results import CUT_OFF, NORMALISED, Told, near, unjudged, without_path
from mitigate.bridge.subset import SETTLED
from mitigate.core.names import counted
from mitigate.evaluation.metrics import RULES

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


def summary(cell: Cell) -> str:
    """How far it is: "41 episodes, success 58.5 (own: ...), 2 without a path ..."."""
    told, found = cell.told(), cell.rows()
    asks = "" if cell.rule is None else str(RULES[cell.rule])
    first = asks or (found[0]["rule"] if found else "")
    own = [row["success"] for row in found if row["rule"] == first]
    said = [counted(len(told.ends), "episode") + asked(cell, told)]
    said += [f"success {100 * sum(own) / len(own):.1f} ({first})"] if own else []
    said += [f"{len(told.lost)} left in the middle"] if told.lost else []
    unknown = without_path(told, cell.rule)
    alike = len(set(unknown.values())) == 1 and len(unknown) == len({row["rule"] for row in found})
    for rule, count in list(unknown.items())[: 1 if alike else None]:
        by = "" if alike else f" by {rule}"
        said.append(f"{count} without a path{by}: SPL is success")
    for how, name in ((RESET, "reset"), (CLOSE, "closed")):
        left = sum(end.get("how") == how for end in told.ends.values())
        if 0 < left < len(told.ends):
            said.append(f"{left} {name} before the end (counted as it stood)")
    said += [f"{told.again} ended twice (the first counts)"] if told.again else []
    silent = len(told.ends) - len(own)
    said += [f"{silent} without a result"] if silent and found else []
    return ", ".join(said)


def asked(cell: Cell, told: Told) -> str:
    """Whether many more episodes were walked than were asked for, and why."""
    count = len(told.ends) if cell.chosen is None else cell.chosen.count
    if len(told.ends) <= 1.5 * count:
        return ""
    return (
        f" ({count} asked for: processes came more than {SETTLED:g} s after the others, or each of "
        "many had to keep one)"
    )


def lacks(cell: Cell) -> str:
    """What ``rule=`` needs to judge episodes of a condition and they do not tell; empty if it can
    judge all: of some alone, success would be another."""
    told = cell.told()
    missing = {} if cell.rule is None else unjudged(told, cell.rule)
    if not missing:
        return ""
    unknown, count = next(iter(missing.items()))
    who = "no episode told"
    if count < len(told.ends):
        who = f"{count} of {counted(len(told.ends), 'episode')} did not tell"
    what = "whether the agent said STOP" if unknown == "stopped" else "how far the goal is"
    own = ", or leave rule= out to count the told success" if _tells_success(cell) else ""
    return f"rule={cell.rule} needs to know {what}, which {who}: finish({unknown}=...){own}."


def _tells_success(cell: Cell) -> bool:
    return any("success" in end.get("metrics", {}) for end in cell.told().ends.values())


def strange(cell: Cell) -> str:
    """What is strange in what a condition's cameras read; empty if nothing is."""
    names = near(cell.told())
    if not names:
        return ""
    return (
        f"run: the depth of {', '.join(names)} counts as metres, and read no more than 1 in any "
        f"episode: {NORMALISED}"
    )


def problem(cell: Cell, status: int) -> str:
    """Return what went wrong under a command that ended with ``status``, empty if nothing did."""
    told = cell.told()
    if told.refused:
        return told.refused[0]
    if status:
        hint = f"\n{CRASH}" if told.lost else ""
        return f"the command ended with status {status}.{cell.said()}{hint}"
    if cell.left and not told.lost:
        return _ran_on(cell)
    return _unseen(cell, told) or _unfinished(cell, told) or _too_few(cell, told)


def _ran_on(cell: Cell) -> str:
    """What if processes of the command ran on when it had ended."""
    names = ", ".join(cell.left[:SHOWN]) + ", ..." * (len(cell.left) > SHOWN)
    count = "1 process" if len(cell.left) == 1 else f"{len(cell.left)} processes"
    return (
        f"the command ended, but {count} that it started "
        f"ran on: {names}. They were ended, and the condition is not finished. The command must "
        "wait for what it starts (without &, nohup or setsid), and must end its helpers itself. "
        f"Change it, and run again.{cell.said()}"
    )


def _too_few(cell: Cell, told: Told) -> str:
    """What if fewer episodes ended than the program or ``episodes=`` announced."""
    chosen = cell.chosen.least() if cell.chosen is not None and cell.clean is None else 0
    least = max(told.announced, chosen)
    if len(told.ends) >= least:
        return ""
    who = "wanted() returned" if told.announced == least else "episodes= chose"
    return (
        f"the command ended after {counted(len(told.ends), 'episode')}, and {who} {least}. Let it "
        "run all of them; if it is to run fewer, choose these by episodes=, or give wanted() these "
        f"alone. Then run again; the condition is measured again.{cell.said()}"
    )


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
            "the command ended without an episode. Did it find results of an earlier run, or of "
            "another condition? Delete them, and let it write to {out} in the command, which "
            f"stands for {cell.folder}: of each condition one, empty as it starts.{cell.said()}"
        )
    return ""


def _unfinished(cell: Cell, told: Told) -> str:
    """What if episodes are not there, or say nothing."""
    if told.lost:
        return (
            f"the command ended, but {left_out(told)}. Run again; the condition is measured anew. "
            f"{CRASH}{cell.said()}"
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
    if lacks(cell):
        return lacks(cell)
    if not cell.rows():
        return (
            f"of {counted(len(told.ends), 'episode')} that ended none said how it went, so there "
            "is no row: "
            "the metrics hold no success, and neither they nor the simulator a distance to a goal. "
            "Add the Success measure to the task, or call episode.finish(success=...)."
        )
    return ""


def left_out(told: Told) -> str:
    """Return "2 episodes were left in the middle, such as s0/2: a process of it died ..."; one
    whose reason is known comes first."""
    name = next((name for name in told.lost if told.dropped[name]), told.lost[0])
    why = told.dropped[name] or "a process of it died, or its loop gave up"
    if told.dropped[name] not in ("", CUT_OFF):
        why = (
            f"it was reset or closed as an exception went by, {why}; if the program ends its "
            "episodes by that, let it reset or close behind the except block"
        )
    verb = "was" if len(told.lost) == 1 else "were"
    return f"{counted(len(told.lost), 'episode')} {verb} left in the middle, such as {name}: {why}"


def lacking(cell: Cell, missing: list[str]) -> str:
    """Return "3 of clean's 6 episodes are missing"."""
    verb = "is" if len(missing) == 1 else "are"
    return f"{len(missing)} of clean's {counted(len(cell.of_clean()), 'episode')} {verb} missing"
