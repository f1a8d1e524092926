"""Call corruptions of other libraries that model the same failures with similar strengths.

Each library is called as shown in its documentation. Frames are converted to the library's format
(float tensors for kornia) before the clock starts. No other library corrupts metric depth, so depth
is compared with plain numpy, OpenCV or torch code.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import partial

import cv2
import numpy as np
import torch

from mitigate.corruptions import depth as ours
from mitigate.corruptions import rgb
from mitigate.corruptions.depth import echo_shift
from tools.bench.timing import version

Calls = dict[str, Callable[[], object]]  # the keys are names of this project's corruptions
GRADE = 3  # severity for the library imagecorruptions, from 1 to 5


def peers(rgb_views: np.ndarray, depth_views: np.ndarray, severity: float) -> dict[str, Calls]:
    """Return the functions of every library that can be imported.

    Print a line for each library that cannot be imported.

    Args:
        rgb_views: uint8 [V, H, W, 3].
        depth_views: float32 metres [V, H, W].
        severity: Severity of this project's corruptions.
    """
    by_library: dict[str, Calls] = {}
    for library, make in LIBRARIES.items():
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                calls = make(rgb_views if make is not plain else depth_views, severity)
        except ImportError as error:
            print(f"{library} is not measured: {error}. {INSTALL.get(library, '')}")
            continue
        number = version(library)
        by_library[f"{library} {number}" if number else library] = calls
    return by_library


def sizes(views: np.ndarray, severity: float) -> tuple[int, float]:
    """Return this project's kernel width of motion blur (an odd number of pixels) and its sigma of
    defocus.
    """
    height, width = views.shape[1:3]
    kernel = max(3, int(rgb.BLUR_LENGTH * severity * width) | 1)
    return kernel, rgb.DEFOCUS_SIGMA * severity * min(height, width)


def albumentations(views: np.ndarray, severity: float) -> Calls:
    """Return functions that corrupt one uint8 view each."""
    import albumentations as a

    kernel, sigma = sizes(views, severity)
    hole, one = (severity, severity), (1, 1)
    transforms = {
        "motion_blur": a.MotionBlur((kernel, kernel), p=1),
        "low_light": a.Illumination("linear", (0.2, 0.2), "darken", p=1),
        "low_light_noise": a.ShotNoise((0.2, 0.2), p=1),
        "spatter": a.Spatter(mode="mud", p=1),
        "flare": a.RandomSunFlare(src_radius=max(2, views.shape[1] // 4), p=1),
        "defocus": a.GaussianBlur((0, 0), (sigma, sigma), p=1),
        "foreign_object": a.CoarseDropout(one, hole, hole, p=1),
        "black_out": a.CoarseDropout(one, (1.0, 1.0), (1.0, 1.0), p=1),
    }

    def call(transform):
        return [transform(image=view)["image"] for view in views]

    return {name: partial(call, transform) for name, transform in transforms.items()}


def kornia(views: np.ndarray, severity: float, device: str = "cpu") -> Calls:
    """Return functions that corrupt all views as one float tensor [V, 3, H, W] in [0, 1] on
    ``device``.
    """
    import kornia.augmentation as k

    kernel, sigma = sizes(views, severity)
    side = max(3, 2 * int(np.ceil(3 * sigma)) + 1)
    batch = torch.from_numpy(views).to(device).permute(0, 3, 1, 2).contiguous().float() / 255
    area = (0.25 * np.pi * severity**2,) * 2
    transforms = {
        "motion_blur": k.RandomMotionBlur(kernel, 10.0, 0.0, p=1.0),
        "low_light": k.RandomLinearIllumination((0.6, 0.6), (-1.0, -1.0), p=1.0),
        "low_light_noise": k.RandomGaussianNoise(std=0.1, p=1.0),
        "flare": k.RandomGaussianIllumination((0.6, 0.6), p=1.0),
        "defocus": k.RandomGaussianBlur((side, side), (sigma, sigma), p=1.0),
        "foreign_object": k.RandomErasing(area, (1.0, 1.0), p=1.0),
        "black_out": k.RandomErasing((1.0, 1.0), (1.0, 1.0), p=1.0),
    }
    return {name: partial(transform, batch) for name, transform in transforms.items()}


def imagecorruptions(views: np.ndarray, severity: float) -> Calls:
    """Return functions that corrupt one uint8 view each, at severity 3 of 5."""
    from imagecorruptions import corrupt

    def call(name):
        return [corrupt(view, corruption_name=name, severity=GRADE) for view in views]

    names = {
        "motion_blur": "motion_blur",
        "low_light_noise": "shot_noise",
        "spatter": "spatter",
        "defocus": "defocus_blur",
    }
    return {ours: partial(call, theirs) for ours, theirs in names.items()}


def plain(views: np.ndarray, severity: float) -> Calls:
    """Return depth corruptions of a few lines each, which have no keys and do not check for invalid
    pixels.
    """
    height, width = views.shape[1:]
    tensor = torch.from_numpy(views)
    rng = np.random.default_rng(0)
    step = np.float32(ours.STEP * severity)
    share = ours.HOLE_SHARE * severity
    reach = 2 * max(1, round(ours.ECHO_REACH * min(height, width))) + 1
    square = np.ones((reach, reach), np.uint8)

    def noise():
        sigma = severity * (ours.NOISE_BASE + ours.NOISE_SQUARE * tensor**2)
        return tensor + sigma * torch.randn_like(tensor)

    def holes():
        field = rng.standard_normal((height, width), np.float32)
        smooth = cv2.GaussianBlur(field, (0, 0), ours.HOLE_CORRELATION * min(height, width))
        return np.where(smooth > np.quantile(smooth, 1 - share), np.float32(0), views)

    def echo():
        far = np.stack([cv2.dilate(view, square) for view in views])
        gap = np.clip(far - views, 0, ours.ECHO_GAP)
        return views + echo_shift(gap, severity)

    def steps():
        return np.rint(views / step) * step

    return {
        "gaussian_noise": noise,
        "missing_data": holes,
        "multipath": echo,
        "quantization": steps,
    }


LIBRARIES = {
    "albumentations": albumentations,
    "kornia": kornia,
    "imagecorruptions": imagecorruptions,
    "plain code": plain,
}
INSTALL = {
    "albumentations": "Install it with `pip install -e '.[bench]'`.",
    "kornia": "Install it with `pip install -e '.[bench]'`.",
    "imagecorruptions": (
        "It requires opencv-python, which would replace opencv-python-headless, and pkg_resources. "
        "Install it with `pip install --no-deps imagecorruptions` and `pip install scikit-image "
        "'setuptools<81'`."
    ),
}
