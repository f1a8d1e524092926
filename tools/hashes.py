"""Print a hash of each corruption's output on a few frames or a text, so that environments can be
compared.

    python tools/hashes.py > here.txt    # then in another environment, and compare with diff

Random compositions are excluded, because their bits depend on the versions of numpy and OpenCV.
"""

from __future__ import annotations

import hashlib

import numpy as np

from mitigate.corruptions import INSTRUCTION, Key, corrupt, corrupt_instruction
from mitigate.corruptions.registry import modality, names, unseen_names

KEY = Key(0, "7", 3)
TEXT = "Walk past the red sofa, turn left and stop by the table."


def frames() -> dict[str, np.ndarray]:
    """Return three random views of 48 x 64 pixels: uint8 RGB, and float32 metres with 5 % holes."""
    rng = np.random.Generator(np.random.PCG64(0))
    rgb = rng.integers(0, 256, (3, 48, 64, 3), dtype=np.uint8)
    depth = rng.uniform(0.3, 9, (3, 48, 64, 1)).astype(np.float32)
    depth[rng.random(depth.shape) < 0.05] = 0
    return {"rgb": rgb, "depth": depth}


def main() -> None:
    """Print a line per corruption and severity."""
    clean = frames()
    sensors = ("rgb", "depth")
    for name in names(*sensors) + unseen_names(*sensors):
        for severity in (0.3, 0.6, 1.0):
            frame = corrupt(clean[modality(name)], name, severity, key=KEY)
            print(name, severity, hashlib.sha256(frame.tobytes()).hexdigest()[:12])
    for name in INSTRUCTION:
        for severity in (0.5, 1.0) if name != "white_box" else ():
            text = corrupt_instruction(TEXT, name, severity, KEY)
            print(name, severity, hashlib.sha256(text.encode()).hexdigest()[:12])


if __name__ == "__main__":
    main()
