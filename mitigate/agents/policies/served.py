"""A policy behind a model server, over a WebSocket.

The server speaks the protocol of vla-evaluation-harness (Allen Institute for AI, version 1), which
has servers for OpenVLA, pi0, GR00T, LeRobot and other models. Messages are msgpack maps with the
keys type, payload, seq and timestamp; arrays are maps with the key ``__ndarray__``.
"""

from __future__ import annotations

import re
import socket
import time
import warnings
import weakref
from collections.abc import Callable, Mapping
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from mitigate.agents.agent import Agent, check_started
from mitigate.core.names import short
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.progress import say

PROTOCOL = 1
LARGEST = 1 << 20  # bytes of one answer; an action has less than a kilobyte
MOST_ITEMS = 10_000  # items of a list or map in an answer
ARRAY = "__ndarray__"
LONGEST = 1_000_000  # seconds that one may wait
INSTALL = "pip install -e '.[train,served]'"
PAUSE = 2.0  # seconds between two attempts to connect
NUMBERS = re.compile(r"[<>|=]?[biuf]\d{1,2}")  # allowed dtypes of arrays


class ServedPolicy(Agent):
    """Agent whose actions come from a model server.

    Each episode has its own connection. During an episode, nothing is sent twice, because the
    server may remember earlier frames: if the connection breaks, the evaluation stops with an
    error. Finished rows stay in their file, and the same call measures the missing episodes. The
    connections of several processes (``workers=``) let the server compute several actions at once.

    Args:
        url: address of the server, such as ``ws://localhost:8000``.
        cameras: maps entries of observations to the names of the cameras on the server, in the
            order in which they are sent. Frames are sent unchanged: RGB uint8 [H, W, 3], depth
            float32 [H, W, 1] in metres.
        version: name of the weights and options of the server, and of ``convert``. Rows are reused
            as long as this name is the same.
        state: entry of observations with the state of the robot, sent as float32, or None.
        convert: function that returns the world's action for the server's action, a float32 array
            [n]. None means no conversion.
        timeout: seconds for one answer.
        wait: seconds until the server must accept a connection.

    Raises:
        ValueError: If a setting is invalid.
        ModuleNotFoundError: If websockets or msgpack is not installed.
    """

    views = 1
    sensors: tuple[str, ...] = ()
    run_state = ("_episode",)

    def __init__(
        self,
        url: str,
        cameras: Mapping[str, str],
        version: str,
        state: str | None = None,
        convert: Callable[[np.ndarray], Any] | None = None,
        timeout: float = 120.0,
        wait: float = 300.0,
    ) -> None:
        _check_installed()
        _check_url(url)
        if not cameras or len({*cameras.values()}) < len(cameras):
            raise ValueError(
                "cameras must map entries to different names, such as {'rgb': 'front'}, got "
                f"{dict(cameras)}."
            )
        if not version:
            raise ValueError("version must name the weights on the server, such as 'openvla-7b'.")
        if not 0 < timeout < LONGEST or not 0 <= wait < LONGEST:
            raise ValueError(
                f"timeout must be > 0 and wait >= 0, both below {LONGEST:,} seconds, got {timeout} "
                f"and {wait}."
            )
        if clean := [name for name in cameras if name not in (RGB, DEPTH)]:
            warnings.warn(
                f"The frames of {', '.join(clean)} stay clean: only the entries rgb and depth are "
                "corrupted.",
                stacklevel=2,
            )
        self.url, self.cameras, self.state = url, dict(cameras), state
        self.version, self.convert = version, convert
        self.timeout, self.wait = timeout, wait
        self.sensors = (*self.cameras, *([state] if state else []))
        self._episode: _Episode | None = None

    def settings(self) -> dict[str, Any]:
        """Return what determines the actions; the address and the deadlines are left out."""
        cameras = [*self.cameras.items()]  # a list, because servers read cameras in their order
        return {"version": self.version, "cameras": cameras, "state": self.state}

    def reset(self, instruction: str) -> None:
        """Start an episode.

        Raises:
            TypeError: If the instruction is not text.
            ConnectionError: If the server cannot be reached.
        """
        if not isinstance(instruction, str):
            raise TypeError(f"instruction must be a string, got a {type(instruction).__name__}.")
        if self._episode is not None:
            self._episode.close()
            self._episode = None
        self._episode = _Episode(self._connect(), instruction, self.timeout)

    def act(self, observation: Mapping[str, Any]) -> Any:
        """Return the next action.

        Raises:
            KeyError: If the observation lacks an entry.
            ValueError: If an entry is not an array of numbers, or the server's action is invalid.
            ConnectionError: If the server returns no usable answer in time.
        """
        check_started(self._episode is not None)
        assert self._episode is not None
        missing = [name for name in self.sensors if name not in observation]
        if missing:
            raise KeyError(
                f"The observation must have {', '.join(missing)}; it has {', '.join(observation)}. "
                "Change cameras= or state=, or the entries of the world (GymWorld(entries=...))."
            )
        images = {name: _numbers(observation, entry) for entry, name in self.cameras.items()}
        sent: dict[str, Any] = {"images": images, "task_description": self._episode.task}
        if self.state:
            state = _numbers(observation, self.state)
            if not np.isfinite(state).all():
                raise ValueError(f"The state {self.state!r} must be finite numbers.")
            sent["state"] = state.astype(np.float32)
        action = self._episode.act(sent)
        return action if self.convert is None else self.convert(action)

    def _connect(self) -> Any:
        from websockets.exceptions import WebSocketException
        from websockets.sync.client import connect

        parts = urlsplit(self.url)
        address = (parts.hostname, parts.port or (443 if parts.scheme == "wss" else 80))
        ends = time.monotonic() + self.wait
        while True:
            left = max(PAUSE, ends - time.monotonic())
            try:
                # with an open socket, neither redirects nor proxies are used
                connection = connect(
                    self.url,
                    sock=socket.create_connection(address, timeout=left),
                    compression=None,
                    max_size=LARGEST,
                    max_queue=1,
                    open_timeout=left,
                    close_timeout=1.0,
                    ping_interval=None,  # a server that loads its model does not answer pings
                ).__enter__()
                connection.socket.settimeout(self.timeout)  # for sending
                return connection
            except (OSError, WebSocketException, ValueError) as error:
                # a ValueError is an invalid name of the host
                if isinstance(error, ValueError) or time.monotonic() + PAUSE > ends:
                    raise ConnectionError(
                        f"No connection to {self.url} within {self.wait:g} s (wait=): "
                        f"{type(error).__name__}: {short(str(error))}. Start the model server, and "
                        "run the same command again: rows are kept."
                    ) from error
                say(f"{self.url}: {type(error).__name__}, waiting for the model server")
                time.sleep(PAUSE)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_episode": None}  # each process opens its own connection


