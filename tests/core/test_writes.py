"""Tests that only ``core/output.py`` and ``core/files.py`` write files; the tests read the source.

``open_output`` rejects links, FIFOs and devices. Any other call that writes a file must be listed
here with a reason.
"""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("mitigate", "recipes", "tools")
WRITERS = {  # names of functions and methods that write to a path
    *("write_text", "write_bytes", "touch", "mkdir", "makedirs", "symlink_to", "hardlink_to"),
    *("imwrite", "savefig", "savez", "savez_compressed", "save_file", "save_pretrained", "memmap"),
    *("copy2", "copyfile", "copytree", "copymode", "FileHandler", "SummaryWriter", "Writer1"),
    *("Writer2", "VideoWriter", "NamedTemporaryFile", "mkstemp"),
}
QUALIFIED = {
    "torch.save",
    "np.save",
    "shutil.copy",
    "shutil.move",
    "os.open",
    "os.link",
    "sqlite3.connect",
}
# a module of functions that write safely, although some are named like those in WRITERS
FILES = "mitigate.core.files"
DRAFT = "writes a file with a random name that write_atomically made, or a file in memory"
OWN = "writes into a private temporary folder that it has just made"
ALLOWED = {
    ("mitigate/core/output.py", "mkdir"): "make_checked, which checks links first",
    ("mitigate/core/output.py", "os.open"): "the opener",
    ("mitigate/core/files.py", "write_bytes"): DRAFT,
    ("mitigate/core/files.py", "savefig"): DRAFT,
    ("mitigate/core/files.py", "open"): "syncs a file with a random name; it truncates nothing",
    ("mitigate/core/files.py", "os.open"): "opens a folder for reading, to flush it to disk",
    ("mitigate/core/checkpoint.py", "save_file"): DRAFT,
    ("mitigate/training/states.py", "torch.save"): DRAFT,
    ("mitigate/bridge/check.py", "savez"): DRAFT,
    ("mitigate/evaluation/page/walks.py", "savefig"): DRAFT,
    ("mitigate/corruptions/frame_files.py", "np.save"): DRAFT,
    ("recipes/dagger.py", "torch.save"): DRAFT,
    ("mitigate/agents/topological/stored.py", "mkdir"): OWN,
    ("mitigate/agents/topological/stored.py", "memmap"): OWN,
    ("mitigate/guards/text/language_models/adapter_folder.py", "save_pretrained"): OWN,
    ("mitigate/agents/vlm/agent.py", "save_pretrained"): OWN,
    ("mitigate/guards/text/fit.py", "save_file"): OWN,
    ("mitigate/core/folders.py", "open"): "syncs a file of its draft; it truncates nothing",
    ("mitigate/shipping/export.py", "copytree"): OWN,
    ("mitigate/shipping/export.py", "save_file"): OWN,
    ("mitigate/shipping/export.py", "write_bytes"): OWN,
    ("mitigate/shipping/export.py", "write_text"): OWN,
    ("mitigate/replay/export_drive.py", "Writer1"): OWN,
    ("mitigate/replay/export_drive.py", "Writer2"): OWN,
    ("mitigate/training/journal.py", "SummaryWriter"): "names its file by time and process; "
    "event files that exist are checked before",
    (
        "mitigate/guards/text/language_models/answers.py",
        "sqlite3.connect",
    ): "SQLite; the file is checked by open_output before",
    ("mitigate/worlds/recorded/unpacking.py", "sqlite3.connect"): "reads, with immutable=1",
    ("mitigate/guards/text/language_models/base.py", "save_pretrained"): OWN,
    ("mitigate/bridge/events.py", "mkdir"): "fails if anything has the name",
    ("mitigate/bridge/connection.py", "os.open"): "a random name and O_EXCL",
    ("mitigate/bridge/hook/mitigate_hook.py", "open"): "a marker in the server's private folder",
    ("mitigate/bridge/hook/mitigate_hook.py", "os.open"): "memory that the server has named",
    ("mitigate/training/ranks.py", "open"): "the null device, as standard output",
    ("mitigate/cli.py", "os.open"): "the null device, in place of closed streams",
    ("mitigate/cli.py", "open"): "a standard stream, by its number",
    ("tools/third_party/ppo.py", "mkdir"): "the folder of the weights in a checkout",
    ("tools/third_party/torchrl_ppo.py", "save_file"): "weights in a checkout",
    ("tools/third_party/mujoco_reacher.py", "save_file"): "weights in a checkout",
    ("tools/small_vlm.py", "save_pretrained"): "a new model folder that the user names",
    ("tools/faults/evaluation.py", "copytree"): "breaks a run on purpose",
    ("tools/faults/evaluation.py", "write_bytes"): "breaks a run on purpose",
    ("tools/faults/evaluation.py", "symlink_to"): "breaks a run on purpose",
    ("tools/faults/training.py", "write_bytes"): "breaks a run on purpose",
    ("tools/faults/training.py", "symlink_to"): "breaks a run on purpose",
    ("tools/faults/commands.py", "copytree"): "copies a shipped folder to break the copy",
    ("tools/faults/disk.py", "mkdir"): "a mount point of its own",
    ("tools/mutation.py", "copytree"): OWN,
    ("tools/mutation.py", "shutil.copy"): OWN,
    ("tools/mutation.py", "symlink_to"): OWN,
    ("tools/mutation.py", "write_text"): OWN,
}


