"""Tests that pixels do not change without a new SUITE_VERSION or a new corruption version.

To accept new pixels, increase ``SUITE_VERSION`` in ``mitigate/corruptions/suite.py`` (for an unseen
or broad corruption, increase ``version`` in its record), look at the contact sheet (``python -m
tools.pages.gallery --out sheet.png``), then run

    python tests/corruptions/test_golden.py --write

from the project root, commit ``golden.json`` and state in the changelog what changed and why.
Result rows of different suite versions cannot be compared.
"""

import hashlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from mitigate.corruptions import NAMES, SUITE_VERSION, Key, corrupt
from mitigate.corruptions.registry import BROAD, SENSORS, modality, record, unseen_names

GOLDEN = Path(__file__).with_name("golden.json")
UNSEEN = (*unseen_names("rgb", "depth"), *SENSORS)
SEVERITIES = (0.05, 0.5, 0.6, 1.0)


def frames():
    """Return a panorama computed from integers, so that the input does not depend on a maths
    library."""
    k, y, x = np.mgrid[:12, :48, :64]
    rgb = np.stack([(x * 5 + y * c + 40 * k + (x // 9) * (y // 7)) % 256 for c in (3, 4, 6)], -1)
    depth = 0.5 + ((x // 8) * 7 + (y // 6) * 11 + k * 5) % 37 / 4 + x / 256
    depth = np.where((x + y + k) % 41 == 0, 0.0, depth)
    return rgb.astype(np.uint8), depth.astype(np.float32)[..., None]


def fingerprint(name: str, severity: float) -> str:
    """Return the hash of the pixels; depth is rounded to 0.1 mm first."""
    rgb, depth = frames()
    key = Key(2024, "golden", 13)
    seen = modality(name) == "rgb"
    out = corrupt(rgb if seen else depth, name, severity, key=key, heading=0.7)
    if not seen:
        out = np.rint(out * np.float32(1e4)).astype(np.int32)
    return hashlib.blake2b(out.tobytes(), digest_size=16).hexdigest()


def levels(name: str) -> list[float]:
    """Return the mean pixel value of each of 24 compositions. Means are compared instead of hashes,
    because OpenCV gives different bits on different machines."""
    frame = frames()[modality(name) != "rgb"]
    drawn = [corrupt(frame, name, 0.6, key=Key(2024, f"golden {i}", 13)) for i in range(24)]
    return [round(float(output.mean(dtype=np.float64)), 3) for output in drawn]


def current() -> dict:
    hashes = {name: {str(s): fingerprint(name, s) for s in SEVERITIES} for name in NAMES}
    unseen = {
        name: {"version": record(name).version, **{str(s): fingerprint(name, s) for s in (0.6, 1)}}
        for name in UNSEEN
    }
    broad = {name: {"version": record(name).version, "levels": levels(name)} for name in BROAD}
    return {"suite": SUITE_VERSION, "pixels": hashes, "unseen": unseen, "broad": broad}


@pytest.mark.parametrize("name", NAMES)
def test_pixels_are_those_of_the_suite_version(name):
    golden = json.loads(GOLDEN.read_text())
    assert golden["suite"] == SUITE_VERSION, "SUITE_VERSION changed: regenerate (see the docstring)"
    for severity in SEVERITIES:
        matches = fingerprint(name, severity)
        assert matches == golden["pixels"][name][str(severity)], (name, severity, __doc__)


@pytest.mark.parametrize("name", UNSEEN)
def test_unseen_pixels_match_their_version(name):
    golden = json.loads(GOLDEN.read_text())["unseen"][name]
    assert golden.pop("version") == record(name).version, "regenerate (see the docstring)"
    for severity, expected in golden.items():
        assert fingerprint(name, float(severity)) == expected, (name, severity, __doc__)


@pytest.mark.parametrize("name", BROAD)
def test_broad_compositions_match_their_version(name):
    golden = json.loads(GOLDEN.read_text())["broad"][name]
    assert golden["version"] == record(name).version, "regenerate (see the docstring)"
    near = 0.5 if modality(name) == "rgb" else 0.02
    assert levels(name) == pytest.approx(golden["levels"], abs=near), (name, __doc__)


if __name__ == "__main__":
    if sys.argv[1:] != ["--write"]:
        sys.exit(__doc__)
    GOLDEN.write_text(json.dumps(current(), indent=1) + "\n")
    print(f"Wrote {GOLDEN}")
