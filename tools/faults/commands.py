"""Inject faults into ``mitigate run``, ``mitigate export`` and the endpoint of a safeguard."""

from __future__ import annotations

import json
import random
import re
import shutil
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.util import find_spec
from pathlib import Path

from mitigate.agents import loading
from mitigate.core.files import make_folder, write_text
from tools.faults.processes import ROOT, Command, descendants
from tools.faults.training import STATUS

EPISODES = """
import os, sys, time, numpy, mitigate_hook

def episode(name):
    one = mitigate_hook.connect(name)
    one.corrupt({"rgb": numpy.full((8, 8, 3), 90, "uint8")})
    one.finish(success=True)

episode("a")
"""
DETACHES = "if os.fork() == 0:\n    os.setsid()\n    time.sleep(600)\n"
PRINTS = (
    "for _ in range(1 << 10):\n    sys.stdout.write('x' * (1 << 20))\n"  # one line of 1 GiB
    "sys.exit('the end of the output')\n"
)
# maximum memory of a process in bytes; importing the packages needs about half (heuristic)
MOST_MEMORY = 600 << 20
MOST_OUTPUT = 1 << 16  # maximum number of bytes that `mitigate run` may print (heuristic)
HARDENED = "checkpoints/hardened/harden"  # a shipped folder without program.pt2


class Commands:
    """A folder in which commands run while faults are injected."""

    def __init__(self, folder: Path, rng: random.Random) -> None:
        self.folder = make_folder(folder)
        self.rng = rng
        self.count = 0

    def start(self, *arguments: str, **environment: str) -> Command:
        """Start ``python -m arguments``."""
        self.count += 1
        return Command([*arguments], self.folder / f"log-{self.count}.txt", environment)

    def start_run(self, program: str) -> tuple[Command, Path, Path]:
        """Start ``mitigate run`` with a Python program; return the command, the program's file and
        the output folder.
        """
        file, out = self.folder / f"agent-{self.count}.py", self.folder / f"run-{self.count}"
        write_text(file, EPISODES + program)
        options = ["conditions=[clean]", f"out={out}", "--", sys.executable, str(file)]
        return self.start("mitigate", "run", *options), file, out


def detach_process(commands: Commands) -> str:
    """Run a command that leaves a detached process behind."""
    command, file, out = commands.start_run(DETACHES)
    problem = command.message_problem("still ran")
    left = descendants(1, bytes(file))
    if left:
        return problem or f"the processes {left} still run"
    return problem or ("the condition is finished" if list(out.rglob("done.json")) else "")


def print_gigabyte(commands: Commands) -> str:
    """Run a command that prints one line of 1 GiB and then fails."""
    command, _, out = commands.start_run(PRINTS)
    largest = 0

    def measure() -> None:
        nonlocal largest
        largest = max(largest, resident_bytes(command.process.pid))

    command.wait_for(measure)
    problem = command.message_problem("the end of the output")
    shutil.rmtree(out, ignore_errors=True)
    if len(command.output()) > MOST_OUTPUT:
        return problem or f"it printed {len(command.output())} bytes"
    return problem or (f"it used {largest >> 20} MiB" if largest > MOST_MEMORY else "")


def resident_bytes(pid: int) -> int:
    """Return the largest resident memory of a process so far, or 0 if it has ended."""
    try:
        match = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text("utf-8"))
    except OSError:
        return 0
    return int(match[1]) << 10 if match else 0


@contextmanager
def answering() -> Iterator[tuple[int, list[str]]]:
    """Yield the port of a chat endpoint that returns each text unchanged.

    Also yield the list of the texts that it receives.
    """
    requests: list[str] = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            requests.append(body["messages"][-1]["content"])
            reply = {"choices": [{"message": {"content": requests[-1]}}]}
            self.send_response(200)
            self.end_headers()
            self.wfile.write(json.dumps(reply).encode())

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server.server_port, requests
    finally:
        server.shutdown()
        server.server_close()


@contextmanager
def dead_port() -> Iterator[int]:
    """Yield a port whose queue of connections is full."""
    with socket.socket() as dead, ExitStack() as stack:
        dead.bind(("127.0.0.1", 0))
        dead.listen(0)
        for _ in range(4):
            waiting = stack.enter_context(socket.socket())
            waiting.setblocking(False)
            waiting.connect_ex(dead.getsockname())
        yield dead.getsockname()[1]


