"""Answer the messages that one environment in the user's command sends over one connection.

Episodes, errors and connections are written as events (``events.py``).
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

from mitigate.bridge.cameras import CHANNELS, Group, Rig
from mitigate.bridge.condition import Condition
from mitigate.bridge.events import EVENTS, read_end, read_events, read_start, write_event
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.hook.mitigate_hook import BROKEN, MAX_TEXT, receive, send
from mitigate.core.names import short, unknown
from mitigate.core.output import UnsafePathError
from mitigate.corruptions import FrameStream, registry
from mitigate.guards.guard import Guards


def numbered(message: Mapping[str, Any], answer: dict[str, Any]) -> dict[str, Any]:
    """Return an answer with the number of the message that it answers."""
    number = message.get("number")
    return {**answer, "number": number} if isinstance(number, int) else answer


def _describe_error(kind: str, error: Exception) -> str:
    """Return the text that tells the agent's process why a message was not answered."""
    if type(error) in (ValueError, UnsafePathError):
        return str(error)
    if isinstance(error, OSError):  # the server, not the agent's process, caused the error
        reason = f"the run cannot write {error.filename}: {error.strerror}."
        return reason if error.strerror else str(error)
    return (
        f"the message {kind!r} does not follow the protocol ({short(repr(error), 200)}). Use the "
        "mitigate_hook.py of this version."
    )


