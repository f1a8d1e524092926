"""Tests of the command ``mitigate``: its list of commands, and messages about missing packages."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import mitigate
from mitigate import cli

ROOT = Path(__file__).parent.parent


@pytest.fixture(autouse=True)
def own_command_line(monkeypatch):
    """Restore ``sys.argv``, which a command sets."""
    monkeypatch.setattr(sys, "argv", [*sys.argv])


def test_help_lists_every_command_with_an_example(capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(["--help"])
    printed = capsys.readouterr().out
    assert ended.value.code == 0
    for name, command in cli.COMMANDS.items():
        assert command.about in printed and f"mitigate {name}" in printed


def test_unknown_command_names_the_nearest():
    with pytest.raises(SystemExit, match="Did you mean train"):
        cli.main(["trian"])


def test_modules_are_those_that_the_documentation_runs():
    """``python -m mitigate.train`` is equivalent to ``mitigate train``; newer commands have only
    the form ``mitigate NAME``."""
    modules = {path.stem for path in (ROOT / "mitigate/commands").glob("*.py")}
    pages = [
        *ROOT.glob("*.md"),
        ROOT / "Makefile",
        *ROOT.glob("docs/**/*.md"),
        *ROOT.glob("conf/*"),
    ]
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages if page.is_file())
    named = {*re.findall(r"-m mitigate\.(\w+)(?![\w.])", text)}
    assert named & {*cli.COMMANDS} == modules


def test_options_are_read_before_torch_is_imported():
    """``--help`` and invalid options must be answered without importing torch, which takes
    seconds."""
    modules = [command.module for command in cli.COMMANDS.values()]
    code = (
        f"import sys, importlib; [importlib.import_module(name) for name in {modules}]\n"
        "from mitigate.core import conf; from omegaconf import OmegaConf\n"
        "cfg = conf.load_config('train', ['recipe=base', 'folder=x'])\n"
        "OmegaConf.to_container(cfg.stages, resolve=True)\n"
        "assert 'torch' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("command", [["-m", "mitigate"], ["-m", "mitigate.table"]])
def test_both_command_forms_reach_the_program(command, tmp_path):
    options = ["table", "nowhere"] if command[-1] == "mitigate" else ["nowhere"]
    done = subprocess.run(
        [sys.executable, *command, *options], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2 and "nowhere" in done.stderr and "Traceback" not in done.stderr


def test_interrupted_command_ends_in_one_line(monkeypatch, capsys):
    def stopped(*_, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("mitigate.evaluation.table.run", stopped)
    with pytest.raises(SystemExit) as ended:
        cli.main(["table", "docs/results"])
    assert ended.value.code == 130 and capsys.readouterr().err == "\nmitigate table: stopped.\n"


def test_missing_package_names_the_install_command(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm", None)
    for module in list(sys.modules):
        if module.startswith("mitigate.corruptions.f"):
            monkeypatch.delitem(sys.modules, module)
    with pytest.raises(SystemExit, match=r"needs tqdm.*pip install -e '.\[files\]'"):
        cli.main(["corrupt", "--list"])


def test_package_missing_later_is_reported(monkeypatch, tmp_path):
    def main():
        raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib.figure")

    monkeypatch.setattr("mitigate.evaluation.table.main", main)
    with pytest.raises(SystemExit, match=r"table needs matplotlib.*pip install -e '.\[train\]'"):
        cli.main(["table", "rows.jsonl"])


def test_missing_user_module_is_not_called_a_package(monkeypatch):
    def main():
        raise ModuleNotFoundError("No module named 'mine'", name="mine")

    monkeypatch.setattr("mitigate.evaluation.table.main", main)
    with pytest.raises(ModuleNotFoundError, match="mine"):
        cli.main(["table", "rows.jsonl"])


def test_package_attributes_name_what_they_need(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.delitem(sys.modules, "mitigate.agents.loading", raising=False)
    with pytest.raises(ImportError, match=r"mitigate.load needs torch, which is not installed"):
        mitigate.load  # noqa: B018


def test_dash_in_a_command_is_an_underscore(capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(["export-scene", "--help"])
    assert ended.value.code == 0 and "OUT/scenes/apartments" in capsys.readouterr().out


def test_closed_pipe_ends_the_command_silently():
    reader, writer = os.pipe()
    # unset before the process starts, so that processes of other tests do not inherit it
    os.close(reader)
    command = [sys.executable, "-m", "mitigate.table1", "--help"]
    process = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE)
    os.close(writer)
    assert (process.stderr, process.returncode) == (b"", 141)


def test_help_into_a_closed_pipe_ends_without_a_traceback():
    reader, writer = os.pipe()
    os.close(reader)
    program = "from mitigate.cli import main; main(['--help'])"
    process = subprocess.run([sys.executable, "-c", program], stdout=writer, stderr=subprocess.PIPE)
    os.close(writer)
    assert (process.stderr, process.returncode) == (b"", 128 + signal.SIGPIPE)


def run_python(code, *, shell="", **variables):
    """Run Python code as a command, and return its result. ``shell`` redirects its streams."""
    environment = {**os.environ, "CODE": code, **variables}
    command = f'exec "$0" -c "$CODE" {shell}'
    return subprocess.run(
        ["sh", "-c", command, sys.executable],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        errors="replace",
    )


PRINTS = (
    "import os; from mitigate import cli; from mitigate.core import doctor\n"
    "def main():\n"
    "    print('Küche \u2013 \\udcff', flush=True)\n"
    "    file = open(os.environ['FILE'], 'wb')\n"
    "    os.system('echo printed by a child')\n"
    "    file.write(b'data'); file.close()\n"
    "doctor.main = main\n"
    "cli.main(['doctor'])"
)


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_command_prints_characters_that_the_encoding_lacks(tmp_path, encoding):
    """Issue T2 (faults): the output encoding lacks some characters."""
    done = run_python(PRINTS, PYTHONIOENCODING=encoding, FILE=str(tmp_path / "file"))
    assert done.returncode == 0 and "\\udcff" in done.stdout, done.stderr


@pytest.mark.parametrize("shell", [">&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_command_with_closed_streams_prints_into_no_file(tmp_path, shell):
    """Issue T2 (faults): stdout is closed."""
    file = tmp_path / "file"
    done = run_python(PRINTS, shell=shell, FILE=str(file))
    assert done.returncode == 0 and file.read_bytes() == b"data", done.stderr


def test_sigterm_runs_the_cleanup_of_a_command():
    """Issue T2 (faults): a signal arrives during an export."""
    code = (
        "import os, signal; from mitigate import cli; from mitigate.core import doctor\n"
        "def main():\n"
        "    try:\n        os.kill(os.getpid(), signal.SIGTERM)\n"
        "    finally:\n        print('cleaned')\n"
        "doctor.main = main\n"
        "cli.main(['doctor'])"
    )
    done = run_python(code)
    assert (done.returncode, done.stdout) == (143, "cleaned\n"), done.stderr
