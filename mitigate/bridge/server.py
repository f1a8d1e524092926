"""The server's side of the bridge: a process for each connection, so that one cannot harm another.

``Listener`` runs beside one command of the user's. What connects must know its token. Every
connection is served by a fork: corruptions run side by side on all cores, and a fault ends one
environment with a message. What happens is appended to files, which the command line reads.
"""

from __future__ import annotations

import fcntl
import hmac
import json
import mmap
import os
import secrets
import shutil
import signal
import socket
import tempfile
import time
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mitigate.bridge.cameras import Rig
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.hook.mitigate_hook import receive, send
from mitigate.bridge.words import Words
from mitigate.corruptions import Corruption, Key
from mitigate.corruptions.suite import corrupt

HOOK = Path(mitigate_hook.__file__).parent
MEMORY = Path("/dev/shm")  # Linux; elsewhere the folder for temporary files
EVENTS = "events.jsonl"
KINDS = ("spec", "episode", "frame", "end", "dataset", "adapted")  # of messages, after "hello"


@dataclass
class Condition:
    """What a command meets: the corruption, its seed, and how it is applied.

    repeat: number of this run of the same condition; part of the keys where it is not 0. missing:
    metres that a hole reads. turn: where a growing yaw turns. observers: told of every episode
    and frame, before its corruption (``recording.py``).
    """

    corruption: Corruption
    seed: int
    words: Words
    repeat: int = 0
    missing: float = 0.0
    turn: str = "left"
    keep: Callable[[list[str]], list[int]] | None = None
    observers: list[Any] = field(default_factory=list)

    def key(self, scene: str, episode: str, frame: int) -> Key:
        """Names the draw: seed, scene file and episode id, number of the call."""
        name = f"{scene.rpartition('/')[2]}/{episode}" + (f"#{self.repeat}" if self.repeat else "")
        return Key(self.seed, name, frame)


class Listener:
    """Serves what connects, in a process of its own, until it is closed.

    Args: condition: what the command meets. folder: gets ``EVENTS``, a JSON line for each thing
    that happened. ``environment`` is what the command's processes need.
    """

    def __init__(self, condition: Condition, folder: Path, patience: float = 25.0) -> None:
        self.condition, self.folder, self.patience = condition, folder, patience
        self.token = secrets.token_hex(16)
        self.place = Path(tempfile.mkdtemp(prefix="mitigate-", dir=_short(tempfile.gettempdir())))
        self.memory = _memory_folder()
        self.address = str(self.place / "bridge")
        self.pid = 0

    def __enter__(self) -> Listener:
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listening.bind(self.address)  # in a folder that only this user may enter
        os.chmod(self.address, 0o600)
        listening.listen(256)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.pid = os.fork()
        if self.pid == 0:
            try:
                os.setpgid(0, 0)
                signal.signal(signal.SIGINT, signal.SIG_DFL)
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for connections
                self._accept(listening)
            except BaseException:
                traceback.print_exc()
            finally:
                os._exit(1)
        listening.close()
        with suppress(PermissionError, ProcessLookupError):  # the child did, or is gone
            os.setpgid(self.pid, self.pid)  # whoever comes first: its forks end with it
        return self

    def __exit__(self, *_: object) -> None:
        if self.pid:
            with suppress(ProcessLookupError):
                os.killpg(self.pid, signal.SIGKILL)
            with suppress(ChildProcessError):
                os.waitpid(self.pid, 0)
            self.pid = 0
        self._forget()

    def _forget(self) -> None:
        """Delete what it made."""
        shutil.rmtree(self.place, ignore_errors=True)
        shutil.rmtree(self.memory, ignore_errors=True)

    def is_alive(self) -> bool:
        """Whether it still serves."""
        with suppress(ChildProcessError):
            return os.waitpid(self.pid, os.WNOHANG) == (0, 0)
        return False

    def environment(self) -> dict[str, str]:
        """What the command's environment must hold."""
        path = os.environ.get("PYTHONPATH", "")
        return {
            mitigate_hook.ADDRESS: self.address,
            mitigate_hook.TOKEN: self.token,
            mitigate_hook.PATIENCE: f"{self.patience:g}",
            "PYTHONPATH": os.pathsep.join([str(HOOK), *([path] if path else [])]),
        }

    def _accept(self, listening: socket.socket) -> None:
        parent = os.getppid()
        warm(self.condition.corruption)
        listening.settimeout(1.0)
        while True:
            try:
                channel, _ = listening.accept()
            except TimeoutError:
                if os.getppid() != parent:  # killed without a chance to end us
                    self._forget()
                    os.killpg(0, signal.SIGKILL)
                continue
            channel.setblocking(True)
            if os.fork() == 0:
                listening.close()
                try:
                    Connection(channel, self).serve()
                finally:
                    os._exit(0)
            channel.close()


def _memory_folder() -> Path:
    parent = str(MEMORY) if MEMORY.is_dir() and os.access(MEMORY, os.W_OK) else None
    return Path(tempfile.mkdtemp(prefix="mitigate-", dir=parent))


def _short(folder: str) -> str:
    """The address of a socket has at most 107 bytes (unix(7))."""
    return folder if len(folder) < 60 else "/tmp"


def warm(corruption: Corruption) -> None:
    """Compile what the corruption needs, before anyone waits for it."""
    import numpy as np

    frames = {"rgb": np.zeros((32, 32, 3), np.uint8), "depth": np.ones((32, 32, 1), np.float32)}
    if corruption.modality in frames:
        corrupt(frames[corruption.modality], corruption.name, corruption.severity, key=0)