def die_first_address(commands: Commands) -> str:
    """Evaluate with an endpoint whose host name has two addresses: the first never answers, and
    the second is the real address.
    """
    rows = []
    with answering() as (port, requests), dead_port() as dead:
        options = ["checkpoint=checkpoints/base", "episodes=1", "conditions=[clean,friendly]"]
        options += [f"safeguard=http://localhost:{port}/v1@made-up", "workers=1"]
        patch = str(Path(__file__).parent / "dead_address")
        for name, environment in (
            ("dead", {"PYTHONPATH": patch, "DEAD_PORT": str(dead)}),
            ("live", {}),
        ):
            out = commands.folder / f"endpoint-{name}"
            more = [f"out={out}", f"runs={out}"]
            problem = commands.start(
                "mitigate", "evaluate", *options, *more, **environment
            ).problem(0)
            if problem:
                return problem
            if not requests:
                return "the endpoint was not asked"
            rows.append((out / "rows.jsonl").read_bytes())
    return "" if rows[0] == rows[1] else "rows differ from the rows with a live address"


def interrupt_export(commands: Commands, number: int, *flags: str) -> str:
    """Send a signal to ``mitigate export`` of a training run at a random time, and repeat it."""
    run, problem = trained(commands)
    if problem:
        return problem
    folder = make_folder(commands.folder / f"export{number}{''.join(flags)}")
    words = ["mitigate", "export", str(run), "mine", "--out", str(folder), *flags]
    undisturbed = [*words[:4], "--out", str(folder / "undisturbed"), *flags]
    return interrupt_and_repeat(commands, number, words, folder / "mine", undisturbed)


def interrupt_programs(commands: Commands, number: int) -> str:
    """Send a signal to ``mitigate export --programs`` at a random time, and repeat it."""
    folder = make_folder(commands.folder / f"programs{number}")
    for name in ("harden", "undisturbed"):
        shutil.copytree(ROOT / HARDENED, folder / name)
    words = ["mitigate", "export", str(folder / "harden"), "--programs"]
    undisturbed = ["mitigate", "export", str(folder / "undisturbed"), "--programs"]
    return interrupt_and_repeat(commands, number, words, folder / "harden", undisturbed)


def interrupt_and_repeat(
    commands: Commands, number: int, words: list[str], target: Path, undisturbed: list[str]
) -> str:
    """Send a signal to the command ``words`` at a random time, and repeat the command.

    The folder ``target`` is checked after both runs.
    """
    began = time.monotonic()
    problem = commands.start(*undisturbed).problem(0)
    seconds = time.monotonic() - began
    if problem:
        return problem
    command = commands.start(*words)
    command.wait_for(lambda: False, commands.rng.uniform(0, 0.7 * seconds))  # it may be faster
    if not command.runs():
        return "not run: the export ended before the fault"
    command.process.send_signal(number)
    problem = command.problem(STATUS[signal.Signals(number)], 0)
    if target.exists():
        loading.check_hardened(target)
    if problem or (target / loading.PROGRAM).is_file():
        return problem
    problem = commands.start(*words).problem(0)
    loading.check_hardened(target)
    left = [path.name for path in target.parent.iterdir() if path.name.startswith(".")]
    return problem or (f"{left} were left" if left else "")


def trained(commands: Commands) -> tuple[Path, str]:
    """Return the folder of a small finished training run, and a description of the problem if
    training failed.
    """
    run = commands.folder / "trained"
    if (run / "agent").is_dir():
        return run, ""
    options = ["recipe=da_per_episode", "debug=smoke", "trainer.steps=1"]
    options += ["evaluation.enabled=false", f"folder={run}", f"runs={commands.folder}"]
    return run, commands.start("mitigate", "train", *options).problem(0)


def interrupt_onnx(commands: Commands) -> str:
    """Interrupt an export that writes ONNX files."""
    if find_spec("onnx") is None or find_spec("onnxruntime") is None:
        return "not run: onnx or onnxruntime is not installed"
    return interrupt_export(commands, signal.SIGKILL, "--onnx")


FAULTS: dict[str, Callable[[Commands], str]] = {
    "detached process": detach_process,
    "gibibyte of output": print_gigabyte,
    "dead first address": die_first_address,
    "SIGKILL in an export": lambda c: interrupt_export(c, signal.SIGKILL),
    "SIGTERM in an export": lambda c: interrupt_export(c, signal.SIGTERM),
    "SIGINT in an export": lambda c: interrupt_export(c, signal.SIGINT),
    "SIGKILL in an export of programs": lambda c: interrupt_programs(c, signal.SIGKILL),
    "SIGKILL in an export to ONNX": interrupt_onnx,
}


def break_commands(out: Path, seed: int, faults: list[str]) -> dict[str, str]:
    """Return the outcome of each fault: "survived", "not run: ..." or an error message."""
    commands = Commands(out, random.Random(f"{seed} commands"))
    outcomes = {}
    for name in faults:
        try:
            outcomes[name] = FAULTS[name](commands) or "survived"
        except (ValueError, OSError) as error:  # an exported folder is damaged or incomplete
            outcomes[name] = str(error)
    shutil.rmtree(out, ignore_errors=True)
    return outcomes