class SharedMemory:
    """Memory for frames that the server and an environment's process share.

    The memory is a mapped file in ``folder``. The file is deleted as soon as both sides have mapped
    it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.map: mmap.mmap | None = None
        self.file: Path | None = None

    def make(self, size: int) -> dict[str, Any]:
        """Map ``size`` new bytes, and return the path and size for the other process.

        Raises ValueError if there is not enough free space.
        """
        self.delete_file()
        self.file = self.folder / secrets.token_hex(8)
        descriptor = os.open(self.file, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.posix_fallocate(descriptor, 0, size)
            self.map = mmap.mmap(descriptor, size)
        except OSError as error:
            raise ValueError(
                f"there is no room for {size >> 10} KiB of frames in {self.folder.parent} "
                f"({error.strerror}). Free some space, or enlarge it (docker: --shm-size=1g)."
            ) from error
        finally:
            os.close(descriptor)
        return {"file": str(self.file), "size": size}

    def delete_file(self) -> None:
        """Delete the file; the shared memory remains until both processes unmap it."""
        if self.file is not None:
            self.file.unlink(missing_ok=True)
            self.file = None


class Connection:
    """Serves one environment. Each kind of message has a method that computes the answer.

    The other side must send the secret ``token``. Events are written to ``folder``. The files for
    shared memory are in the folder ``memory``.
    """

    def __init__(
        self, channel: socket.socket, condition: Condition, folder: Path, token: str, memory: Path
    ) -> None:
        self.channel = channel
        self.condition = condition
        self.folder = folder
        self.token = token
        self.shared = SharedMemory(memory)
        self.answers = {  # maps each kind of message after "hello" to its method
            "spec": self.on_spec,
            "episode": self.on_episode,
            "frame": self.on_frame,
            "end": self.on_end,
            "dataset": self.on_dataset,
            "adapted": self.on_adapted,
            "stopped": self.on_stopped,
        }
        self.rig: Rig | None = None
        # both are kept if the agent describes its cameras again
        self.streams: dict[Group, FrameStream] = {}
        self.guards: dict[tuple[str, ...], Guards] = {}  # guards of the current episode
        self.offsets: dict[str, int] = {}
        self.scene = ""
        self.episode = ""
        self.open = False  # whether an episode is running
        self.loop = False  # whether the program runs its own loop without Habitat
        self.chosen = False  # whether the program asked which episodes to run
        self.names: list[str] = []  # episode names of a dataset that were received so far
        self.described: list[Any] = []  # camera descriptions that were received so far
        self.kinds: set[str] = set()  # kinds of cameras in this episode ("rgb", "depth")
        self.calls = 0  # number of calls in this episode
        self.seconds = 0.0  # seconds spent on corruptions in this episode

    def serve(self) -> None:
        """Answer messages until the other side closes the connection."""
        self.channel.settimeout(30.0)
        if not self._greet():
            return
        self.channel.settimeout(None)
        if "torch" in sys.modules:  # a guard loaded torch before the fork
            import torch

            torch.set_num_threads(1)  # environments run in parallel
        try:
            while (message := self._next()) is not None:
                answer = self._answer(message)
                send(self.channel, numbered(message, answer))
                if "error" in answer:
                    return
        except OSError:  # the other side died while the answer was computed
            pass
        finally:
            self._leave()
            write_event(self.folder, event="bye")

    def _answer(self, message: Mapping[str, Any]) -> dict[str, Any]:
        kind = str(message.get("kind"))
        try:
            if kind not in self.answers:
                raise ValueError(unknown("kind of message", kind[:40], self.answers))
            answer = self.answers[kind](message)
            os.utime(self.folder / EVENTS)  # the new time shows that this process is alive
        except Exception as error:  # after any error, the agent's process must stop
            problem = _describe_error(kind, error)
            trace = traceback.format_exc()
            write_event(self.folder, event="refused", problem=problem, trace=trace)
            answer = {"error": problem}
        return answer

    def _next(self) -> dict[str, Any] | None:
        """Return the next message, or None at the end or after an invalid message."""
        try:
            return receive(self.channel)
        except (OSError, ValueError, RecursionError):
            return None

    def _leave(self, fault: str | None = None) -> None:
        """Record that the current episode was left unfinished; ``fault`` is the reason if known."""
        if not self.open:
            return
        # Habitat's first call belongs to the reset, so an episode with only one call had no step.
        # In a loop without Habitat, each call is a step.
        if self.calls > (0 if self.loop else 1):
            fields = {"scene": self.scene, "episode": self.episode, "fault": fault}
            write_event(self.folder, event="dropped", **fields)
        self.condition.observer.leave()
        self.open = False

    def _greet(self) -> bool:
        """Answer the first message; return whether it has the token and the protocol's version."""
        hello = self._next() or {}
        token = str(hello.get("token")).encode("utf-8", "replace")
        if not hmac.compare_digest(token, self.token.encode()):
            return False
        if hello.get("protocol") != mitigate_hook.PROTOCOL:
            send(self.channel, {"error": "the hook has another version than the server."})
            return False
        left_out = ("token", "kind", "pid", "number")
        versions = {k: str(v)[:80] for k, v in hello.items() if k not in left_out}
        write_event(self.folder, event="hello", agent_pid=hello.get("pid"), **versions)
        with suppress(OSError):  # the other process has ended; the next read will notice it
            send(self.channel, numbered(hello, {}))
        return True

    def on_spec(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Read the description of the cameras, and reply with shared memory for their frames."""
        condition = self.condition
        self.rig = Rig(message["cameras"], condition.missing, condition.turn, self.streams)
        kinds = {*condition.corruption.modalities, *condition.guards.frames}
        self.offsets, size = self.rig.lay_out(kinds.union(condition.observer.kinds))
        if message["cameras"] not in self.described:  # RGB and depth may come in separate calls
            self.described.append(message["cameras"])
            unread = [_one_line(text) for text in message.get("unread") or ()]
            write_event(self.folder, event="spec", cameras=message["cameras"], unread=unread)
        if not size:
            return {"offsets": {}}
        return {**self.shared.make(size), "offsets": self.offsets}

    def on_episode(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Begin an episode, and reply with the instruction for the agent."""
        self._leave()
        self._check_chosen()
        self.scene, self.episode = read_start(message)
        self.open = True
        self.streams.clear()
        self.guards.clear()
        self.loop = message.get("loop") is True
        self.seconds, self.calls, self.kinds = 0.0, 0, set()
        key = self.condition.key(self.scene, self.episode, 0)
        words = self.condition.words.corrupt(
            message, self.condition.corruption, key, self.condition.guards
        )
        self.condition.observer.episode(message)
        fields = {n: message.get(n) for n in ("text", "category", "language")}
        fields |= {"scene": self.scene, "episode": self.episode, "heard": words.get("text")}
        write_event(
            self.folder, event="episode", tokens=message.get("tokens") is not None, **fields
        )
        return words

    def _check_chosen(self) -> None:
        """Raise ValueError if the program did not ask which episodes to run.

        This is an error only if ``episodes=`` is set.
        """
        if self.condition.chosen is None or self.chosen:
            return
        self.chosen = any(e["event"] == "dataset" for _, e in read_events(self.folder))
        if not self.chosen:
            raise ValueError(
                "episodes= asks for some of the program's episodes, but the program would run all. "
                "A loop without habitat-lab must run only the episodes that "
                "mitigate_hook.wanted([(scene, id), ...]) returns. Alternatively, leave out "
                "episodes= and use an option of the program, such as -ne of WMNav."
            )

    def on_frame(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Corrupt a call's frames in the shared memory; reply with the names of changed cameras."""
        self.shared.delete_file()
        if self.rig is None:
            raise ValueError("a frame was received before its cameras were described.")
        for camera in self.rig.cameras:
            median = message.get("depth", {}).get(camera.name)
            if median is not None:
                camera.check_depth(float(median))
        self.kinds |= {camera.kind for camera in self.rig.cameras}
        began = time.perf_counter()
        self.condition.observer.frame(message, self.rig, self.shared.map, self.offsets)
        heading = message.get("heading")
        changed = self.rig.corrupt(
            self.shared.map,
            self.offsets,
            self.condition.corruption,
            self.condition.key(self.scene, self.episode, int(message["call"])),
            None if heading is None else float(heading),
        )
        changed += self.rig.guard(self.shared.map, self.offsets, self.condition.guards, self.guards)
        self.seconds += time.perf_counter() - began
        self.calls += 1
        return {"changed": list(dict.fromkeys(changed))}

    def on_end(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Record the result of an episode.

        If an exception is raised, the episode stays unfinished.
        """
        if message.get("how") == BROKEN:
            self._leave(_one_line(message.get("fault")))
            return {}
        end = read_end(message, self.episode)
        # a program may report a failure without a frame if the agent crashed before its first step
        failed = self.loop and not end.get("metrics", {}).get("success")
        if self.calls == 0 and not failed:
            cause = (
                "Call episode.corrupt() at each step"
                if self.loop
                else "The program takes frames in a way that the bridge does not intercept, or no "
                "sensor has the sensor_type SensorTypes.COLOR or SensorTypes.DEPTH"
            )
            raise ValueError(
                f"episode {self.episode} ended, but the bridge received none of its frames. "
                f"{cause} (docs/bridge.md)."
            )
        if not failed:
            self._check_kinds()
        self.condition.observer.end(message)
        fields = {"scene": self.scene, "episode": self.episode, "loop": self.loop, **end}
        write_event(self.folder, event="end", seconds=round(self.seconds, 4), **fields)
        self.open = False
        return {}

    def _check_kinds(self) -> None:
        """Raise ValueError if no camera of the episode matches the corruption or the guards."""
        for part in self.condition.corruption.parts:
            sensors = {*registry.record(part.name).modalities} & {*CHANNELS}
            if sensors and not sensors & self.kinds:
                raise ValueError(
                    f"{part.name!r} corrupts {part.modality}, but no call of episode "
                    f"{self.episode} had such a camera (it has {', '.join(sorted(self.kinds))}). "
                    "Leave it out: suite=rgb, or conditions=[clean,...]."
                )
        self.condition.guards.check_shown(sorted(self.kinds), f"episode {self.episode}")

    def on_dataset(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Receive the names of an environment's episodes, and reply with the indices to keep.

        The reply is None if the program must run all episodes. The names arrive in several
        messages. The final reply is sent when all ``count`` names are known. ``least`` is the
        minimum number of episodes to keep, because Habitat rejects an empty dataset.
        """
        chosen = self.condition.chosen
        self.names += [str(key) for key in message["keys"]]
        count = int(message.get("count", len(self.names)))
        least = int(message.get("least", 1))
        if chosen is not None and len(self.names) < count:
            return {"more": count - len(self.names)}
        names, self.names = self.names, []
        indices = None if chosen is None else chosen.keep(names, least)
        number = count if indices is None else len(indices)
        # with least == 0, the names come from ``wanted``: the program runs exactly these episodes
        expected = None if least else number
        write_event(self.folder, event="dataset", episodes=count, wanted=expected)
        return {"keep": indices}

    def on_adapted(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Record that adapters were attached to an encoder."""
        write_event(self.folder, event="adapted", module=str(message["module"]))
        return {}

    def on_stopped(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Record the reason why a process of the command stopped itself."""
        write_event(self.folder, event="stopped", problem=_one_line(message["problem"]))
        return {}


def _one_line(text: object) -> str | None:
    """Return text from a process as one printable line of at most ``MAX_TEXT`` characters."""
    if text is None:
        return None
    printable = "".join(c if c.isprintable() else " " for c in str(text))
    return " ".join(printable.split())[:MAX_TEXT]
