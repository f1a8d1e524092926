"""Inject faults into the training run of a recipe, and compare its weights with the weights of
an undisturbed run.

The same training run is disturbed by all faults in turn, and resumes after each. If it ends before
a fault is injected, its weights are compared with those of the undisturbed run. Then the run is
deleted and started again.
"""

from __future__ import annotations

import hashlib
import os
import random
import re
import shutil
import signal
import time
from collections.abc import Callable
from pathlib import Path

from mitigate.core import checksums
from mitigate.training import states
from tools.faults.disk import filled, small_disk
from tools.faults.processes import ASCII_OUTPUT, JUMPING_CLOCK, TIMEOUT, Command, workers
from tools.faults.report import UNBROKEN

SMOKE = ("debug=smoke", "trainer.steps=4", "evaluation.enabled=false")
RECIPE_OPTIONS = {  # options that a recipe requires, or that make it faster
    "dagger": ("agent=recurrent", "stages.policy.recipe.every=2"),
    "encoder": ("stages.encoder.recipe.frames=48", "stages.encoder.recipe.batch=8",
                "stages.encoder.recipe.micro_batch=8", "agent=encoder",
                "agent.model=tests.encoders.shapes:tiny", "agent.output=pool"),
    "safeguard_lora": ("stages.lora.trainer.steps=4", "stages.lora.recipe.pairs=4"),
    "restore": ("stages.gate_rgb.recipe.instants=8", "stages.gate_rgb.recipe.held=4",
                "stages.gate_depth.recipe.instants=8", "stages.gate_depth.recipe.held=4"),
}  # fmt: skip
STATUS = {signal.SIGTERM: 143, signal.SIGINT: 130, signal.SIGKILL: -signal.SIGKILL}
STAGE_START = "workers make batches"  # part of the first line that a stage prints
REPLACED = "a new one repeats its work"  # part of the message that reports a dead worker
# seconds until a dead worker is usually noticed by its missing results
NOTICE_TIME = 10.0
TRIES = 4  # maximum number of attempts if training ends before the fault
DISK = 800  # size in MB of the file system that is filled
# maximum free bytes after the disk is filled; too few for a checkpoint (heuristic)
MAX_FREE = 12 << 20


class TooLate(Exception):
    """Raised if training ended before the fault."""


class Training:
    """A training run of a recipe in ``folder``.

    Args:
        recipe: Name of the recipe.
        folder: The run's folder.
        rng: Generator that chooses the times of faults.
        seconds: Duration of the undisturbed run; 0 until it is measured.
    """

    def __init__(self, recipe: str, folder: Path, rng: random.Random, seconds: float = 0.0) -> None:
        self.folder = folder
        self.rng = rng
        self.seconds = seconds
        options = RECIPE_OPTIONS.get(recipe, ())
        self.arguments = ["mitigate.train", f"recipe={recipe}", *SMOKE, *options]
        self.arguments += [f"folder={folder}", f"runs={folder.parent}"]
        self.started = 0

    def start(self, environment: dict[str, str] | None = None, redirect: str = "") -> Command:
        """Start or resume the training run."""
        self.started += 1
        log = self.folder.parent / f"log-{self.started}.txt"
        self.checkpoints = newest_checkpoints(self.folder)
        return Command(self.arguments, log, environment, redirect)

    def start_and_wait(self, environment: dict[str, str] | None = None) -> Command:
        """Start or resume the training run, and wait for a random time after a stage starts."""
        command = self.start(environment)
        command.wait_for(lambda: STAGE_START in command.output())
        command.wait_for(lambda: False, self.rng.uniform(0.0, max(2.0, 0.25 * self.seconds)))
        if not command.runs():
            self._raise_too_late(command)
        return command

    def _raise_too_late(self, command: Command) -> None:
        """Raise TooLate, or RuntimeError if the command has failed."""
        problem = command.problem(0)
        if problem:
            raise RuntimeError(problem)
        raise TooLate

    def send_signal(self, command: Command, number: int) -> str:
        """Send a signal; return a description of the problem if the run does not end as documented,
        or else "".
        """
        if not command.runs():
            self._raise_too_late(command)
        command.process.send_signal(number)
        command.status()
        if "\ndone: " in command.output():  # the run was already finished
            raise TooLate
        problem = command.problem(STATUS[signal.Signals(number)], 0)
        problem = problem or self.check_resumed(command)
        if problem or command.process.returncode == 0 or number == signal.SIGKILL:
            return problem
        if "To resume: " in command.output():
            return ""
        return f"it does not say how to resume: {command.last_lines()}"

    def check_resumed(self, command: Command) -> str:
        """Return a description of the problem if a stage did not resume from its newest valid
        checkpoint.
        """
        for stage, done in self.checkpoints.items():
            matches = re.findall(
                rf"^{stage}: (?:resumed at step (\d+) |already trained for (\d+) |\d+ steps$)",
                command.output(),
                re.MULTILINE,
            )
            for resumed, trained in matches:
                if int(resumed or trained or 0) != done:
                    return f"{stage} resumed from {resumed or trained or 0}, not from step {done}"
        return ""

    def finish(self) -> str:
        """Run to the end. Return an error message, or "" after success."""
        command = self.start()
        start = time.monotonic()
        problem = command.problem(0) or self.check_resumed(command)
        self.seconds = self.seconds or time.monotonic() - start
        return problem

    def weights(self) -> str:
        """Return the sha256 of all trained weights, or "" if no weights exist."""
        files = sorted((self.folder / "agent").rglob("*.safetensors"))
        if not files:
            return ""
        return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def newest_checkpoints(folder: Path) -> dict[str, int]:
    """Return the step of each stage's newest valid checkpoint."""
    steps: dict[str, int] = {}
    for path in sorted(folder.glob("*/step-*.pt")):
        if checksums.sidecar(path).is_file() and not checksums.problem(path):
            steps[path.parent.name] = states.steps_done(path)
    return steps


