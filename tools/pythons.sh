#!/usr/bin/env bash
# Create environments for tests/bridge: tools/pythons.sh FOLDER
# FOLDER/3.6, FOLDER/3.8 ...: numpy, for each Python version that pyenv or the system has;
# FOLDER/lab: habitat-lab 0.3, without the parts that need habitat-sim.
set -euo pipefail
folder=${1:?FOLDER is missing: name a folder for the environments.}
for version in 3.6 3.8 3.9 3.11 3.13; do
  [ -x "$folder/$version/bin/python" ] && continue
  found=$(ls -d "${PYENV_ROOT:-$HOME/.pyenv}/versions/$version".*/bin/python 2>/dev/null | tail -1 || true)
  [ -n "$found" ] || found=$(command -v "python$version" || true)
  [ -n "$found" ] && "$found" -c 'import ensurepip' 2>/dev/null || { echo "no Python $version"; continue; }
  "$found" -m venv "$folder/.$version"
  "$folder/.$version/bin/python" -m pip install --quiet --disable-pip-version-check numpy
  mv "$folder/.$version" "$folder/$version"
  echo "Python $version: $("$folder/$version/bin/python" -c 'import numpy; print("numpy", numpy.__version__)')"
done
if [ ! -x "$folder/lab/bin/python" ] && [ -x "$folder/3.11/bin/python" ]; then
  rm -rf "$folder/.lab"
  "$folder/3.11/bin/python" -m venv "$folder/.lab"
  pip=("$folder/.lab/bin/python" -m pip install --quiet --disable-pip-version-check)
  "${pip[@]}" numpy==1.26.4 numba scipy hydra-core omegaconf attrs tqdm imageio imageio-ffmpeg \
    'opencv-python-headless<5' numpy-quaternion cloudpickle gym-notices
  "${pip[@]}" --no-deps gym==0.23.0 habitat-lab==0.3.320260507 # they pin more packages than they need
  mv "$folder/.lab" "$folder/lab"
fi