class _Episode:
    """One episode on its own connection; the server ends the episode when it is closed."""

    def __init__(self, connection: Any, task: str, timeout: float) -> None:
        self.connection, self.task, self.timeout = connection, task, timeout
        # closes the connection, at the latest when the episode is no longer used
        self.close = weakref.finalize(self, connection.close)
        self.number = 0
        try:
            hello = {"harness_version": "mitigate", "protocol_version": PROTOCOL}
            answer = self._receive(self._send("hello", hello), "hello")
            version = answer.get("protocol_version")
            if type(version) is not int or version != PROTOCOL:
                raise ConnectionError(
                    f"The model server must speak protocol version {PROTOCOL} of "
                    f"vla-evaluation-harness, got {_text(version)}."
                )
            self._send("episode_start", {"task": {"name": task}})
        except BaseException:
            self.close()
            raise

    def act(self, observation: Mapping[str, Any]) -> np.ndarray:
        """Return the server's action, float32 [n]."""
        answer = self._receive(self._send("observation", observation), "action")
        values = answer.get("actions")
        listed = isinstance(values, list) and all(type(one) in (int, float) for one in values)
        action = np.empty(0, np.float32)
        if listed or isinstance(values, np.ndarray):
            with np.errstate(over="ignore"):
                action = np.array(values, np.float32)  # a copy, which convert= may change
        if action.ndim != 1 or not action.size or not np.isfinite(action).all():
            raise ValueError(
                "The model server must return one action of finite numbers, shape [n], got "
                f"{_text(answer)}. If the model predicts several actions at once, start the "
                "server with chunk_size=."
            )
        return action

    def _send(self, kind: str, payload: Mapping[str, Any]) -> int:
        import msgpack
        from websockets.exceptions import ConnectionClosed

        self.number += 1
        message = {"type": kind, "payload": payload, "seq": self.number, "timestamp": time.time()}
        try:
            self.connection.send(msgpack.packb(message, default=_encoded))
        except UnicodeEncodeError as error:
            raise ValueError(f"The instruction is not valid text: {error}.") from error
        except (ConnectionClosed, OSError) as error:
            raise _broken(
                f"it closed the connection, or read nothing for {self.timeout:g} s (timeout=): "
                f"{short(str(error), 200)}"
            ) from error
        return self.number

    def _receive(self, number: int, kind: str) -> dict[str, Any]:
        """Return the payload of the answer to the message ``number``."""
        from websockets.exceptions import ConnectionClosed

        try:
            message = _decoded(self.connection.recv(timeout=self.timeout))
        except TimeoutError as error:
            raise _broken(f"no answer within {self.timeout:g} s (timeout=)") from error
        except ConnectionClosed as error:
            raise _broken(short(str(error), 200)) from error
        stated, order, payload = (message.get(name) for name in ("type", "seq", "payload"))
        if isinstance(stated, str) and stated == "error":
            raise _broken(f"the server reports {_text(payload)}")
        fits = isinstance(stated, str) and type(order) is int and (stated, order) == (kind, number)
        if not fits:
            raise _broken(f"the server sent {_text(message)} instead of {kind} {number}")
        if not isinstance(payload, dict):
            raise _broken(f"the payload is not a map: {_text(payload)}")
        return payload