def interrupt(training: Training, number: int, environment: dict[str, str] | None = None) -> str:
    """Send a signal at a random moment."""
    return training.send_signal(training.start_and_wait(environment), number)


def interrupt_write(training: Training, number: int) -> str:
    """Send a signal while a checkpoint is being written."""
    command = training.start()
    # the name that mitigate/core/files.py gives to unfinished files
    draft = f"*/.step-*.{command.process.pid}.tmp"
    if not command.wait_for(lambda: list(training.folder.glob(draft))):
        training._raise_too_late(command)
    return training.send_signal(command, number)


def flip_bytes(training: Training) -> str:
    """Flip bytes of the newest checkpoint, if an older one exists."""
    command = training.start()
    if not command.wait_for(lambda: _checkpoints_with_older(training.folder)):
        training._raise_too_late(command)
    problem = training.send_signal(command, signal.SIGKILL)
    files = sorted(_checkpoints_with_older(training.folder), key=lambda file: file.stat().st_mtime)
    newest = files[-1]
    data = bytearray(newest.read_bytes())
    for _ in range(8):
        data[training.rng.randrange(len(data))] ^= 0xFF
    newest.write_bytes(bytes(data))
    command = training.start()
    warning = f"{newest.name} is damaged; resuming from"
    command.wait_for(lambda: warning in command.output())
    missing = f"no warning about {newest.name}: {command.last_lines()}"
    if warning in command.output():
        missing = ""
    return problem or missing or training.send_signal(command, signal.SIGTERM)


def _checkpoints_with_older(folder: Path) -> list[Path]:
    """Return all complete checkpoints except the oldest one of each stage."""
    complete = [p for p in folder.glob("*/step-*.pt") if checksums.sidecar(p).is_file()]
    return [p for p in complete if any(o.parent == p.parent and o.name < p.name for o in complete)]


def delete_cache(training: Training) -> str:
    """Delete the cache of features next to the runs."""
    shutil.rmtree(training.folder.parent / "features", ignore_errors=True)
    return interrupt(training, signal.SIGTERM)


def start_twice(training: Training) -> str:
    """Start two training runs in one folder. One must be rejected without changing a file."""
    both = [training.start(), training.start()]
    problem = check_one_rejected(both)
    running = next((command for command in both if command.runs()), both[0])
    return problem or training.send_signal(running, signal.SIGTERM)


def check_one_rejected(both: list[Command]) -> str:
    """Wait until one of two commands is rejected. Return an error message, or "" after success."""
    for _ in range(int(TIMEOUT / 0.1)):
        ended = [command for command in both if not command.runs()]
        if ended:
            rejected = "is in use" in ended[0].output()
            not_rejected = f"not rejected: {ended[0].last_lines()}"
            return ended[0].problem(1) or ("" if rejected else not_rejected)
        time.sleep(0.1)
    return "neither of the two was rejected"


def kill_worker(training: Training) -> str:
    """Kill a worker process that computes batches."""
    command = training.start_and_wait()
    if not command.runs() or "no workers make batches" in command.output():
        training.send_signal(command, signal.SIGTERM)
        return "not run: it has no workers"
    pids = workers(command)
    if not pids:
        training._raise_too_late(command)
    os.kill(training.rng.choice(pids), signal.SIGKILL)
    if command.wait_for(lambda: REPLACED in command.output(), NOTICE_TIME):
        return training.send_signal(command, signal.SIGTERM)
    # the step is slow, or the last batch was already finished, or the run hangs
    problem = command.problem(0)
    noticed = REPLACED in command.output()
    return problem or ("" if noticed else "not run: all batches were made before")


def pause_workers(training: Training) -> str:
    """Pause the worker processes for three seconds."""
    command = training.start_and_wait()
    pids = workers(command)
    for number in (signal.SIGSTOP, signal.SIGCONT):
        for pid in pids:
            if Path(f"/proc/{pid}").exists():
                os.kill(pid, number)
        time.sleep(3.0 if pids and number == signal.SIGSTOP else 0.0)
    problem = training.send_signal(command, signal.SIGTERM)
    return problem or ("" if pids else "not run: it has no workers")


