"""Write a run's agent as a folder to ship: ``python -m mitigate.export runs/a my_agent``.

``checkpoints/hardened/<name>`` holds ``model.safetensors``, ``config.yaml`` and ``card.json`` (what
made it); it is renamed into place only after the weights were read back unchanged.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

from omegaconf import OmegaConf
from safetensors.torch import load_file

from mitigate import checkpoint
from mitigate.corruptions import SUITE_VERSION

HARDENED = Path("checkpoints/hardened")
VERSIONS = ("torch", "numpy", "panda3d")


def export(run: Path, name: str, *, out: Path = HARDENED) -> Path:
    """Copy the agent of the finished run folder ``run`` to ``out/name`` and return that folder.

    Raises FileNotFoundError if ``run`` holds no finished run, ValueError if ``out/name`` exists.
    """
    weights, config = run / "agent" / checkpoint.WEIGHTS, run / "config.yaml"
    if not (weights.is_file() and config.is_file()):
        raise FileNotFoundError(
            f"{run} holds no finished run: it needs config.yaml and agent/{checkpoint.WEIGHTS}. "
            "Run `make train` to the end, then name its folder (runs/...)."
        )
    target = out / name
    if target.exists():
        raise ValueError(f"{target} exists already: choose another name or delete it.")
    draft = out / f".{name}.tmp"
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir(parents=True)
    shutil.copyfile(weights, draft / checkpoint.WEIGHTS)
    shutil.copyfile(config, draft / "config.yaml")
    facts = json.dumps(card(run, name), indent=2) + "\n"
    (draft / "card.json").write_text(facts, encoding="utf-8")
    verify(draft)
    draft.rename(target)
    return target


def card(run: Path, name: str) -> dict:
    """Return what made the agent of ``run``: recipe, severity, seed, hashes, versions, licence."""
    cfg = OmegaConf.load(run / "config.yaml")
    base = checkpoint.weights_file(cfg.init) if cfg.init else None
    return {
        "name": name,
        "recipe": cfg.name,
        "severity": cfg.severity,
        "severity_depth": cfg.severity_depth,
        "seed": cfg.seed,
        "suite": SUITE_VERSION,
        "sha256": _sha256(run / "agent" / checkpoint.WEIGHTS),
        "base": cfg.init,
        "base_sha256": _sha256(base) if base else None,
        "commit": _commit(),
        "versions": {package: version(package) for package in VERSIONS},
        "license": "Apache-2.0",
    }


def verify(folder: Path) -> None:
    """Raise ValueError unless the weights in ``folder`` load and have the card's sha256."""
    facts = json.loads((folder / "card.json").read_text(encoding="utf-8"))
    file = folder / checkpoint.WEIGHTS
    if _sha256(file) != facts["sha256"]:
        raise ValueError(
            f"{file} does not have the sha256 that {folder / 'card.json'} states: it was changed "
            "or cut short. Fetch the folder again, or export it again."
        )
    load_file(file)


def _sha256(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _commit() -> str | None:
    """Return the git commit of the checkout, or None outside one."""
    command = ["git", "rev-parse", "HEAD"]
    found = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, text=True)
    return found.stdout.strip() or None if found.returncode == 0 else None


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="mitigate.export", description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="a finished run folder, such as runs/...")
    parser.add_argument("name", help="name of the folder to write")
    parser.add_argument("--out", type=Path, default=HARDENED, help="where to write it")
    given = parser.parse_args()
    try:
        print(f"wrote {export(given.run, given.name, out=given.out)}")
    except (ValueError, FileNotFoundError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
