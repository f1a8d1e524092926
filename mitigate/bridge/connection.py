"""One connection of the server: an environment of the user's command, and what it is answered.

What happens is noted as an event (``events.py``).
"""

from __future__ import annotations

import hmac
import mmap
import os
import secrets
import socket
import sys
import time
import traceback
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from mitigate.bridge.cameras import CHANNELS, Rig
from mitigate.bridge.condition import Condition
from mitigate.bridge.events import EVENTS, begun, ended, note
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.hook.mitigate_hook import BROKEN, LONGEST, receive, send
from mitigate.core.names import short, unknown


def numbered(message: Mapping[str, Any], answer: dict[str, Any]) -> dict[str, Any]:
    """An answer with the number of its message, by which it is known for it."""
    number = message.get("number")
    return {**answer, "number": number} if isinstance(number, int) else answer


def _one_thread() -> None:
    """Let torch compute on one thread: environments run side by side, and this is a fork."""
    import torch

    torch.set_num_threads(1)


def _said(kind: str, error: Exception) -> str:
    """What the agent's side is told of an error in the answer to a message."""
    if type(error) is ValueError:
        return str(error)
    if isinstance(error, OSError):  # of a disk of ours
        told = f"the run cannot write {error.filename}: {error.strerror}."
        return str(error) if error.strerror is None else told
    return (
        f"the message {kind!r} is not as the protocol has it ({short(repr(error), 200)}): use the "
        "mitigate_hook.py of this version."
    )


