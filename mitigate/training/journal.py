"""Log TensorBoard scalars and pictures, and show a progress bar or plain lines."""

from __future__ import annotations

import sys
import time
from collections import defaultdict
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core import output, progress
from mitigate.core.files import make_folder

# name of the scalar that holds the CPU seconds per step, summed over the threads of this process
CPU = "cpu_s_per_step"


class Journal:
    """Context manager that logs one run over ``total`` steps, beginning at ``start``.

    While the journal is open, every write below its folder checks that the folder still exists.

    The progress of the run is shown as a bar in a terminal, and as plain lines elsewhere
    (:class:`~mitigate.core.progress.Progress`). :meth:`scalars` with ``line=True`` prints an
    additional line with all its values.
    """

    def __init__(self, folder: Path, *, total: int, start: int = 0, name: str = "train") -> None:
        from torch.utils.tensorboard import SummaryWriter  # slow to import

        self._folder = make_folder(folder)
        # TensorBoard may append to such a file, so check that it is a regular file
        for path in self._folder.glob("events.out.tfevents.*"):
            output.open_output(path, "ab").close()
        self._writer = SummaryWriter(str(folder), purge_step=start + 1)
        self._name = name
        self._progress = progress.Progress(name, total, start=start)
        self._measured = start, time.process_time()
        # lists can differ in length, because some batches do not report every value
        self._values: dict[str, list[float]] = defaultdict(list)
        self._since = start, time.monotonic()

    def __enter__(self) -> Journal:
        self._root = output.register(self._folder)
        self._progress.__enter__()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        self._progress.__exit__(kind)
        # The writer may fail for the same reason. Its error must not replace the first one.
        with nullcontext() if kind is None else suppress(OSError):
            self._writer.close()
        try:
            if kind is None:
                self._root.check()
        finally:
            output.unregister(self._root)

    def advance(self, values: dict[str, float]) -> None:
        """Count one step, and collect its ``values``, which :meth:`means` will average."""
        for name, value in values.items():
            self._values[name].append(value)
        self._progress.advance()

    def means(self, step: int, **values: float) -> None:
        """Log the means of collected values, additional ``values``, and the steps per second.

        Args:
            step: number of updates so far.
            values: additional values, which are not averaged.
        """
        means = {name: sum(items) / len(items) for name, items in self._values.items()}
        before, then = self._since
        pace = (self._progress.done - before) / max(1e-9, time.monotonic() - then)
        self.scalars(step, {**means, **values, "steps_per_s": pace})
        self._values.clear()
        self._since = self._progress.done, time.monotonic()

    def scalars(self, step: int, values: dict[str, float], *, line: bool = True) -> None:
        """Log ``values`` after ``step`` updates; with ``line``, also print them.

        Raises FolderLostError if the folder was removed, which TensorBoard would not notice.
        """
        output.check(self._folder / "events")
        for name, value in values.items():
            self._writer.add_scalar(name, value, step)
        if not line:
            return
        before, then = self._measured
        self._measured = self._progress.done, time.process_time()
        steps = max(1, self._progress.done - before)
        self._writer.add_scalar(CPU, (self._measured[1] - then) / steps, step)
        texts = [f"{name} {value:.4g}" for name, value in values.items()]
        self._progress.advance(0, note=texts[0])
        if not sys.stdout.isatty():
            left = progress.duration(self._progress.left())
            self.say("  ".join([f"step {step}/{self._progress.total}", *texts, f"{left} left"]))

    def figures(self, step: int, pictures: dict[str, np.ndarray]) -> None:
        """Log pictures, each a uint8 array ``[H, W, 3]``."""
        for name, picture in pictures.items():
            self._writer.add_image(name, picture, step, dataformats="HWC")

    def say(self, text: str) -> None:
        """Print one line without disturbing the progress bar."""
        self._progress.say(f"{self._name}: {text}")
