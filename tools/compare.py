"""Compare the results of two commits on one machine: ``python tools/compare.py COMMIT [COMMIT]``.

The tool checks that moving or rewriting code has not changed results. It runs the usual commands in
a checkout of each commit. Every recipe trains for two steps, and every shipped agent is evaluated
in 20 episodes under the whole suite. Weights and rows must be equal bit for bit.

Training uses fp32, because older commits chose the precision by measured times, so their choice
could differ between runs. Results differ slightly between processors, so digests are valid only on
one machine. They are stored in ``runs/compare`` for later comparisons.

By default, the second commit is the working tree. The exit status is 1 if anything differs.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from safetensors.numpy import load_file

from mitigate.core.files import write_json

ROOT = Path(__file__).resolve().parent.parent
STORED = ROOT / "runs" / "compare"
AGENTS = {  # patterns of weight folders, and the kind of agent in them
    "checkpoints/base": "topological",
    "checkpoints/teacher": "topological",
    "checkpoints/hardened/*": "topological",
    **{f"checkpoints/{kind}/*": kind for kind in ("recurrent", "recurrent_rgb", "frontier")},
    "checkpoints/topological_imagenet/*": "topological_imagenet",
}
# entries of a result row that are labels instead of measured values
UNSTABLE = ("agent", "weights", "name", "rule")
EXTRA = {"safeguard_lora": ("stages.lora.recipe.pairs=2", "stages.lora.recipe.micro_batch=2")}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("commits", nargs="+", metavar="COMMIT", help="one or two commits")
    parser.add_argument("--only", nargs="*", help="names of recipes and agents (default all)")
    parser.add_argument("--episodes", type=int, default=20)
    args = parser.parse_args()
    if len(args.commits) > 2:
        parser.error(
            f"COMMIT must be one commit, to compare with the working tree, or two, got "
            f"{len(args.commits)}"
        )
    both = [measure(commit, args.only, args.episodes) for commit in (*args.commits, None)[:2]]
    names = list(dict.fromkeys(name for digests in both for name in digests))
    unknown = sorted({*(args.only or ())} - {name.rpartition("/")[2] for name in names})
    if unknown or not names:
        parser.error(f"there is nothing to compare: no recipe or agent {', '.join(unknown)}")
    differing = [name for name in names if len({digests.get(name) for digests in both}) > 1]
    for name in names:
        first, second = (digests.get(name, "missing") for digests in both)
        equal = "equal" if name not in differing else f"DIFFERS ({first} | {second})"
        print(f"{name:45s} {equal}")
    print(f"{len(names) - len(differing)} of {len(names)} equal")
    sys.exit(1 if differing else 0)


def measure(commit: str | None, only: list[str] | None, episodes: int) -> dict[str, str]:
    """Return the digest of each subject, for a commit or (if ``commit`` is None) the working tree.

    The digests of a commit are stored in a file and reused.
    """
    digests: dict[str, str] = {}
    sha = commit and run(["git", "rev-parse", "--short=12", f"{commit}^{{commit}}"], ROOT).strip()
    file = STORED / f"{sha}-{episodes}.json"
    if sha and file.is_file():
        digests = json.loads(file.read_text(encoding="utf-8"))
    with checkout(sha) as folder:
        for name, function in subjects(folder, episodes):
            if name in digests or (only and name.rpartition("/")[2] not in only):
                continue
            print(f"{sha or 'working tree'}: {name}", flush=True)
            digests[name] = function()
            if sha:
                write_json(file, digests, indent=2)
    return {n: v for n, v in digests.items() if not only or n.rpartition("/")[2] in only}


def subjects(folder: Path, episodes: int) -> Iterator[tuple]:
    """Yield the name of each recipe and agent in a checkout, with a function that computes its
    digest.
    """
    for path in sorted(folder.glob("conf/recipe/*.yaml")):
        yield f"recipe/{path.stem}", lambda name=path.stem: train(folder, name)
    agents = [(p, kind) for pattern, kind in AGENTS.items() for p in folder.glob(pattern)]
    for path, kind in sorted(agents):
        name = str(path.relative_to(folder))
        function = partial(evaluate, folder, name, kind, episodes)
        yield f"agent/{name.removeprefix('checkpoints/')}", function


def train(folder: Path, recipe: str) -> str:
    """Return a digest of the weights after two steps of every stage of a recipe."""
    with tempfile.TemporaryDirectory() as out:
        extra = EXTRA.get(recipe, ())
        options = [f"recipe={recipe}", "debug=smoke", "workers=0", "evaluation.enabled=false"]
        options.append("trainer.precision=fp32")
        python(folder, "train", *options, f"runs={out}", f"folder={out}/run", *extra)
        (file,) = Path(out, "run/agent").glob("*.safetensors")
        return tensors_digest(file)


def evaluate(folder: Path, checkpoint: str, kind: str, episodes: int) -> str:
    """Return a digest of the measured values in an agent's rows."""
    with tempfile.TemporaryDirectory() as out:
        options = [f"agent={kind}", f"checkpoint={checkpoint}", f"episodes={episodes}"]
        python(folder, "evaluate", *options, f"out={out}")
        lines = Path(out, "rows.jsonl").read_text(encoding="utf-8").splitlines()
        rows = [{k: v for k, v in json.loads(x).items() if k not in UNSTABLE} for x in lines]
        return digest(json.dumps(rows, sort_keys=True).encode())


def tensors_digest(file: Path) -> str:
    """Return a digest of the tensors in a safetensors file, without its metadata."""
    tensors = sorted(load_file(file).items())
    return digest(b"".join(name.encode() + value.tobytes() for name, value in tensors))


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:12]


def python(folder: Path, program: str, *options: str) -> None:
    """Run ``python -m mitigate.<program>`` in a checkout; print its output only if it fails."""
    run([sys.executable, "-m", f"mitigate.{program}", *options], folder)


def run(command: list[str], folder: Path) -> str:
    threads = {"OMP_NUM_THREADS": "1", "PYTHONPATH": str(folder)}
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **threads}, capture_output=True, text=True
    )
    if done.returncode:
        output = f"{done.stdout[-2000:]}{done.stderr[-4000:]}"
        sys.exit(f"{' '.join(command)} failed in {folder}:\n{output}")
    return done.stdout


@contextmanager
def checkout(sha: str | None) -> Iterator[Path]:
    """Yield a folder with the files of a commit; for None, yield the working tree."""
    if sha is None:
        yield ROOT
        return
    folder = Path(tempfile.mkdtemp(prefix=f"compare-{sha}-"))
    try:
        run(["git", "worktree", "add", "--detach", "--force", str(folder), sha], ROOT)
        yield folder
    finally:
        run(["git", "worktree", "remove", "--force", str(folder)], ROOT)
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