class SharedMemory:
    """Memory for frames that the server and an environment's process share.

    It is a file in ``folder``, mapped as ``map``. Its name is gone as soon as both sides mapped it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.map: mmap.mmap | None = None
        self.file: Path | None = None

    def make(self, size: int) -> dict[str, Any]:
        """Map ``size`` new bytes; return where the other side finds them. Raises ValueError if
        there is no room."""
        self.forget()
        self.file = self.folder / secrets.token_hex(8)
        descriptor = os.open(self.file, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.posix_fallocate(descriptor, 0, size)
            self.map = mmap.mmap(descriptor, size)
        except OSError as error:
            raise ValueError(
                f"there is no room for {size >> 10} KiB of frames in {self.folder.parent} "
                f"({error.strerror}): free some, or enlarge it (docker: --shm-size=1g)."
            ) from error
        finally:
            os.close(descriptor)
        return {"file": str(self.file), "size": size}

    def forget(self) -> None:
        """Delete the name of what was made: the memory lasts as long as it is mapped."""
        if self.file is not None:
            self.file.unlink(missing_ok=True)
            self.file = None


class Connection:
    """Serves one environment. What a message asks for is done by the method of its kind.

    Args: folder: of the events. token: that the other side must know. memory: the folder for the
    files that frames lie in.
    """

    def __init__(
        self, channel: socket.socket, condition: Condition, folder: Path, token: str, memory: Path
    ) -> None:
        self.channel, self.condition, self.folder = channel, condition, folder
        self.token, self.shared = token, SharedMemory(memory)
        self.answers = {  # by the kind of a message, behind "hello"
            "spec": self.on_spec,
            "episode": self.on_episode,
            "frame": self.on_frame,
            "end": self.on_end,
            "dataset": self.on_dataset,
            "adapted": self.on_adapted,
            "stopped": self.on_stopped,
        }
        self.rig: Rig | None = None
        self.offsets: dict[str, int] = {}
        self.scene = self.episode = ""
        self.open = self.loop = self.chosen = False
        self.names: list[str] = []  # of a data set, so far
        self.described: list[Any] = []  # cameras of the calls so far, as they were told
        self.kinds: set[str] = set()  # of the cameras of this episode's calls
        self.calls = 0  # of this episode
        self.worked = 0.0  # seconds in corruptions, of this episode

    def serve(self) -> None:
        """Answer until the other side closes."""
        self.channel.settimeout(30.0)
        if not self._greet():
            return
        self.channel.settimeout(None)
        if "torch" in sys.modules:  # of a guard, loaded before the fork
            _one_thread()
        try:
            while (message := self._next()) is not None:
                answer = self._answer(message)
                send(self.channel, numbered(message, answer))
                if "error" in answer:
                    return
        except OSError:  # it died while this computed
            pass
        finally:
            self._leave()
            note(self.folder, event="bye")

    def _answer(self, message: Mapping[str, Any]) -> dict[str, Any]:
        kind = str(message.get("kind"))
        try:
            if kind not in self.answers:
                raise ValueError(unknown("kind of message", kind[:40], self.answers))
            answer = self.answers[kind](message)
            os.utime(self.folder / EVENTS)  # a sign of life
        except Exception as error:  # whatever it is, the agent must be told
            problem = _said(kind, error)
            note(self.folder, event="refused", problem=problem, trace=traceback.format_exc())
            answer = {"error": problem}
        return answer

    def _next(self) -> dict[str, Any] | None:
        try:
            return receive(self.channel)
        except (OSError, ValueError, RecursionError):
            return None

    def _leave(self, fault: str | None = None) -> None:
        """Note an episode that was left in the middle, for a ``fault`` if one is known: Habitat's
        was only reset after one call, and of a loop each call is a step."""
        if self.open and self.calls > (0 if self.loop else 1):
            said = {"scene": self.scene, "episode": self.episode, "fault": fault}
            note(self.folder, event="dropped", **said)
        if self.open:
            for observer in self.condition.observers:
                observer.leave()
        self.open = False

    def _greet(self) -> bool:
        hello = self._next() or {}
        token = str(hello.get("token")).encode("utf-8", "replace")
        if not hmac.compare_digest(token, self.token.encode()):
            return False
        if hello.get("protocol") != mitigate_hook.PROTOCOL:
            send(self.channel, {"error": "the hook is of another version than the server."})
            return False
        left_out = ("token", "kind", "pid", "number")
        said = {k: str(v)[:80] for k, v in hello.items() if k not in left_out}
        note(self.folder, event="hello", agent_pid=hello.get("pid"), **said)
        with suppress(OSError):  # who is gone already says no more
            send(self.channel, numbered(hello, {}))
        return True

    def on_spec(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """The cameras of the frames to come: answer where to write them."""
        condition = self.condition
        self.rig = Rig(message["cameras"], condition.missing, condition.turn)
        wanted = (
            *condition.corruption.modalities,
            *condition.guards.frames,
            *(k for o in condition.observers for k in o.kinds),
        )
        self.offsets, size = self.rig.lay_out(wanted)
        if message["cameras"] not in self.described:  # kinds in calls of their own take turns
            self.described.append(message["cameras"])
            note(self.folder, event="spec", cameras=message["cameras"])
        if not size:
            return {"offsets": {}}
        return {**self.shared.make(size), "offsets": self.offsets}

    def on_episode(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """An episode begins: answer with its words as the agent is to hear them."""
        self._leave()
        self._check_chosen()
        self.scene, self.episode = begun(message)
        self.open = True
        self.worked, self.calls, self.loop = 0.0, 0, message.get("loop") is True
        self.kinds = set()
        key = self.condition.key(self.scene, self.episode, 0)
        heard = self.condition.words.heard(
            message, self.condition.corruption, key, self.condition.guards
        )
        for observer in self.condition.observers:
            observer.episode(message)
        told = {n: message.get(n) for n in ("text", "category", "language")}
        told |= {"scene": self.scene, "heard": heard.get("text")}
        told["tokens"] = message.get("tokens") is not None
        note(self.folder, event="episode", episode=self.episode, **told)
        return heard

    def _check_chosen(self) -> None:
        """Raise ValueError if some episodes were asked for and the program let none be chosen."""
        if self.condition.keep is None or self.chosen:
            return
        self.chosen = '"event": "dataset"' in (self.folder / EVENTS).read_text("utf-8")
        if not self.chosen:
            raise ValueError(
                "episodes= asks for some of the program's episodes, but it would walk all: only a "
                "data set of habitat-lab is chosen from by itself. A loop of your own walks those "
                "that mitigate_hook.wanted([(scene, id), ...]) returns; WMNav has its own -ne. Or "
                "leave episodes= out."
            )

    def on_frame(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """The frames of a call lie in memory: corrupt them there, answer which were."""
        self.shared.forget()
        if self.rig is None:
            raise ValueError("a frame came before its cameras were described.")
        for camera in self.rig.cameras:
            middle = message.get("depth", {}).get(camera.name)
            if middle is not None:
                camera.check_depth(float(middle))
        self.kinds |= {camera.kind for camera in self.rig.cameras}
        began = time.perf_counter()
        for observer in self.condition.observers:
            observer.frame(message, self.rig, self.shared.map, self.offsets)
        heading = message.get("heading")
        changed = self.rig.corrupt(
            self.shared.map,
            self.offsets,
            self.condition.corruption,
            self.condition.key(self.scene, self.episode, int(message["call"])),
            None if heading is None else float(heading),
        )
        changed += self.rig.guard(self.shared.map, self.offsets, self.condition.guards)
        self.worked += time.perf_counter() - began
        self.calls += 1
        return {"changed": list(dict.fromkeys(changed))}

    def on_end(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """How the episode went; one that an exception broke off counts as left in the middle."""
        if message.get("how") == BROKEN:
            self._leave(_line(message.get("fault")))
            return {}
        said = ended(message, self.episode)
        failed = self.loop and not said.get("metrics", {}).get("success")  # before its first look
        if self.calls == 0 and not failed:
            raise ValueError(
                f"episode {self.episode} ended, and none of its frames came by: its program has "
                "frames that the bridge does not see."
            )
        if self.calls and not failed:
            self._check_kinds()
        for observer in self.condition.observers:
            observer.end(message)
        note(
            self.folder,
            event="end",
            scene=self.scene,
            episode=self.episode,
            seconds=round(self.worked, 4),
            **said,
        )
        self.open = False
        return {}

    def _check_kinds(self) -> None:
        """Raise ValueError if no call of the episode had a camera of a kind that is corrupted, or
        none that the guards are for."""
        for part in self.condition.corruption.parts:
            if part.modality in CHANNELS and part.modality not in self.kinds:
                raise ValueError(
                    f"{part.name!r} corrupts {part.modality}, but no call of episode "
                    f"{self.episode} had such a camera (it has "
                    f"{', '.join(sorted(self.kinds)) or 'none'}). Leave it out: suite=rgb, or "
                    "conditions=[clean,...]."
                )
        self.condition.guards.check_shown(sorted(self.kinds), f"episode {self.episode}")

    def on_dataset(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Episodes of an environment, in pieces: answer which of all ``count`` it is to keep, all
        if None, once all are named; ``least`` so many (Habitat refuses none)."""
        keep = self.condition.keep
        self.names += [str(key) for key in message["keys"]]
        count = int(message.get("count", len(self.names)))
        if keep is not None and len(self.names) < count:
            return {"more": count - len(self.names)}
        names, self.names = self.names, []
        least = 0 if message.get("least") == 0 else 1
        note(self.folder, event="dataset", episodes=count)
        chosen = None if keep is None else keep(names, least)
        if least == 0:  # a loop of the program's own asks for the episodes that it is to run
            wanted = count if chosen is None else len(chosen)
            note(self.folder, event="dataset", episodes=count, wanted=wanted)
        return {"keep": chosen}

    def on_adapted(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Adapters were put into an encoder."""
        note(self.folder, event="adapted", module=str(message["module"]))
        return {}

    def on_stopped(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """A process of the command ended itself, for this reason."""
        note(self.folder, event="stopped", problem=_line(message["problem"]))
        return {}


def _line(text: object) -> str | None:
    """What a process says, on one line, printable, and not too long; None if it says nothing."""
    if text is None:
        return None
    said = "".join(c if c.isprintable() else " " for c in str(text))
    return " ".join(said.split())[:LONGEST]