def note(folder: Path, **event: Any) -> None:
    """Add a line to the events in ``folder``; processes may do so side by side."""
    line = json.dumps({"time": round(time.time(), 3), "pid": os.getpid(), **event}) + "\n"
    with open(folder / EVENTS, "a", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.write(line)


class Connection:
    """Serves one environment. What a message asks for is done by the method of its kind."""

    def __init__(self, channel: socket.socket, listener: Listener) -> None:
        self.channel, self.listener = channel, listener
        self.condition, self.folder = listener.condition, listener.folder
        self.rig: Rig | None = None
        self.memory: mmap.mmap | None = None
        self.file: Path | None = None
        self.offsets: dict[str, int] = {}
        self.scene = self.episode = ""
        self.open = False
        self.calls = 0  # of this episode
        self.worked = 0.0  # seconds in corruptions, of this episode

    def serve(self) -> None:
        """Answer until the other side closes."""
        self.channel.settimeout(30.0)
        if not self._greet():
            return
        self.channel.settimeout(None)
        kinds = {kind: getattr(self, f"on_{kind}") for kind in KINDS}
        while (message := self._next()) is not None:
            try:
                answer = kinds[message.get("kind")](message)
                os.utime(self.folder / EVENTS)  # a sign of life
            except Exception as error:  # whatever it is, the agent must be told
                problem = str(error) if isinstance(error, ValueError) else repr(error)
                note(self.folder, event="refused", problem=problem, trace=traceback.format_exc())
                answer = {"error": problem}
            send(self.channel, answer)
            if "error" in answer:
                return
        self._leave()
        note(self.folder, event="bye")

    def _next(self) -> dict[str, Any] | None:
        try:
            return receive(self.channel)
        except (OSError, ValueError):
            return None

    def _leave(self) -> None:
        """Note an episode that was left in the middle; after one call it was only reset."""
        if self.open and self.calls > 1:
            note(self.folder, event="dropped", scene=self.scene, episode=self.episode)
        self.open = False

    def _greet(self) -> bool:
        hello = self._next() or {}
        if not hmac.compare_digest(str(hello.get("token")), self.listener.token):
            return False
        if hello.get("protocol") != mitigate_hook.PROTOCOL:
            send(self.channel, {"error": "the hook is of another version than the server."})
            return False
        said = {k: str(v)[:80] for k, v in hello.items() if k not in ("token", "kind", "pid")}
        note(self.folder, event="hello", agent_pid=hello.get("pid"), **said)
        send(self.channel, {})
        return True

    def on_spec(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """The cameras of the frames to come: answer where to write them."""
        self._drop_memory()
        condition = self.condition
        self.rig = Rig(message["cameras"], condition.missing, condition.turn)
        wanted = (condition.corruption.modality, *(k for o in condition.observers for k in o.kinds))
        self.offsets, size = self.rig.lay_out(wanted)
        note(self.folder, event="spec", cameras=message["cameras"])
        if not size:
            return {"offsets": {}}
        self.file = self.listener.memory / secrets.token_hex(8)
        descriptor = os.open(self.file, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.posix_fallocate(descriptor, 0, size)
            self.memory = mmap.mmap(descriptor, size)
        except OSError as error:
            raise ValueError(
                f"there is no room for {size >> 10} KiB of frames in {self.file.parent.parent} "
                f"({error.strerror}): free some, or enlarge it (docker: --shm-size=1g)."
            ) from error
        finally:
            os.close(descriptor)
        return {"file": str(self.file), "size": size, "offsets": self.offsets}

    def _drop_memory(self) -> None:
        """The memory lasts as long as it is mapped; its name need not."""
        if self.file is not None:
            self.file.unlink(missing_ok=True)
            self.file = None

    def on_episode(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """An episode begins: answer with its words as the agent is to hear them."""
        self._leave()
        self.scene, self.episode, self.open = str(message["scene"]), str(message["id"]), True
        self.worked, self.calls = 0.0, 0
        key = self.condition.key(self.scene, self.episode, 0)
        heard = self.condition.words.heard(message, self.condition.corruption, key)
        for observer in self.condition.observers:
            observer.episode(message)
        told = {n: message.get(n) for n in ("text", "category", "language")}
        told |= {"scene": self.scene, "heard": heard.get("text")}
        note(self.folder, event="episode", episode=self.episode, **told)
        return heard

    def on_frame(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """The frames of a call lie in memory: corrupt them there, answer which were."""
        self._drop_memory()
        if self.rig is None:
            raise ValueError("a frame came before its cameras were described.")
        began = time.perf_counter()
        for observer in self.condition.observers:
            observer.frame(message, self.rig, self.memory, self.offsets)
        heading = message.get("heading")
        changed = self.rig.corrupt(
            self.memory,
            self.offsets,
            self.condition.corruption,
            self.condition.key(self.scene, self.episode, int(message["call"])),
            None if heading is None else float(heading),
        )
        self.worked += time.perf_counter() - began
        self.calls += 1
        return {"changed": changed}

    def on_end(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """How the episode went."""
        told = ("metrics", "steps", "calls", "path", "start_distance", "distance", "stopped")
        said = {name: message[name] for name in told if message.get(name) is not None}
        if not isinstance(said.get("metrics", {}), dict):
            raise ValueError("the metrics of an episode are no names and numbers.")
        if self.calls == 0:
            raise ValueError(
                f"episode {self.episode} ended, and none of its frames came by: its program has "
                "frames that the bridge does not see."
            )
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

    def on_dataset(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """The episodes of an environment: answer which it is to keep, all if None."""
        keep = self.condition.keep
        return {"keep": None if keep is None else keep([str(k) for k in message["keys"]])}

    def on_adapted(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Adapters were put into an encoder."""
        note(self.folder, event="adapted", module=str(message["module"]))
        return {}
