"""Tests that corrupted pixels do not depend on the order, the batch or the process."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mitigate.corruptions import NAMES, RGB, Key, corrupt, keying

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = """
import hashlib, numpy as np
from mitigate.corruptions import NAMES, RGB, Key, corrupt
y, x = np.mgrid[:16, :24]
depth = (1 + (3 * x + 5 * y) % 37 / 8).astype(np.float32)
rgb = np.stack([(x * 9 + y * c) % 256 for c in (3, 5, 7)], -1).astype(np.uint8)
frames = {name: corrupt(rgb if name in RGB else depth, name, 0.6, key=Key(1, "e", 2))
          for name in NAMES}
print(hashlib.sha256(b"".join(frames[name].tobytes() for name in NAMES)).hexdigest())
"""


def test_processes_with_different_hash_seeds_agree():
    answers = []
    for salt in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": salt, "PYTHONPATH": str(ROOT)}
        answers.append(
            subprocess.run(
                [sys.executable, "-c", PROGRAM],
                env=environment, cwd=ROOT, capture_output=True, text=True, check=True,
            ).stdout
        )  # fmt: skip
    assert answers[0] == answers[1] and len(answers[0].strip()) == 64


@pytest.mark.parametrize("name", NAMES)
def test_order_and_neighbours_in_a_batch_do_not_matter(name, panorama):
    frame = panorama[0][:3] if name in RGB else panorama[1][:3]
    instants = [Key(5, f"episode {i % 3}", i) for i in range(8)]
    alone = {key: corrupt(frame, name, 0.6, key=key, heading=0.1) for key in instants}
    np.random.seed(1)
    for key in reversed(instants):
        corrupt(frame, name, 0.3, key=key)
        np.random.random(3)
        again = corrupt(frame, name, 0.6, key=key, heading=0.1)
        assert again.tobytes() == alone[key].tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_first_views_do_not_depend_on_later_ones(name, panorama):
    frame = panorama[0] if name in RGB else panorama[1]
    whole = corrupt(frame, name, 0.6, key=Key(0, "e"), heading=0.1)
    some = corrupt(frame[:5], name, 0.6, key=Key(0, "e"), heading=0.1)
    assert whole[:5].tobytes() == some.tobytes()


def test_key_depends_on_every_part():
    keys = [Key(0, "a"), Key(1, "a"), Key(0, "b"), Key(0, "a", 1), Key(0, "1:a"), Key(1, "")]
    digests = {keying.digest(key, "x", frame=True) for key in keys}
    digests |= {keying.scramble(keying.digest(Key(0, "a"), "x", frame=True), k) for k in range(12)}
    digests |= {keying.digest(Key(0, "a"), "y", frame=True), keying.digest(Key(0, "a"), "x")}
    assert len(digests) == len(keys) + 14
    assert keying.digest(Key(0, "a", 5), "x") == keying.digest(Key(0, "a", 9), "x")


def test_parts_cannot_run_into_each_other():
    assert keying.digest(Key(1, "11:x"), "y") != keying.digest(Key(11, "1:x"), "y")
    assert keying.digest(Key(0, "a"), "bc") != keying.digest(Key(0, "ab"), "c")


def test_key_accepts_any_string_and_integer():
    for episode in ("", "ü\n", "\ud800", "x" * 10_000):
        assert keying.digest(Key(-5, episode), "x") >= 0
    assert keying.digest(Key(np.int64(3), "a"), "x") == keying.digest(Key(3, "a"), "x")


@pytest.mark.parametrize("parts", [(0, "17", None), ("a", "1"), (1.9, "x"), (0, "x", 2.0)])
def test_key_rejects_seed_or_frame_that_is_not_an_integer(parts):
    with pytest.raises(ValueError, match="seed and the frame of a key must be whole numbers"):
        Key(*parts)


def test_digest_matches_the_published_value():
    text = b"1:3" + b"1:e" + b"4:name" + b"1:7"
    expected = hashlib.blake2b(text, digest_size=8, person=b"mitigate").digest()
    assert keying.digest(Key(3, "e", 7), "name", frame=True) == int.from_bytes(expected, "little")


def test_compiled_hash_is_splitmix64():
    # Reference output of splitmix64 with seed 1234567 (Vigna's C code).
    assert keying.scramble(1234567, 0) == 6457827717110365317
    assert keying.scramble(1234567, 1) == 3203168211198807973
    value = keying.digest(Key(0, "a"), "x")
    words = [keying.scramble(value, i) for i in range(3)]
    table = keying.normal_table()
    expected = [table[(words[i >> 2] >> (16 * (i & 3) + 4)) & 0xFFF] for i in range(12)]
    assert keying.normals(value, 12).tolist() == np.array(expected).tolist()


def test_normals_are_normal():
    from scipy import stats

    draws = keying.normals(keying.digest(Key(0, "a"), "x"), 200_000)
    assert abs(draws.mean()) < 0.01 and abs(draws.std() - 1) < 0.01
    assert stats.kstest(draws[:20_000], "norm").pvalue > 0.001
    assert abs(np.corrcoef(draws[:-1], draws[1:])[0, 1]) < 0.01


def test_field_has_unit_spread_and_the_requested_correlation():
    fields = [keying.field(keying.digest(Key(i, "f"), "x"), 96, 128, 0.025)[0] for i in range(12)]
    cells = np.stack(fields)
    assert abs(cells.mean()) < 0.1 and abs(cells.std() - 1) < 0.05
    # a lag of two sigmas of the blur kernel, at which the correlation is exp(-4 / 4)
    lag = round(0.025 * 96 * 2)
    shifted = np.roll(cells, lag, axis=2)
    assert np.mean(cells * shifted) / cells.var() == pytest.approx(np.exp(-1), abs=0.08)


def test_field_of_a_narrow_frame_is_bounded():
    value = keying.digest(Key(0, "f"), "x")
    assert keying.field(value, 30, 120, 0.025)[1].size == 128 * 512
    smooth, cells = keying.field(value, 1, 16_000, 0.025)
    assert smooth.shape == (1, 16_000) and cells.size == 128 * 4096
    assert np.isfinite(smooth).all() and 0.5 < smooth.std() < 1.5
    frame = np.full((16_000, 1), 3.0, np.float32)
    assert (corrupt(frame, "missing_data", 0.6, key=Key(0, "a")) != frame).any()


def test_field_wraps_and_scales_to_half_size():
    value = keying.digest(Key(0, "f"), "x")
    full, cells = keying.field(value, 256, 320, 0.018)
    half, _ = keying.field(value, 128, 160, 0.018)
    pooled = full.reshape(128, 2, 160, 2).mean((1, 3))
    assert np.abs(pooled - half).mean() < 0.04
    seam, inside = np.abs(full[:, 0] - full[:, -1]), np.abs(np.diff(full, axis=1))
    assert seam.mean() < 2 * inside.mean()
    for share in (0.05, 0.3, 0.5):
        level = keying.top_share(cells, share)
        assert (full >= level).mean() == pytest.approx(share, abs=0.01)
    assert keying.top_share(cells, 0.0) == float("inf")
