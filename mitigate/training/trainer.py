"""The training loop of all objectives, which steps, logs, evaluates, saves and resumes.

Data order and noise are functions of (seed, step): the global generators are reset at each step.
Therefore the weights are bit-identical whether or not a run logs, evaluates, or is killed and
resumed. This holds on the same machine, with the same number of threads, and without a lag
(recipes/README.md).
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor
from torch.optim import AdamW
from torch.optim.lr_scheduler import LambdaLR

from mitigate.core import checkpoint, seeding
from mitigate.core.memory import release_memory
from mitigate.core.precision import choose, computing, device_of, to_device
from mitigate.core.progress import say
from mitigate.core.signals import Ended, SignalDelay, delay_signals
from mitigate.training import states
from mitigate.training.batches import Batches
from mitigate.training.config import check_limits
from mitigate.training.journal import Journal
from mitigate.training.objective import Objective, accumulate
from mitigate.training.ranks import Ranks
from mitigate.training.workers import Workers

# settings that affect the weights; a run is not resumed if one of them differs
FIXED = ("steps", "lr", "weight_decay", "warmup", "grad_clip", "seed", "precision")


class LossNotFinite(ValueError):
    """Raised if the loss or its gradient is not finite.

    The weights are still those before that step.
    """


@dataclass(eq=False, repr=False)
class Trainer:
    """Train ``objective`` with AdamW for ``steps`` updates, with checkpoints in ``folder``.

    Args:
        objective: objective to train; see :class:`mitigate.training.objective.Objective`.
        steps: number of updates.
        folder: folder for ``step-*.pt`` and TensorBoard files. If it contains a checkpoint,
            training resumes from it.
        lr, weight_decay: values for parameter groups that do not set their own.
        warmup: number of updates during which the learning rate rises from 0. It then falls to 0
            on a cosine.
        grad_clip: maximum global gradient norm; 0 disables clipping.
        log_every, save_every, eval_every, figure_every: intervals in updates; 0 means never (a
            checkpoint is always written at the end).
        keep: number of checkpoints to keep.
        lag: maximum age, in updates, of the weights that compute a batch. A value above 0 lets
            workers compute several steps at once; with 0, training waits for each batch. The result
            depends on the lag but not on the number of workers.
        seed: seed of data order and noise.
        precision: one of ``precision.CHOICES``, used for all network computations; bf16 uses
            autocast, and weights stay float32. A checkpoint records the value that "auto" selected;
            a resumed run keeps this value.
        device: "auto" (CUDA if available), or any torch device.
        workers: worker processes that compute batches (``Objective.jobs``). If None, this process
            computes the same batches.
        ranks: processes that train together; the first one logs and saves.
        name: name of the stage in messages; the default is the class of the objective.
        config: JSON-compatible description of the run. A checkpoint with a different description is
            rejected.

    Raises:
        ValueError: If a setting is out of its range, or every parameter is frozen.
    """

    objective: Objective
    _: KW_ONLY
    steps: int
    folder: Path
    lr: float = 1e-3
    weight_decay: float = 0.01
    warmup: int = 0
    grad_clip: float = 1.0
    log_every: int = 50
    save_every: int = 1000
    eval_every: int = 0
    figure_every: int = 0
    keep: int = 2
    lag: int = 0
    seed: int = 0
    precision: str = "auto"
    device: Any = "auto"
    workers: Workers | None = None
    ranks: Ranks = field(default_factory=Ranks)
    name: str = ""
    config: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_limits(vars(self))
        self.folder = Path(self.folder)
        self.device = device_of(self.device)
        self.requested_precision = self.precision
        self.precision = self.ranks.of_first(choose(self.precision, self.device))
        self.objective = self.objective.to(self.device)
        self.name = self.name or type(self.objective).__name__
        # runs that an older version started recorded the schedule of the learning rate
        fixed = {name: vars(self)[name] for name in FIXED} | {"schedule": "cosine"}
        if self.lag:
            fixed |= {"lag": self.lag, "save_every": self.save_every}
        self.config = states.as_json(self.config) | {"trainer": fixed}
        groups = [
            {**group, "params": [p for p in group["params"] if p.requires_grad]}
            for group in self.objective.parameter_groups()
        ]
        self.trained = [parameter for group in groups for parameter in group["params"]]
        if not self.trained:
            raise ValueError(
                f"{self.name} has nothing to train: every parameter is frozen. Unfreeze a part of "
                "the agent."
            )
        trained_groups = [group for group in groups if group["params"]]
        self.optimizer = AdamW(trained_groups, lr=self.lr, weight_decay=self.weight_decay)
        self.scheduler = _scheduler(self.optimizer, self.steps, self.warmup)
        self._saved = 0  # number of steps in the newest checkpoint
        self._finished = False  # whether the newest checkpoint is marked as finished

    def fit(self) -> Objective:
        """Train the objective and return it.

        If the folder has a checkpoint, resume from the newest one.

        Raises:
            LossNotFinite: If the loss, its gradient or the weights are not finite.
            ValueError: If the checkpoint cannot be resumed.
        """
        start = self._resume()
        if self._finished:
            say(f"{self.name}: already trained for {start} steps in {self.folder}")
            return self.objective
        count = len(self.workers) if self.workers is not None else 0
        say(f"{self.name}: {self.precision} on {self.device}, {count or 'no'} workers make batches")
        log = self.folder if self.ranks.first else self.folder / f"rank-{self.ranks.number}"
        with Journal(log, total=self.steps, start=start, name=self.name) as journal:
            if start:
                journal.say(f"resumed at step {start} from {self.folder}")
            with computing(self.precision, self.device):
                self.objective.start()
            self.objective.train()
            # not with several ranks: torchrun ends them, and a rank that saves could wait for a
            # second rank that has already ended
            with delay_signals(self.ranks.count == 1) as ending:
                self._train(start, journal, ending)
                self._finish(journal, ending)
        return self.objective

    def _train(self, start: int, journal: Journal, ending: SignalDelay) -> None:
        """Train from step ``start``, and save the last checkpoint as unfinished."""
        batches = Batches(
            objective=self.objective,
            workers=self.workers,
            steps=self.steps,
            kind=self.precision,
            device=self.device,
            ranks=self.ranks,
            lag=self.lag,
            save_every=self.save_every,
        )
        for step in range(start, self.steps):
            done = step + 1
            with self._save_on_signal(step, ending):
                batch, waited = self._batch(step, batches)
            journal.advance({**self._step(step, batch), "batch_s": waited})
            if self._due(self.log_every, done):
                journal.means(done, lr=self._lr())
            with self._save_on_signal(done, ending):
                if done < self.steps:
                    self._evaluate_due(done, journal, ending)
                if done == self.steps or (self.save_every and done % self.save_every == 0):
                    self._save(done)
                    self.ranks.wait()
                ending.check()

    @contextmanager
    def _save_on_signal(self, done: int, ending: SignalDelay) -> Iterator[None]:
        """If a signal interrupts the code in the context, save the state after ``done`` steps.

        A second signal ends the run without saving.
        """
        try:
            yield
        except Ended:
            if not ending.again:
                if done > self._saved:
                    self._save(done)
                if self._saved:
                    say(f"{self.name}: saved at step {self._saved} in {self.folder}")
            raise

    def _finish(self, journal: Journal, ending: SignalDelay) -> None:
        """Call ``finish`` of the objective, and save the weights as finished."""
        with self._save_on_signal(self.steps, ending):
            seeding.seed_everything(self.seed, "finish")
            self.objective.eval()
            with torch.no_grad():
                self.objective.finish()
            self.objective.train()
            self._evaluate_due(self.steps, journal, ending)
            self._save(self.steps, finished=True)
            self.ranks.wait()
            ending.check()

    def _due(self, every: int, done: int) -> bool:
        """Return whether an action with the interval ``every`` is due after ``done`` steps."""
        return bool(every) and (done % every == 0 or done == self.steps)

    def _batch(self, step: int, batches: Batches) -> tuple[dict[str, Any], float]:
        """Return the batch of ``step``, and the time in seconds spent waiting for it."""
        began = time.monotonic()
        # seeded per rank, because dropout must differ between ranks; the key of rank 0 has no rank,
        # so that it equals the key of a training in a single process
        rank = (self.ranks.number,) if self.ranks.number else ()
        seeding.seed_everything(self.seed, "step", step, *rank)
        batch = to_device(batches.batch(step), self.device)
        return batch, time.monotonic() - began

    def _step(self, step: int, batch: dict[str, Any]) -> dict[str, float]:
        """Update the weights once, and return the values to log."""
        self.optimizer.zero_grad(set_to_none=True)
        values = accumulate(self.objective, batch, self.precision, self.device)
        values = {name: value.float() for name, value in values.items()}
        self.ranks.average(self.trained, values, self.objective.weight(batch))
        loss = values["loss"]
        norm = torch.nn.utils.clip_grad_norm_(self.trained, self.grad_clip or math.inf)
        if not (torch.isfinite(loss) and torch.isfinite(norm)):
            raise LossNotFinite(self._diverged(step, loss, norm, batch))
        self.optimizer.step()
        self.scheduler.step()
        return {name: float(value) for name, value in {**values, "grad_norm": norm}.items()}

    def _diverged(self, step: int, loss: Tensor, norm: Tensor, batch: dict[str, Any]) -> str:
        """Return the error message for a loss or a gradient that is not finite."""
        episodes = ", ".join(map(str, batch.get("episode_ids", [])[:16]))
        saved = states.checkpoints(self.folder)
        check = f", or check the episodes of that batch: {episodes}" if episodes else ""
        return (
            f"Training stopped at step {step} of {self.name} ({type(self.objective).__name__}): "
            f"the loss is {loss.item():g} and its gradient norm {norm.item():g}, which must be "
            f"finite. The last good checkpoint is {saved[-1] if saved else 'none'}. "
            f"{self._advice()}{check}."
        )

    def _advice(self) -> str:
        """Return advice on how to avoid values that are not finite."""
        exact = "" if self.precision == "fp32" else ", or compute in fp32 (trainer.precision=fp32)"
        return (
            f"Lower the learning rate ({self._lr():g} now; trainer.lr on the command line, lr= in "
            f"Python){exact}"
        )

    def _evaluate_due(self, done: int, journal: Journal, ending: SignalDelay) -> None:
        """Evaluate and log figures if they are due after ``done`` steps.

        Nothing is done if a signal was received.
        """
        if ending.number is None and self._due(self.eval_every, done):
            self.objective.eval()
            with torch.no_grad():
                values = self.objective.evaluate(done)
            self.objective.train()
            if values:
                journal.scalars(done, {f"eval/{k}": v for k, v in values.items()}, line=False)
                text = "  ".join(f"{name} {value:.4g}" for name, value in values.items())
                journal.say(f"evaluated at step {done}  {text}")
        if ending.number is None and self._due(self.figure_every, done):
            journal.figures(done, self.objective.figures(done))

    def _lr(self) -> float:
        return max(group["lr"] for group in self.optimizer.param_groups)

    def _save(self, done: int, *, finished: bool = False) -> None:
        """Write a checkpoint after ``done`` steps if this is the first rank."""
        self._saved = done
        if not self.ranks.first:
            return
        invalid = checkpoint.not_finite(self.objective)
        if invalid:
            raise LossNotFinite(
                f"Training stopped: after step {done} of {self.name} the weights are not finite "
                f"({', '.join(invalid[:3])}), so that step was not saved. "
                f"{self._advice()}."
            )
        state = {
            "step": done,
            "finished": finished,
            "model": self.objective.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "scheduler": self.scheduler.state_dict(),
            "rng": seeding.global_state(),
            "config": self.config,
        }
        states.save(self.folder, state, keep=self.keep)
        release_memory()

    def _keep_precision(self, config: dict[str, Any]) -> None:
        """Keep the precision of the checkpoint, unless the user chose a precision."""
        precision = config.get("trainer", {}).get("precision")
        if self.requested_precision != "auto" or precision in (None, self.precision):
            return
        say(
            f"{self.name}: resumes in its first precision {precision}, which is slower here than "
            f"{self.precision}. To train in {self.precision}, start again in another folder "
            "(folder=...)."
        )
        self.precision = precision
        self.config["trainer"]["precision"] = precision

    def _resume(self) -> int:
        """Load the newest intact checkpoint, if any, and return its number of updates."""
        newest = states.load_newest(self.folder)
        if newest is None:
            return 0
        path, state = newest
        self._keep_precision(state["config"])
        states.check_same(self.folder, states.as_json(state["config"]), self.config)
        try:
            self.objective.load_state_dict(state["model"])
            self.optimizer.load_state_dict(state["optimizer"])
        except (RuntimeError, ValueError, KeyError) as error:
            raise ValueError(
                f"The checkpoint {path} does not match the current config of {self.name}: "
                f"{str(error).splitlines()[0]} Choose another folder, or delete {self.folder}."
            ) from error
        self.scheduler.load_state_dict(state["scheduler"])
        seeding.set_global_state(state["rng"])
        self._saved = int(state["step"])
        self._finished = self._saved >= self.steps and bool(state["finished"])
        return self._saved


def _scheduler(optimizer: AdamW, steps: int, warmup: int) -> LambdaLR:
    """Return the schedule of the learning rate.

    The learning rate rises from 0 during ``warmup`` updates. It then follows a cosine, and is 0
    after ``steps`` updates.
    """

    def factor(step: int) -> float:
        if step < warmup:
            return (step + 1) / (warmup + 1)
        share = min(1.0, (step - warmup) / max(1, steps - warmup))
        return 0.5 * (1.0 + math.cos(math.pi * share))

    return LambdaLR(optimizer, factor)
