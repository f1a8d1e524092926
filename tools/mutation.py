"""Introduce errors into central functions, one line at a time, and check that a test fails.

    python -m tools.mutation            every mutation (minutes)
    python -m tools.mutation kl spl     these mutations only

Each mutation is applied to a temporary copy of the checkout, in which its test file runs. If no
test fails, or if the line is no longer in the source, the command ends with status 1.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
COPIED = ("conf", "mitigate", "recipes", "tests", "tools", "pyproject.toml")
COMPILED = shutil.ignore_patterns("__pycache__")
TESTS_FAILED = 1  # exit status of pytest if tests failed; other values mean that no test ran


class Mutation(NamedTuple):
    """A wrong line of code, and the test file that must detect it."""

    source: str
    test: str
    old: str
    new: str


# each line has: name, source file, test file, part of a source line to replace, replacement
TABLE = """
seeding mitigate/core/seeding.py tests/core/test_seeding.py
- f"{type(part).__name__}:{part}" for part in key
+ f"{part}" for part in key
frame-key mitigate/corruptions/keying.py tests/corruptions/test_keying.py
- str(int(key.frame))
+ str(0)
schedule mitigate/corruptions/schedule.py tests/corruptions/test_schedule.py
- low + place * (high - low)
+ low + (high - low) / 2
kl recipes/distil.py tests/recipes/test_distil.py
- each = p.exp() * (p - q)
+ each = q.exp() * (q - p)
feature-mse recipes/distil.py tests/recipes/test_distil.py
- return error / teacher.float().var().clamp(min=1e-6)
+ return error
adapter mitigate/agents/adapter_layers.py tests/agents/test_adapters.py
- return through(self.gates, x, x + z)
+ return through(self.gates, x, x + z + 1e-6)
fusion mitigate/agents/fusion.py tests/agents/test_fusion.py
- torch.exp(-(rate * deviation).clamp(max=cap))
+ torch.exp(-(rate * deviation).clamp(max=2 * cap))
spl mitigate/worlds/measures.py tests/evaluation/test_metrics.py
- longer = max(geodesic_distance, length)
+ longer = length
prs mitigate/evaluation/metrics.py tests/evaluation/test_metrics.py
- float(np.mean(values / clean))
+ float(min(1.0, np.mean(values / clean)))
paired-bootstrap mitigate/evaluation/bootstrap.py tests/evaluation/test_bootstrap.py
- samples_a - samples_b)
+ samples_a - samples_b[::-1])
manifest mitigate/core/folders.py tests/core/test_folders.py
- and sha256(file) == entry.sha256
+ and bool(entry.sha256)
resume mitigate/evaluation/evaluator.py tests/evaluation/test_evaluator.py
- strict=True) if identity not in finished]
+ strict=True) if job]
"""
ENTRY = re.compile(r"^(\S+) (\S+) (\S+)\n- (.*)\n\+ (.*)$", re.MULTILINE)
MUTATIONS = {name: Mutation(*fields) for name, *fields in ENTRY.findall(TABLE)}


def outcome(mutation: Mutation) -> str:
    """Return "caught by <failing test>", or the reason why no test failed."""
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        copy = Path(folder)
        for name in COPIED:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, copy / name, symlinks=True, ignore=COMPILED)
            else:
                shutil.copy(ROOT / name, copy / name)
        # linked instead of copied, because this folder is large and no test writes to it
        (copy / "checkpoints").symlink_to(ROOT / "checkpoints")
        source = (copy / mutation.source).read_text(encoding="utf-8")
        if source.count(mutation.old) != 1:
            return f"not applied: {mutation.source} must have {mutation.old!r} exactly once"
        changed = source.replace(mutation.old, mutation.new)
        (copy / mutation.source).write_text(changed, encoding="utf-8")
        run = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-x", "-m", "not slow", mutation.test],
            cwd=copy,
            env={**os.environ, "PYTHONPATH": str(copy), "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
        )
    failed = [line.split()[1] for line in run.stdout.splitlines() if line.startswith("FAILED")]
    if run.returncode == TESTS_FAILED and failed:
        return f"caught by {failed[0]}"
    return f"NOT caught by {mutation.test} (pytest ended with status {run.returncode})"


def main() -> None:
    """Run the mutations that are named on the command line, or all mutations."""
    results = {}
    for name in sys.argv[1:] or MUTATIONS:
        start = time.monotonic()
        results[name] = outcome(MUTATIONS[name])
        print(f"{name}: {results[name]} ({time.monotonic() - start:.0f} s)", flush=True)
    missed = [name for name, text in results.items() if not text.startswith("caught")]
    print(f"{len(results) - len(missed)} of {len(results)} mutations caught.")
    sys.exit(bool(missed))


if __name__ == "__main__":
    main()
