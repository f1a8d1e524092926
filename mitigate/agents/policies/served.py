"""A policy behind a model server, over a WebSocket.

The server speaks the protocol of vla-evaluation-harness (Allen Institute for AI, version 1), which
has servers for OpenVLA, pi0, GR00T, LeRobot and other models. Messages are msgpack maps with the
keys type, payload, seq and timestamp; arrays are maps with the key ``__ndarray__``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from mitigate.agents.agent import Agent, check_started
from mitigate.core.names import short
from mitigate.core.progress import say

PROTOCOL = 1
LARGEST = 1 << 24  # bytes of one answer
ARRAY = "__ndarray__"
INSTALL = "pip install -e '.[train,served]'"


class ServedPolicy(Agent):
    """Agent whose actions come from a model server.

    Each episode has its own connection, so the server can compute the actions of several episodes
    as one batch. If a connection breaks during an episode, the evaluation stops with an error,
    because the server may remember earlier frames. Finished rows stay in their file, and the same
    call measures the missing episodes.

    Args:
        url: address of the server, such as ``ws://localhost:8000``.
        cameras: maps entries of observations to the server's names of cameras. The frames are sent
            as they are: RGB uint8 [H, W, 3], depth float32 [H, W, 1] in metres.
        version: name of the weights on the server. Choose a new name whenever they, or ``convert``,
            change, because rows are reused as long as the name is the same.
        state: entry of observations with the state of the robot, or None.
        task: text that the server gets if an episode has no instruction.
        convert: function that returns the world's action for the server's action, a float32 array
            [n]. None means no conversion.
        together: number of episodes that run at once.
        timeout: seconds for one action.
        retries: number of further attempts to connect.
        pause: seconds before the second attempt; the pause doubles before each later attempt.

    Raises:
        ValueError: If a setting is invalid.
        ModuleNotFoundError: If websockets or msgpack is not installed.
    """

    run_state = ("_episode",)

    def __init__(
        self,
        url: str,
        cameras: Mapping[str, str],
        version: str,
        state: str | None = None,
        task: str = "",
        convert: Callable[[np.ndarray], Any] | None = None,
        together: int = 1,
        timeout: float = 60.0,
        retries: int = 5,
        pause: float = 1.0,
    ) -> None:
        _check_installed()
        _check_url(url)
        if not cameras:
            raise ValueError("cameras must name at least one entry, such as {'rgb': 'front'}.")
        if not version:
            raise ValueError("version must name the weights on the server, such as 'openvla-7b'.")
        if together < 1:
            raise ValueError(f"together must be >= 1, got {together}.")
        self.url, self.cameras, self.state, self.task = url, dict(cameras), state, task
        self.version, self.convert = version, convert
        self.together = together
        self.timeout, self.retries, self.pause = timeout, retries, pause
        self.sensors = [*self.cameras]
        self._episode: _Episode | None = None

    def settings(self) -> dict[str, Any]:
        """Return the arguments that determine the actions; deadlines and retries are left out."""
        names = ("url", "cameras", "state", "task", "version")
        return {name: getattr(self, name) for name in names}

    def reset(self, instruction: str) -> None:
        self._episode = self.begin(instruction)

    def act(self, observation: Mapping[str, Any]) -> Any:
        check_started(self._episode is not None)
        assert self._episode is not None
        return self._answer(observation, self._episode)

    def begin(self, instruction: str) -> _Episode:
        """Open a connection for an episode and return it; raise ConnectionError if that fails."""
        return _Episode(self._connect(), instruction or self.task, self.timeout)

    def act_all(
        self, observations: Sequence[Mapping[str, Any]], memories: Sequence[_Episode]
    ) -> list[Any]:
        """Return one action for each episode; the requests run at the same time."""
        with ThreadPoolExecutor(len(memories)) as pool:
            return list(pool.map(self._answer, observations, memories))

    def _answer(self, observation: Mapping[str, Any], episode: _Episode) -> Any:
        entries = [*self.cameras, *([self.state] if self.state else [])]
        missing = [name for name in entries if name not in observation]
        if missing:
            raise KeyError(
                f"The observation must have {', '.join(missing)}; it has {', '.join(observation)}. "
                "Change cameras= or state=."
            )
        images = {name: np.asarray(observation[entry]) for entry, name in self.cameras.items()}
        sent: dict[str, Any] = {"images": images, "task_description": episode.task}
        if self.state:
            sent["state"] = np.asarray(observation[self.state], np.float32)
        action = episode.act(sent)
        return action if self.convert is None else self.convert(action)

    def _connect(self) -> Any:
        from websockets.exceptions import WebSocketException
        from websockets.sync.client import connect

        for attempt in range(self.retries + 1):
            try:
                # a server that loads its model or compiles does not answer pings
                return connect(
                    self.url,
                    compression=None,
                    max_size=LARGEST,
                    open_timeout=self.timeout,
                    close_timeout=1.0,
                    ping_interval=None,
                )
            except (OSError, WebSocketException) as error:
                if attempt == self.retries:
                    raise ConnectionError(
                        f"No connection to {self.url} after {attempt + 1} attempts: "
                        f"{type(error).__name__}: {short(str(error))}. Start the model server, and "
                        "run the same command again: rows are kept."
                    ) from error
                say(f"{self.url}: {type(error).__name__}, waiting for the model server")
                time.sleep(self.pause * 2**attempt)
        raise AssertionError

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_episode": None}  # each process opens its own connection


class _Episode:
    """One episode on its own connection; the server ends the episode when it is closed."""

    def __init__(self, connection: Any, task: str, timeout: float) -> None:
        self.connection, self.task, self.timeout = connection, task, timeout
        self.number = 0
        hello = {"harness_version": "mitigate", "protocol_version": PROTOCOL}
        answer = self._receive(self._send("hello", hello), "hello")
        if answer.get("protocol_version") != PROTOCOL:
            raise ConnectionError(
                f"The model server must speak protocol version {PROTOCOL} of vla-evaluation-harness"
                f", got {answer.get('protocol_version')!r:.40}."
            )
        self._send("episode_start", {"task": {"name": task}})

    def act(self, observation: Mapping[str, Any]) -> np.ndarray:
        """Return the server's action, float32 [n]."""
        answer = self._receive(self._send("observation", observation), "action")
        action = np.asarray(answer.get("actions"))
        if action.ndim != 1 or action.dtype.kind not in "iuf" or not np.isfinite(action).all():
            raise ValueError(
                "The model server must return one action of finite numbers, shape [n], got "
                f"{short(str(answer))}. A server that returns several actions needs chunk_size=."
            )
        return action.astype(np.float32)

    def _send(self, kind: str, payload: Mapping[str, Any]) -> int:
        import msgpack
        from websockets.exceptions import ConnectionClosed

        self.number += 1
        message = {"type": kind, "payload": payload, "seq": self.number, "timestamp": time.time()}
        try:
            self.connection.send(msgpack.packb(message, default=_encoded))
        except ConnectionClosed as error:
            raise _broken(str(error)) from error
        return self.number

    def _receive(self, number: int, kind: str) -> dict[str, Any]:
        """Return the payload of the answer to the message ``number``."""
        from websockets.exceptions import ConnectionClosed

        try:
            message = _decoded(self.connection.recv(timeout=self.timeout))
        except TimeoutError as error:
            raise _broken(f"no answer within {self.timeout:g} s") from error
        except ConnectionClosed as error:
            raise _broken(str(error)) from error
        payload = message.get("payload")
        if message.get("type") == "error":
            raise _broken(f"the server reports {short(str(payload))}")
        if message.get("type") != kind or message.get("seq") != number:
            raise _broken(f"the server sent {short(str(message))} instead of {kind} {number}")
        if not isinstance(payload, dict):
            raise _broken(f"the payload is not a map: {short(str(payload))}")
        return payload

    def __del__(self) -> None:
        connection = getattr(self, "connection", None)
        if connection is not None:
            connection.close()


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
        message = msgpack.unpackb(data, object_hook=_array, raw=False)
        if not isinstance(message, dict):
            raise ValueError(f"a {type(message).__name__} instead of a map")
    except (ValueError, TypeError, KeyError, RecursionError, msgpack.UnpackException) as error:
        raise _broken(f"{type(error).__name__}: {short(str(error))}") from error
    return message


def _array(value: dict[str, Any]) -> Any:
    """Return the array that a map describes, or the map."""
    if ARRAY not in value:
        return value
    dtype = np.dtype(str(value["dtype"]))
    if dtype.kind not in "biuf":
        raise ValueError(f"arrays of {dtype} are not allowed")
    return np.frombuffer(value["data"], dtype).reshape(value["shape"])