def _text(answer: Any) -> str:
    """Return a part of an answer as short text."""
    try:
        return short(str(answer))
    except RecursionError:
        return "nested lists"


def _numbers(observation: Mapping[str, Any], entry: str) -> np.ndarray:
    """Return an entry of an observation; raise ValueError if it is not an array of numbers."""
    values = np.asarray(observation[entry])
    if values.dtype.kind not in "biuf" or not values.size:
        raise ValueError(
            f"The entry {entry!r} must be an array of numbers, got {values.dtype} "
            f"{list(values.shape)}."
        )
    return values


def _check_installed() -> None:
    try:
        import msgpack  # noqa: F401
        import websockets.sync.client  # noqa: F401
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"Served policies need the package {error.name}. Run {INSTALL}."
        ) from error


def _check_url(url: str) -> None:
    """Raise ValueError if ``url`` is no address, or contains a user, a password or a key."""
    try:
        parts = urlsplit(url)
        valid = parts.scheme in ("ws", "wss") and parts.hostname and parts.port != 0
    except ValueError:
        valid = False
    if not valid or any(mark in url for mark in "@?#"):
        raise ValueError(
            "url must be an address such as ws://localhost:8000, without a user, a password or a "
            "key, because it is part of the results."
        )


def _broken(reason: str) -> ConnectionError:
    return ConnectionError(
        f"The model server gave no usable answer: {reason}. Check the server, and run the same "
        "command again: rows are kept."
    )


def _encoded(value: Any) -> Any:
    """Return an array or a numpy scalar as data that msgpack can store."""
    if isinstance(value, np.ndarray):
        shape = list(value.shape)
        return {ARRAY: True, "data": value.tobytes(), "dtype": value.dtype.str, "shape": shape}
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} cannot be sent to a model server")


def _decoded(data: Any) -> dict[str, Any]:
    """Return a message; raise ConnectionError if the bytes are not a valid message."""
    import msgpack

    try:
        message = msgpack.unpackb(
            data, object_hook=_array, raw=False, max_array_len=MOST_ITEMS, max_map_len=MOST_ITEMS
        )
        if not isinstance(message, dict):
            raise ValueError(f"a {type(message).__name__} instead of a map")
    except (ValueError, TypeError, KeyError, RecursionError, msgpack.UnpackException) as error:
        raise _broken(f"{type(error).__name__}: {short(str(error))}") from error
    return message


def _array(value: dict[str, Any]) -> Any:
    """Return the array that a map describes, or the map."""
    if ARRAY not in value:
        return value
    dtype = value["dtype"]
    if not isinstance(dtype, str) or not NUMBERS.fullmatch(dtype):
        raise ValueError(f"arrays of {_text(dtype)} are not allowed")
    return np.frombuffer(value["data"], dtype).reshape(value["shape"])
