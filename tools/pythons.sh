#!/usr/bin/env bash
# Makes environments with numpy in FOLDER/3.6, FOLDER/3.8 ... of the Pythons that pyenv or the
# system has, for tests/bridge/test_pythons.py: tools/pythons.sh FOLDER
set -euo pipefail
folder=${1:?Name a folder for the environments.}
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
