"""What a run says: TensorBoard scalars and pictures, and a progress bar or plain lines."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Self

import numpy as np
from tqdm import tqdm


class Journal:
    """Log of one run over ``total`` steps, from ``start``; use it as a context manager.

    When standard output is a terminal it shows a bar with the time left; otherwise it prints one
    plain line each time :meth:`scalars` is called with ``line=True``.
    """

    def __init__(self, folder: Path, *, total: int, start: int = 0, name: str = "train") -> None:
        from torch.utils.tensorboard import SummaryWriter  # slow to import

        self._writer = SummaryWriter(str(folder), purge_step=start)
        self._terminal = sys.stdout.isatty()
        self._name, self._total, self._start = name, total, start
        self._began = time.monotonic()
        self._bar = tqdm(
            total=total, initial=start, desc=name, file=sys.stdout, disable=not self._terminal
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()
        self._writer.close()

    def advance(self) -> None:
        """Count one step."""
        self._bar.update(1)

    def scalars(self, step: int, values: dict[str, float], *, line: bool = True) -> None:
        """Log ``values`` after ``step`` updates and, with ``line``, show them."""
        for name, value in values.items():
            self._writer.add_scalar(name, value, step)
        if not line:
            return
        shown = "  ".join(f"{name} {value:.4g}" for name, value in values.items())
        if self._terminal:
            self._bar.set_postfix_str(shown)
        else:
            self.say(f"step {step}/{self._total}  {shown}  ETA {self._eta(step)}")

    def figures(self, step: int, pictures: dict[str, np.ndarray]) -> None:
        """Log uint8 pictures ``[H, W, 3]``."""
        for name, picture in pictures.items():
            self._writer.add_image(name, picture, step, dataformats="HWC")

    def say(self, text: str) -> None:
        """Print one line without breaking the bar."""
        if self._terminal:
            self._bar.write(f"{self._name}: {text}", file=sys.stdout)
        else:
            print(f"{self._name}: {text}", flush=True)

    def _eta(self, step: int) -> str:
        pace = (time.monotonic() - self._began) / max(1, step - self._start)
        return tqdm.format_interval((self._total - step) * pace)
