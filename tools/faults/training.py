"""One recipe's training, once unbroken and once through all faults; the weights must be the same.

The broken one goes from fault to fault: each lets it run on from where the last one left it. A
training that ends before a fault came is compared, deleted and begun anew.
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
from tools.faults.processes import LATE, Command, workers

SMOKE = ("debug=smoke", "trainer.steps=4", "evaluation.enabled=false")
OWN = {  # what a recipe needs to be small, or to run at all
    "dagger": ("agent=recurrent", "stages.policy.recipe.every=2"),
    "encoder": ("stages.encoder.recipe.frames=48", "stages.encoder.recipe.batch=8",
                "stages.encoder.recipe.micro_batch=8", "agent=encoder",
                "agent.model=tests.encoders.shapes:tiny", "agent.output=pool"),
    "safeguard_lora": ("stages.lora.trainer.steps=4", "stages.lora.recipe.pairs=4"),
    "restore": ("stages.gate_rgb.recipe.instants=8", "stages.gate_rgb.recipe.held=4",
                "stages.gate_depth.recipe.instants=8", "stages.gate_depth.recipe.held=4"),
}  # fmt: skip
STATUS = {signal.SIGTERM: 143, signal.SIGINT: 130, signal.SIGKILL: -signal.SIGKILL}
BEGUN = "workers make batches"  # in the line with which a stage begins
REPLACED = "a new one repeats its work"  # in the line that tells a worker's death
NOTICED = 10.0  # seconds that this mostly takes; it comes when the worker's work is missed
TRIES = 4  # to come in before the training is done
DISK = 800  # MB of the file system that is filled
ROOM = 12 << 20  # bytes that a full disk has at most (ours: less than a checkpoint)


class TooLate(Exception):
    """The training was done before the fault came."""


class Training:
    """A recipe's training in ``folder``; ``seconds``: of the unbroken one; ``wrong``: what it said
    that is not so."""

    def __init__(self, recipe: str, folder: Path, rng: random.Random, seconds: float = 0.0) -> None:
        self.folder, self.rng, self.seconds = folder, rng, seconds
        own = OWN.get(recipe, ())
        self.arguments = ["mitigate.train", f"recipe={recipe}", *SMOKE, *own]
        self.arguments += [f"folder={folder}", f"runs={folder.parent}"]
        self.started, self.wrong = 0, ""

    def start(self, environment: dict[str, str] | None = None) -> Command:
        """Start the training, or let it go on."""
        self.started += 1
        log = self.folder.parent / f"log-{self.started}.txt"
        self.sound = newest_sound(self.folder)
        return Command(self.arguments, log, environment)

    def under_way(self, environment: dict[str, str] | None = None) -> Command:
        """As :meth:`start`, and wait for a moment in its training that is drawn at random."""
        command = self.start(environment)
        command.wait_for(lambda: BEGUN in command.said())
        command.wait_for(lambda: False, self.rng.uniform(0.0, max(2.0, 0.25 * self.seconds)))
        if not command.runs():
            self._is_done(command)
        return command

    def _is_done(self, command: Command) -> None:
        problem = command.problem(0)
        if problem:
            raise RuntimeError(problem)
        raise TooLate

    def ended_by(self, command: Command, number: int) -> str:
        """Send a signal; return what is wrong with how the training ended."""
        if not command.runs():
            self._is_done(command)
        command.process.send_signal(number)
        command.status()
        if "\ndone: " in command.said():  # it only had to end
            raise TooLate
        problem = command.problem(STATUS[signal.Signals(number)], 0)
        problem = problem or self.misled(command)
        if problem or command.process.returncode == 0 or number == signal.SIGKILL:
            return problem
        return "" if "To go on: " in command.said() else f"no way to go on: {command.end()}"

    def misled(self, command: Command) -> str:
        """What a training said of where it goes on, if that is not its newest sound checkpoint."""
        for stage, done in self.sound.items():
            said = re.findall(
                rf"^{stage}: (?:resumed at step (\d+) |already trained for (\d+) |\d+ steps$)",
                command.said(),
                re.MULTILINE,
            )
            for resumed, trained in said:
                if int(resumed or trained or 0) != done:
                    return f"{stage} went on from {resumed or trained or 0}, not from step {done}"
        return ""

    def finish(self) -> str:
        """Run to the end; return what is wrong with that."""
        command = self.start()
        began = time.monotonic()
        problem = command.problem(0) or self.misled(command)
        self.seconds = self.seconds or time.monotonic() - began
        return problem

    def weights(self) -> str:
        """The sha256 of all weights of the result; empty if there are none."""
        files = sorted((self.folder / "agent").rglob("*.safetensors"))
        if not files:
            return ""
        return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def newest_sound(folder: Path) -> dict[str, int]:
    """Steps of the newest sound checkpoint of each stage that has any."""
    found: dict[str, int] = {}
    for path in sorted(folder.glob("*/step-*.pt")):
        if checksums.sidecar(path).is_file() and not checksums.problem(path):
            found[path.parent.name] = states.steps_done(path)
    return found


def killed(training: Training, number: int) -> str:
    return training.ended_by(training.under_way(), number)


def killed_in_a_write(training: Training, number: int) -> str:
    """A signal while a checkpoint is being written."""
    command = training.start()
    own = f"*/.step-*.{command.process.pid}.tmp"  # as mitigate/core/files.py names it
    if not command.wait_for(lambda: list(training.folder.glob(own))):
        training._is_done(command)
    return training.ended_by(command, number)


def flipped(training: Training) -> str:
    """Bytes of the newest checkpoint are flipped, where an older one is kept."""
    command = training.start()
    if not command.wait_for(lambda: _with_older(training.folder)):
        training._is_done(command)
    problem = training.ended_by(command, signal.SIGKILL)
    found = sorted(_with_older(training.folder), key=lambda file: file.stat().st_mtime)[-1]
    held = bytearray(found.read_bytes())
    for _ in range(8):
        held[training.rng.randrange(len(held))] ^= 0xFF
    found.write_bytes(bytes(held))
    command = training.start()
    told = f"{found.name} is damaged; resuming from"
    command.wait_for(lambda: told in command.said())
    missing = "" if told in command.said() else f"nothing said of {found.name}: {command.end()}"
    return problem or missing or training.ended_by(command, signal.SIGTERM)


def _with_older(folder: Path) -> list[Path]:
    sound = [p for p in folder.glob("*/step-*.pt") if checksums.sidecar(p).is_file()]
    return [p for p in sound if any(o.parent == p.parent and o.name < p.name for o in sound)]


def forgotten(training: Training) -> str:
    """What is cached beside the runs is deleted."""
    shutil.rmtree(training.folder.parent / "features", ignore_errors=True)
    return killed(training, signal.SIGTERM)


def second(training: Training) -> str:
    """Two trainings are started in one folder at once: one must be refused, and change nothing."""
    both = [training.start(), training.start()]
    problem = one_refused(both)
    left = next((command for command in both if command.runs()), both[0])
    return problem or training.ended_by(left, signal.SIGTERM)


def one_refused(both: list[Command]) -> str:
    """Wait until one of two commands is refused; return what is wrong with that."""
    for _ in range(int(LATE / 0.1)):
        over = [command for command in both if not command.runs()]
        if over:
            told = "is in use" in over[0].said()
            return over[0].problem(1) or ("" if told else f"let in: {over[0].end()}")
        time.sleep(0.1)
    return "neither of the two was refused"


def worker_killed(training: Training) -> str:
    """A process that makes batches is killed."""
    command = training.under_way()
    if not command.runs() or "no workers make batches" in command.said():
        training.ended_by(command, signal.SIGTERM)
        return "not run: it has no workers"
    found = workers(command)
    if not found:
        training._is_done(command)
    os.kill(training.rng.choice(found), signal.SIGKILL)
    told = command.wait_for(lambda: REPLACED in command.said(), NOTICED)
    if told:
        return training.ended_by(command, signal.SIGTERM)
    problem = command.problem(0)  # a long step was at hand, the batches were made, or it hangs
    missed = REPLACED in command.said()
    return problem or ("" if missed else "not run: all that it had to do was done")


def worker_stopped(training: Training) -> str:
    """Processes that make batches stand still for some seconds."""
    command = training.under_way()
    found = workers(command)
    for number in (signal.SIGSTOP, signal.SIGCONT):
        for worker in found:
            if Path(f"/proc/{worker}").exists():
                os.kill(worker, number)
        time.sleep(3.0 if found and number == signal.SIGSTOP else 0.0)
    problem = training.ended_by(command, signal.SIGTERM)
    return problem or ("" if found else "not run: it has no workers")


def jumping_clock(training: Training) -> str:
    """The clock jumps by up to a day, about once a second."""
    clock = {"PYTHONPATH": str(Path(__file__).parent / "clock")}
    return training.ended_by(training.under_way(clock), signal.SIGTERM)


def full_disk(training: Training) -> str:
    """The disk is full: the training ends and says so; finished checkpoints stay."""
    disk = training.folder.parent
    if not os.path.ismount(disk):
        return "not run: no file system may be mounted here"
    with filled(disk, training.rng.randrange(ROOM)):
        command = training.start()
        if command.status() == 0:
            raise TooLate
        problem = command.problem(1)
        named = re.search("No space left|disk full", command.said())
        return problem or training.misled(command) or ("" if named else command.end())


FAULTS: dict[str, Callable[[Training], str]] = {
    "SIGKILL": lambda training: killed(training, signal.SIGKILL),
    "SIGTERM": lambda training: killed(training, signal.SIGTERM),
    "SIGINT": lambda training: killed(training, signal.SIGINT),
    "SIGKILL in a write": lambda training: killed_in_a_write(training, signal.SIGKILL),
    "SIGTERM in a write": lambda training: killed_in_a_write(training, signal.SIGTERM),
    "flipped bytes": flipped,
    "cache deleted": forgotten,
    "two in one folder": second,
    "worker killed": worker_killed,
    "worker stands still": worker_stopped,
    "clock jumps": jumping_clock,
    "full disk": full_disk,
}
SAME = "ends the same"


def break_training(recipe: str, out: Path, seed: int, faults: list[str]) -> dict[str, str]:
    """What each fault of a recipe's training came to: "survived", "not run: ..." or what is wrong;
    last of all whether the weights are those of an unbroken training, to the bit."""
    rng = random.Random(f"{seed} {recipe}")
    unbroken = Training(recipe, out / recipe / "unbroken" / "run", rng)
    problem = unbroken.finish()
    if problem:
        return {SAME: f"the unbroken one: {problem}"}
    wanted = unbroken.weights()
    if not wanted:
        return {SAME: f"no weights in {unbroken.folder / 'agent'}"}
    found: dict[str, str] = {}
    with small_disk(out / recipe / "broken", DISK):
        broken = Training(recipe, out / recipe / "broken" / "run", rng, unbroken.seconds)
        for name in faults:
            found[name] = tried(FAULTS[name], broken, wanted) or "survived"
        problem = broken.finish()
        same = "survived" if broken.weights() == wanted else "other weights than unbroken"
        found[SAME] = problem or same
    shutil.rmtree(out / recipe, ignore_errors=True)
    return found


def tried(fault: Callable[[Training], str], training: Training, wanted: str) -> str:
    """What is wrong after ``fault``; tried again from the start if it came too late."""
    for _ in range(TRIES):
        try:
            return fault(training)
        except TooLate:
            if training.weights() != wanted:
                return "other weights than unbroken"
            shutil.rmtree(training.folder)
        except RuntimeError as error:
            return str(error)
    return "not run: the training was always done before"