def fill_disk(training: Training) -> str:
    """Fill the disk; training must end with an error message and keep finished checkpoints."""
    disk = training.folder.parent
    if not os.path.ismount(disk):
        return "not run: no file system may be mounted here"
    with filled(disk, training.rng.randrange(MAX_FREE)):
        command = training.start()
        if command.status() == 0:
            raise TooLate
        problem = command.problem(1)
        named = re.search("No space left|disk full", command.output())
        return problem or training.check_resumed(command) or ("" if named else command.last_lines())


def remove_folder(training: Training) -> str:
    """Move the folder away during training, and back when the command has ended."""
    command = training.start_and_wait()
    away = training.folder.with_name("away")
    os.replace(training.folder, away)
    problem = command.message_problem("removed or replaced")
    if training.folder.exists():
        return problem or "it created the folder again"
    os.replace(away, training.folder)
    if command.process.returncode == 0:  # all files had been written before
        raise TooLate
    return problem


def plant_link(training: Training) -> str:
    """Replace a TensorBoard log by a link; training must not write to the target of the link."""
    training.send_signal(training.start_and_wait(), signal.SIGTERM)
    files = sorted(training.folder.glob("*/events.out.tfevents.*"))
    if not files:
        raise TooLate
    file = max(files, key=lambda path: path.stat().st_mtime)  # the log of the current stage
    outside = training.folder.with_name("outside")
    os.replace(file, outside)
    file.symlink_to(outside)
    before = outside.read_bytes()
    command = training.start()
    problem = command.message_problem("must be a regular file, got a symbolic link")
    unchanged = outside.read_bytes() == before
    os.replace(outside, file)
    if not unchanged:
        return "the file behind the link was changed"
    if command.process.returncode == 0:  # no steps were left, so nothing was logged
        raise TooLate
    return problem


def close_stdout(training: Training) -> str:
    """Train with a closed stdout until a checkpoint exists, and stop."""
    command = training.start(redirect=">&-")
    command.wait_for(lambda: newest_checkpoints(training.folder) != training.checkpoints)
    return training.send_signal(command, signal.SIGTERM)


FAULTS: dict[str, Callable[[Training], str]] = {
    "SIGKILL": lambda training: interrupt(training, signal.SIGKILL),
    "SIGTERM": lambda training: interrupt(training, signal.SIGTERM),
    "SIGINT": lambda training: interrupt(training, signal.SIGINT),
    "SIGKILL in a write": lambda training: interrupt_write(training, signal.SIGKILL),
    "SIGTERM in a write": lambda training: interrupt_write(training, signal.SIGTERM),
    "flipped bytes": flip_bytes,
    "cache deleted": delete_cache,
    "two in one folder": start_twice,
    "worker killed": kill_worker,
    "worker stands still": pause_workers,
    "clock jumps": lambda training: interrupt(training, signal.SIGTERM, JUMPING_CLOCK),
    "full disk": fill_disk,
    "folder removed": remove_folder,
    "link instead of a file": plant_link,
    "closed stdout": close_stdout,
    "output in ASCII": lambda training: interrupt(training, signal.SIGTERM, ASCII_OUTPUT),
}
SAME = "ends the same"


def break_training(recipe: str, out: Path, seed: int, faults: list[str]) -> dict[str, str]:
    """Return the outcome of each fault of a recipe's training.

    An outcome is "survived", "not run: ..." or a description of the problem. At the end, the
    weights are compared with the weights of an undisturbed run, bit for bit.
    """
    rng = random.Random(f"{seed} {recipe}")
    unbroken = Training(recipe, out / recipe / "unbroken" / "run", rng)
    problem = unbroken.finish()
    if problem:
        return {UNBROKEN: problem}
    expected = unbroken.weights()
    if not expected:
        return {UNBROKEN: f"no weights in {unbroken.folder / 'agent'}"}
    outcomes: dict[str, str] = {}
    with small_disk(out / recipe / "broken", DISK):
        broken = Training(recipe, out / recipe / "broken" / "run", rng, unbroken.seconds)
        for name in faults:
            outcomes[name] = try_fault(FAULTS[name], broken, expected) or "survived"
        problem = broken.finish()
        same = "survived" if broken.weights() == expected else "weights differ"
        outcomes[SAME] = problem or same
    shutil.rmtree(out / recipe, ignore_errors=True)
    return outcomes


def try_fault(fault: Callable[[Training], str], training: Training, expected: str) -> str:
    """Inject ``fault``; return a description of the problem, or "". If training ended before the
    fault, start again.
    """
    for _ in range(TRIES):
        try:
            return fault(training)
        except TooLate:
            if training.weights() != expected:
                return "weights differ"
            shutil.rmtree(training.folder)
        except RuntimeError as error:
            return str(error)
    return "not run: the training always ended before the fault"
