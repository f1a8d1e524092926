"""Write the mean of two agents' weights: tools/mean_weights.py FOLDER FOLDER OUT

    python tools/mean_weights.py runs/recurrent_wide runs/recurrent_on/agent runs/recurrent_mean

Of one architecture, the second trained on from the first (Wortsman et al. 2022, "model soups"):
elsewhere the mean of weights means nothing. OUT takes the second one's config.
"""

from __future__ import annotations

import sys
from pathlib import Path

from safetensors.torch import save_file

from mitigate.core import checkpoint, checksums
from mitigate.core.files import write_bytes


def main() -> None:
    """Run from the command line."""
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    first, second, out = map(Path, sys.argv[1:])
    one, other = (checkpoint.load_tensors(f / "model.safetensors") for f in (first, second))
    if {n: t.shape for n, t in one.items()} != {n: t.shape for n, t in other.items()}:
        sys.exit(f"{first} and {second} are not of one architecture: they have other tensors.")
    file = out / "model.safetensors"
    mean = {n: (one[n].float() + other[n].float()) / 2 for n in one}
    checksums.write(file, lambda temporary: save_file(mean, temporary))
    write_bytes(out / "config.yaml", (second / "config.yaml").read_bytes())
    print(f"wrote {file}")


if __name__ == "__main__":
    main()
