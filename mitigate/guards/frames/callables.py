"""Use a user's callable as a restorer, with ``restore=module:callable``.

The callable may be a network for depth completion or denoising, or a filter. This module does
not need torch.

If the callable is a class, it is instantiated once per process, without arguments. Any other object
is used directly. If the resulting object is a :class:`~mitigate.guards.guard.Guard`, it is used as
the guard. Otherwise, the object is called with the frames of each time step.
``docs/restoration.md`` has an example.

Importing the module runs its code, so the option is read only from the user's command line or
config, and never from a downloaded folder.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import json
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from mitigate.core.checksums import DIGITS
from mitigate.core.files import sha256
from mitigate.core.names import unknown
from mitigate.guards.frames.choices import SENSORS, CallableChoice, callable_of, label
from mitigate.guards.guard import RESTORER, Guard

FRAMES = (
    "Return a dict of the changed frames by sensor name, with the shape and dtype of those given."
)


class FramesCallable(Guard):
    """A guard that calls a user's callable.

    The callable receives a dict that maps sensor names to copies of the frames. Frames of "rgb" are
    uint8 with shape [H, W, 3] or [V, H, W, 3]. Frames of "depth" are in metres, float32 with shape
    [H, W, 1] or [V, H, W, 1]. The callable returns a dict of the frames that it changed. A result
    must not depend on earlier calls.

    Args:
        choice: ``module:callable`` or ``module:callable@VERSION``. A pickled guard contains only
            this text, so each process imports the module again.
        named: the parts of ``choice``.
        call: the callable. The callable may have an attribute ``frames``, which names its sensors
            (by default both), and an attribute ``version``.
        module: the module of the callable. The module's source file is part of the fingerprint.
    """

    def __init__(
        self,
        choice: str,
        named: CallableChoice,
        call: Callable[[dict], Mapping],
        module: ModuleType,
    ) -> None:
        self.choice = choice
        self.label = label(choice)
        self.call = call
        version = named.version or getattr(call, "version", None)
        self.version = None if version is None else str(version)
        frames = getattr(call, "frames", SENSORS)
        self.frames = (frames,) if isinstance(frames, str) else tuple(frames)
        if not self.frames or not set(self.frames) <= set(SENSORS):
            raise ValueError(
                f"restore={choice}: frames must name rgb, depth or both, got {frames!r:.80}."
            )
        source = _source_sha(module)
        if not source and self.version is None:
            raise ValueError(
                f"{named.module} has no source file, so its versions cannot be told apart. Write "
                f"restore={named.module}:NAME@VERSION, and change VERSION whenever the behaviour "
                "changes."
            )
        identity = [f"{named.module}:{named.name}", source, self.version]
        digest = hashlib.sha256(json.dumps(identity).encode()).hexdigest()
        self._fingerprint = RESTORER + digest[:DIGITS]

    def __reduce__(self) -> tuple[Any, ...]:
        return open_callable, (self.choice,)

    def fingerprint(self) -> str:
        """Return a hash of the callable's name, the source file of its module, and ``version``.

        The source file is read once, when the module is loaded.
        """
        return self._fingerprint

    def observe(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        frames = {name: observation[name] for name in self.frames if name in observation}
        if not frames:
            return observation
        copies = {name: np.array(frame) for name, frame in frames.items()}
        try:
            results = self.call(copies)
        except Exception as error:  # the user's code may raise any error
            raise ValueError(
                f"restore={self.choice} failed with {type(error).__name__}: {error}"
            ) from error
        self._check(results, frames)
        changed = {n: f for n, f in results.items() if not np.array_equal(f, frames[n])}
        return {**observation, **changed} if changed else observation

    def _check(self, results: Any, frames: Mapping[str, np.ndarray]) -> None:
        """Raise ValueError if ``results`` has an entry that is not in ``frames``.

        A result whose shape or dtype differs from the frame's is also an error.
        """
        if not isinstance(results, Mapping):
            self._reject(f"returned a {type(results).__name__}, not a dict")
        for name, frame in results.items():
            if name not in frames:
                self._reject(f"returned an entry {name!r}, but it was given {', '.join(frames)}")
            original = frames[name]
            if _form(frame) != _form(original):
                self._reject(f"returned {name} as {_form(frame)}, not {_form(original)}")
            if frame.dtype.kind == "f" and not np.isfinite(frame[np.isfinite(original)]).all():
                self._reject(f"returned {name} with NaN or infinity; 0 means no reading")

    def _reject(self, what: str) -> None:
        raise ValueError(f"restore={self.choice} {what}. {FRAMES}")


def open_callable(choice: str) -> Guard:
    """Build the guard for ``restore=module:callable``.

    Raises:
        ValueError: If the module or the callable does not exist, or the object cannot be called.
    """
    named = callable_of(choice)
    assert named is not None, f"{choice} is no module:callable"
    try:
        module = importlib.import_module(named.module)
    except ImportError as error:
        stem = named.module.removesuffix(".py")
        hint = "" if stem == named.module else f" Write {stem}:{named.name}."
        raise ValueError(
            f"restore={choice}: {error}. It must be module:callable (installed, in the current "
            f"folder, or on PYTHONPATH) or the folder of a restorer.{hint}"
        ) from error
    try:
        target = getattr(module, named.name)
    except AttributeError as error:
        public = [name for name in vars(module) if not name.startswith("_")]
        raise ValueError(
            f"restore={choice}: {unknown(f'object of {named.module}', named.name, public)}"
        ) from error
    instance = target() if isinstance(target, type) else target
    if isinstance(instance, Guard):
        instance.version = named.version or instance.version
        instance.label = instance.label or label(choice)
        return instance
    if not callable(instance):
        raise ValueError(
            f"restore={choice}: a {type(instance).__name__} cannot be called with frames. Name a "
            "function, an object that can be called, or a class of such objects."
        )
    return FramesCallable(choice, named, instance, module)


def _form(frame: Any) -> str:
    """Describe an array by its dtype and shape, or another object by its type."""
    if isinstance(frame, np.ndarray):
        return f"{frame.dtype} {list(frame.shape)}"
    return f"a {type(frame).__name__}"


@cache
def _source_sha(module: ModuleType) -> str:
    """Return the sha256 of a module's source file, or "" if there is no such file."""
    # the hash is cached, because later edits of the file do not affect the loaded module
    try:
        file = inspect.getsourcefile(module)
    except TypeError:  # a built-in module
        return ""
    return sha256(Path(file)) if file and Path(file).is_file() else ""
