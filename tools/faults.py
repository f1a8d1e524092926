"""Break trainings and evaluations on purpose, and see whether they end as if nothing had happened.

``python tools/faults.py [--recipes da_per_episode ...] [--seed 0] [--out runs/faults]``, or ``make
test-faults``. Each recipe is trained (``debug=smoke``, four steps a stage) once unbroken, and once
through all faults, one after the other, each at a moment drawn from the seed; the weights must be
the same bits. Evaluations are broken likewise; their rows must be the same bytes. Prints what was
tried and what survived, and exits with 1 if anything did not.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RECIPES = (
    *("da_per_frame", "da_per_episode", "da_success", "imitation", "ts_distill", "conv_adapter"),
    *("stacked", "base", "dagger", "ablation", "encoder", "safeguard_lora"),
)
SMOKE = ("debug=smoke", "trainer.steps=4", "evaluation.enabled=false")
OWN = {  # what a recipe needs to be small, or to run at all
    "dagger": ("agent=recurrent",),
    "encoder": ("stages.encoder.recipe.frames=48", "stages.encoder.recipe.batch=8",
                "stages.encoder.recipe.micro_batch=8", "report=null"),
    "safeguard_lora": ("stages.lora.trainer.steps=4", "stages.lora.recipe.pairs=4"),
}  # fmt: skip
STATUS = {signal.SIGTERM: 143, signal.SIGINT: 130}
LATE = 600.0  # seconds after which a command hangs


class Training:
    """A recipe's training in ``folder``; ``seconds``: of the unbroken one."""

    def __init__(self, recipe: str, folder: Path, rng: random.Random) -> None:
        self.folder, self.rng = folder, rng
        own = OWN.get(recipe, ())
        self.command = ["mitigate.train", f"recipe={recipe}", *SMOKE, *own, f"folder={folder}"]
        self.command.append(f"runs={folder.parent}")
        self.seconds = 0.0

    def finish(self) -> None:
        """Run to the end. Raises RuntimeError with the last lines if it fails."""
        began = time.monotonic()
        status, said = ended(start(self.command, self.folder))
        if status:
            raise RuntimeError(f"status {status}: {said}")
        self.seconds = time.monotonic() - began

    def weights(self) -> str:
        """The sha256 of all weights of the result."""
        files = sorted((self.folder / "agent").rglob("*.safetensors"))
        return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()

    def signal(self, number: int, wait: Callable[[], object]) -> str:
        """Start, wait, send a signal; return what is wrong with how it ended."""
        process = start(self.command, self.folder)
        wait()
        process.send_signal(number)
        status, said = ended(process)
        wanted = STATUS.get(number, -number)
        if status not in (wanted, 0):  # 0: it was done before
            return f"status {status}, not {wanted}: {said}"
        return "" if status == 0 or number == signal.SIGKILL or "To go on" in said else said

    def some_time(self) -> None:
        time.sleep(self.rng.uniform(0.25, 0.9) * self.seconds)

    def inside_a_write(self) -> None:
        """Until a checkpoint is being written, or the training must be done."""
        over = time.monotonic() + self.seconds
        while time.monotonic() < over and not list(self.folder.rglob(".step-*.tmp")):
            time.sleep(0.0005)

    def flip(self) -> str:
        """Flip bytes of the newest checkpoint."""
        found = sorted(self.folder.rglob("step-*.pt"), key=lambda file: file.stat().st_mtime)
        if found:
            held = bytearray(found[-1].read_bytes())
            for _ in range(8):
                held[self.rng.randrange(len(held))] ^= 0xFF
            found[-1].write_bytes(bytes(held))
        return ""

    def forget(self) -> str:
        """Delete what is cached."""
        shutil.rmtree(self.folder.parent / "features", ignore_errors=True)
        return ""


def break_training(recipe: str, out: Path, seed: int) -> dict[str, str]:
    """What each fault of a recipe's training came to: "survived", or what is wrong."""
    rng = random.Random(f"{seed} {recipe}")
    unbroken = Training(recipe, out / recipe / "whole" / "run", rng)
    broken = Training(recipe, out / recipe / "broken" / "run", rng)
    unbroken.finish()
    broken.seconds = unbroken.seconds
    faults: dict[str, Callable[[], str]] = {
        "SIGKILL": lambda: broken.signal(signal.SIGKILL, broken.some_time),
        "SIGTERM": lambda: broken.signal(signal.SIGTERM, broken.some_time),
        "flipped bytes": broken.flip,
        "SIGINT": lambda: broken.signal(signal.SIGINT, broken.some_time),
        "cache deleted": broken.forget,
        "killed in a write": lambda: broken.signal(signal.SIGKILL, broken.inside_a_write),
    }
    found = {name: fault() or "survived" for name, fault in faults.items()}
    try:
        broken.finish()
        same = broken.weights() == unbroken.weights()
        found["ends the same"] = "survived" if same else "other weights than unbroken"
    except RuntimeError as error:
        found["ends the same"] = str(error)
    shutil.rmtree(out / recipe, ignore_errors=True)
    return found


