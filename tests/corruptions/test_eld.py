"""Tests that compare the sensor model with published constants and with a slow direct sampler."""

import numpy as np
import pytest

from mitigate.corruptions import Key, corrupt
from mitigate.corruptions.eld import (
    LEVELS,
    low_light_noise,
    noise_at,
    tables,
    tukey_lambda,
)
from mitigate.corruptions.keying import digest
from mitigate.corruptions.masks import light_loss


@pytest.mark.parametrize(
    "severity, gain, read, row",
    [(0.5, 0.751, 1.54, 0.48), (0.6, 1.139, 1.87, 0.59), (1.0, 6.011, 4.03, 1.43)],
)
def test_sony_parameters_are_the_published_ones(severity, gain, read, row):
    noise = noise_at(severity)
    assert noise.gain == pytest.approx(gain, rel=2e-3)
    assert noise.read == pytest.approx(read, abs=0.006)
    assert noise.row == pytest.approx(row, abs=0.006)
    assert noise.ratio == pytest.approx(300**severity)


def test_tukey_lambda_passes_through_the_logistic():
    u = np.linspace(0.001, 0.999, 99)
    assert tukey_lambda(u, 0.0) == pytest.approx(tukey_lambda(u, 1e-6), abs=1e-4)
    assert tukey_lambda(u, 0.0) == pytest.approx(np.log(u / (1 - u)))
    from scipy import stats

    assert tukey_lambda(u, -0.14) == pytest.approx(stats.tukeylambda.ppf(u, -0.14))


def slow_sample(levels, gain, severity, rng):
    """Sample from the documented model directly, for uint8 levels [V, H, W, 3] and a gain mask [H,
    W]."""
    noise = noise_at(severity)
    light = (levels / 255 * gain[..., None]) ** 2.2
    electrons = rng.poisson(light * 15583 / noise.ratio / noise.gain)
    read = noise.read * tukey_lambda(rng.random(levels.shape), noise.shape)
    row = noise.row * rng.standard_normal((*levels.shape[:2], 1, 1))
    digital = np.rint(noise.gain * electrons + read + row)
    bright = np.clip(digital * noise.ratio / 15583, 0, 1)
    return np.rint(255 * bright ** (1 / 2.2)).astype(np.uint8)


@pytest.mark.slow
@pytest.mark.parametrize("severity", [0.1, 0.3, 0.6, 0.8, 1.0])
@pytest.mark.parametrize("level", [0, 12, 90, 220])
def test_tables_match_the_slow_sampler(severity, level):
    views = np.full((48, 64, 64, 3), level, np.uint8)
    key = Key(0, "a")
    slow = slow_sample(
        views,
        1 - light_loss(digest(key, "low_light"), severity, 64, 64),
        severity,
        np.random.default_rng(0),
    )
    fast = low_light_noise(views, severity, key)
    assert fast.mean() == pytest.approx(slow.mean(), abs=0.15 + 0.006 * slow.mean())
    assert fast.std() == pytest.approx(slow.std(), rel=0.03, abs=0.15)
    for share in (0.05, 0.25, 0.5, 0.75, 0.95):
        assert abs(np.quantile(fast, share) - np.quantile(slow, share)) <= 0.02 * 255
    rows = [x.mean((2, 3)) - x.mean((0, 2, 3)) for x in (fast, slow)]
    assert rows[0].std() == pytest.approx(rows[1].std(), rel=0.15, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("severity", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("level", [12, 90, 220])
def test_distribution_matches_the_slow_sampler(severity, level):
    from scipy import stats

    views = np.full((48, 64, 64, 3), level, np.uint8)
    key = Key(0, "a")
    gain = 1 - light_loss(digest(key, "low_light"), severity, 64, 64)
    slow = slow_sample(views, gain, severity, np.random.default_rng(1)).ravel()
    other = slow_sample(views, gain, severity, np.random.default_rng(2)).ravel()
    fast = low_light_noise(views, severity, key).ravel()
    distance = stats.ks_2samp(fast, slow).statistic
    by_chance = stats.ks_2samp(other, slow).statistic
    # two slow samples also differ, because up to 10 % of the pixels have the same grey level
    assert distance < 0.02 + by_chance


@pytest.mark.parametrize("severity, decibel", [(0.5, 31.4), (0.6, 27.0), (1.0, 11.9)])
def test_noise_has_the_strength_of_the_suite(severity, decibel, scene):
    fast, slow = [], []
    for i in range(6):
        frame = np.rint(0.6 * scene.draw(120, 160, view=i)[0]).astype(np.uint8)  # mean 74
        key = Key(0, str(i))
        dark = corrupt(frame, "low_light", severity, key=key)
        noisy = corrupt(frame, "low_light_noise", severity, key=key)
        gain = 1 - light_loss(digest(key, "low_light"), severity, 120, 160)
        direct = slow_sample(frame[None], gain, severity, np.random.default_rng(i))[0]
        fast.append(scene.psnr(dark, noisy))
        slow.append(scene.psnr(dark, direct))
    assert np.mean(fast) == pytest.approx(np.mean(slow), abs=0.2)
    # the expected PSNR depends on the image
    assert np.mean(fast) == pytest.approx(decibel, abs=1.0)


def test_low_light_differs_from_low_light_noise_by_noise_only(scene):
    frame = np.stack([scene.draw(96, 96)[0]] * 12)
    dark = corrupt(frame, "low_light", 0.5, key=Key(0, "a")).astype(float)
    noisy = corrupt(frame, "low_light_noise", 0.5, key=Key(0, "a")).astype(float)
    mean = noisy.mean(0)
    bright = dark[0] > 40  # clipping at zero brightens dark areas
    assert abs((mean - dark[0])[bright].mean()) < 0.8
    assert np.corrcoef(mean.ravel(), dark[0].ravel())[0, 1] > 0.995


def test_noise_is_new_for_every_frame_view_and_channel():
    views = np.full((2, 64, 64, 3), 130, np.uint8)
    first = corrupt(views, "low_light_noise", 0.7, key=Key(0, "a", 0)).astype(float)
    second = corrupt(views, "low_light_noise", 0.7, key=Key(0, "a", 1)).astype(float)
    mask = first.mean((0, 3)) * 0 + corrupt(views[0], "low_light", 0.7, key=Key(0, "a"))[..., 0]
    pairs = [(first[0, ..., 0], first[1, ..., 0]), (first[0, ..., 0], second[0, ..., 0])]
    pairs += [(first[0, ..., 0], first[0, ..., 2])]
    for a, b in pairs:
        assert abs(np.corrcoef((a - mask).ravel(), (b - mask).ravel())[0, 1]) < 0.2


def test_tables_are_monotone_in_signal_and_quantile():
    for severity in (0.05, 0.6, 1.0):
        table = tables(severity)
        photons = table.photons.reshape(LEVELS, -1) / 256
        assert (np.diff(photons, axis=1) >= 0).all()
        assert (np.diff(photons.mean(1)) > -0.5 * noise_at(severity).gain).all()
        assert (np.diff(table.read) >= 0).all() and (np.diff(table.decode.astype(int)) >= 0).all()
        assert table.decode[0] == 0 and table.decode[-1] == 255
