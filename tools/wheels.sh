#!/usr/bin/env bash
# Build the wheels of mitigate and mitigate-weights, install them with their dependencies in an empty
# environment, and use them outside the checkout:
#   tools/wheels.sh [FOLDER]
# PYTHON is the interpreter (default .venv/bin/python); its packages are not used. The dependencies
# come from the package index or pip's cache. FOLDER gets the wheels, the environment and the runs
# (default: a temporary folder).
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=${PYTHON:-$root/.venv/bin/python}
max_bytes=3000000 # of the code's wheel
work=${1:-$(mktemp -d)}
mkdir -p "$work/wheels" "$work/empty"

"$python" -m venv "$work/build"
"$work/build/bin/python" -m pip install --quiet --disable-pip-version-check 'hatchling>=1.25'
for source in "$root" "$root/checkpoints"; do
  "$work/build/bin/python" -m pip wheel --quiet --disable-pip-version-check --no-deps \
    --no-build-isolation --wheel-dir "$work/wheels" "$source"
done
ls -l "$work/wheels"
code=("$work"/wheels/mitigate-[0-9]*.whl)
[ "$(stat -c %s "${code[0]}")" -le "$max_bytes" ] || { echo "${code[0]} must have <= $max_bytes bytes." >&2; exit 1; }

"$python" -m venv "$work/venv" # without the packages of $python
pip=("$work/venv/bin/python" -m pip install --quiet --disable-pip-version-check)
"${pip[@]}" "${code[0]}"

cd "$work/empty"
unset PYTHONPATH MITIGATE_WEIGHTS
export PATH=$work/venv/bin:$PATH OMP_NUM_THREADS=1
python - <<'END'
"""The suite without torch, and the error for weights that are not installed."""
from importlib.util import find_spec

import numpy as np
import mitigate
from mitigate.core.files import find
from mitigate.corruptions import Key, corrupt

assert not any(map(find_spec, ("torch", "hydra", "pytest"))), "the environment is not empty"
assert "site-packages" in mitigate.__file__
frame = np.full((48, 64, 3), 128, np.uint8)
assert (corrupt(frame, "spatter", 0.6, key=Key(0, "1", 0)) != frame).any()
try:
    find("checkpoints/base")
except FileNotFoundError as error:
    assert "mitigate-weights (not installed)" in str(error), error
else:
    raise AssertionError("weights without mitigate-weights")
END
"${pip[@]}" torch==2.13.0 # as the Makefile
"${pip[@]}" "${code[0]}[train]" "$work"/wheels/mitigate_weights-*.whl
du -sh "$work/venv"
mitigate train recipe=da_per_episode debug=smoke trainer.steps=2 workers=0 rollouts=2 \
  stages.perception_rgb.recipe.panoramas=2 stages.perception_depth.recipe.panoramas=2 \
  evaluation.enabled=false folder=run
mitigate evaluate checkpoint=run/agent episodes=2 'conditions=[clean]' workers=1 out=rows
mitigate export run mine --out hardened
rm hardened/mine/program.pt2
mitigate export hardened/mine --programs
python -c 'import mitigate; print(type(mitigate.load("hardened/mine")).__name__)'
echo "The wheels train, evaluate and export in $work/empty."