def imported(tree: ast.AST) -> set[str]:
    """Return the names that a module imports from ``mitigate/core/files.py``."""
    matches = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.module == FILES]
    return {alias.asname or alias.name for node in matches for alias in node.names}


def mode_of(call: ast.Call, place: int) -> str:
    """Return the mode that is passed to ``open``, or "" for reading."""
    named = [key.value for key in call.keywords if key.arg == "mode"]
    arguments = [*named, *call.args[place : place + 1]]
    return str(arguments[0].value) if arguments and isinstance(arguments[0], ast.Constant) else ""


def writes(source: str) -> Counter[str]:
    """Return how often ``source`` calls each function that writes to a path."""
    tree = ast.parse(source)
    ours, matches = imported(tree), Counter()
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = ast.unparse(node.func)
        last = name.rpartition(".")[2]
        if name in ("os.open", "builtins.open", "io.open", "gzip.open", "open") or last == "open":
            place = 0 if "." in name and name.split(".")[0] not in ("io", "gzip", "builtins") else 1
            if name == "os.open" or set(mode_of(node, place)) & set("wax+"):
                matches[name if name == "os.open" else "open"] += 1
        elif name in QUALIFIED:
            matches[name] += 1
        elif last in WRITERS and not (name in ours or name.startswith("files.")):
            matches[last] += 1
    return matches


SOURCES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))


def test_writes_go_through_the_opener():
    matches = set()
    for path in SOURCES:
        name = str(path.relative_to(ROOT))
        matches |= {(name, call) for call in writes(path.read_text(encoding="utf-8"))}
    assert not matches - ALLOWED.keys(), "use mitigate/core/output.py or files.py"
    assert not ALLOWED.keys() - matches, "these are no longer there"


@pytest.mark.parametrize(
    "source",
    [
        'open(path, "w")',
        'open(path, mode="ab+")',
        'path.open("w")',
        'path.open(mode="x")',
        'gzip.open(path, "wt")',
        "os.open(path, os.O_WRONLY)",
        "path.write_text(text)",
        "path.write_bytes(data)",
        "torch.save(state, path)",
        "np.save(path, array)",
        "np.savez(path, array)",
        "cv2.imwrite(path, picture)",
        "figure.savefig(path)",
        "shutil.copy(a, b)",
        "logging.FileHandler(path)",
        "path.touch()",
        "path.mkdir(parents=True, exist_ok=True)",
    ],
)
def test_writes_finds_a_direct_write(source):
    assert writes(source)


@pytest.mark.parametrize(
    "source",
    [
        "open(path)",
        'open(path, "rb")',
        'path.open("rb")',
        "Image.open(path)",
        'open_output(path, "w")',
        "from mitigate.core.files import write_bytes\nwrite_bytes(path, data)",
    ],
)
def test_writes_passes_over_what_reads_or_uses_the_opener(source):
    assert not writes(source)