def break_evaluation(out: Path, seed: int) -> dict[str, str]:
    """The same of evaluations: a worker killed, the command killed, a worker that stands still."""
    rng = random.Random(f"{seed} evaluation")
    found = {}

    def command(name: str) -> list[str]:
        options = ["checkpoint=checkpoints/base", "episodes=8", "suite=quick", "workers=2"]
        return ["mitigate.evaluate", *options, f"out={out / name}", f"runs={out}"]

    def rows(name: str) -> bytes:
        return (out / name / "rows.jsonl").read_bytes()

    began = time.monotonic()
    ended(start(command("whole"), out))
    seconds = time.monotonic() - began
    for name, number in (("worker killed", signal.SIGKILL), ("worker stopped", signal.SIGSTOP)):
        process = start(command(name), out)
        time.sleep(rng.uniform(0.5, 0.8) * seconds)
        workers = children(children_of_server(process.pid))
        if not workers:
            found[name] = "not run: it had no worker at that moment"
            ended(process)
            continue
        os.kill(workers[0], number)
        if number == signal.SIGSTOP:
            time.sleep(3)
            os.kill(workers[0], signal.SIGCONT)
        status, said = ended(process)
        found[name] = "survived" if not status and rows(name) == rows("whole") else said or "rows"
    process = start(command("command killed"), out)
    time.sleep(rng.uniform(0.5, 0.9) * seconds)
    process.kill()
    process.wait()
    status, said = ended(start(command("command killed"), out))
    same = not status and rows("command killed") == rows("whole")
    found["command killed"] = "survived" if same else said or "rows"
    return found


def children_of_server(pid: int) -> int:
    """The process that a command's workers are forked from."""
    return next(iter(children(pid)[::-1]), pid)


def children(pid: int) -> list[int]:
    """Processes that ``pid`` started."""
    listed = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(word) for word in listed.read_text().split()] if listed.exists() else []


@contextmanager
def small_disk(folder: Path, megabytes: int) -> Iterator[bool]:
    """A file system of its own at ``folder``; False where that is not allowed."""
    folder.mkdir(parents=True, exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", str(folder)]
    done = shutil.which("mount") and not subprocess.run(mount, capture_output=True).returncode
    try:
        yield bool(done)
    finally:
        if done:
            subprocess.run(["umount", "-l", str(folder)], capture_output=True)


def break_disk(out: Path, seed: int) -> dict[str, str]:
    """A training whose disk is full says so, and goes on when there is room."""
    rng = random.Random(seed)
    with small_disk(out / "disk", 20) as there:
        if not there:
            return {"full disk": "not run: no file system may be mounted here"}
        training = Training("da_per_episode", out / "disk" / "run", rng)
        status, said = ended(start(training.command, out))
        named = status == 1 and "No space left" in said and "Traceback" not in said
        if not named:
            return {"full disk": f"status {status}: {said}"}
        subprocess.run(["mount", "-o", "remount,size=400m", str(out / "disk")], check=True)
        try:
            training.finish()
        except RuntimeError as error:
            return {"full disk": str(error)}
    return {"full disk": "survived"}


def start(command: list[str], folder: Path) -> subprocess.Popen:
    """Start ``python -m command``; what it says goes to a file beside ``folder``."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    log = open(folder.parent / f"{folder.name}.log", "w", encoding="utf-8")  # noqa: SIM115
    process = subprocess.Popen(
        [sys.executable, "-m", *command], cwd=ROOT, stdout=log, stderr=subprocess.STDOUT
    )
    process.log = log.name  # type: ignore[attr-defined]
    return process


def ended(process: subprocess.Popen) -> tuple[int, str]:
    """The status of a process and its last lines; one that hangs is killed."""
    try:
        status = process.wait(LATE)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait(), "it hung"
    said = Path(process.log).read_text(encoding="utf-8", errors="replace")  # type: ignore[attr-defined]
    return status, " | ".join(said.strip().splitlines()[-3:])[-400:]


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recipes", nargs="*", default=RECIPES)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("runs/faults"))
    options = parser.parse_args()
    out = options.out.resolve()
    found: dict[str, dict[str, str]] = {}
    for recipe in options.recipes:
        found[recipe] = break_training(recipe, out, options.seed)
        report(recipe, found[recipe])
    for name, broken in (("evaluation", break_evaluation), ("disk", break_disk)):
        found[name] = broken(out / name, options.seed)
        report(name, found[name])
    every = [came for of in found.values() for came in of.values()]
    tried = [came for came in every if not came.startswith("not run")]
    survived = tried.count("survived")
    print(f"tried {len(tried)}, survived {survived}", flush=True)
    (out / "faults.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    return int(survived < len(tried))


def report(name: str, found: dict[str, str]) -> None:
    """Print what came of each fault."""
    print("; ".join(f"{fault}: {came}" for fault, came in found.items()).join((f"{name}: ", "")))
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
