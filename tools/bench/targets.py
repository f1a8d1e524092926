"""Define time targets in milliseconds for the standard suite, with reasons for most targets."""

from __future__ import annotations

BARS = {  # targets in milliseconds at 480x640 and at 224x224
    "motion_blur": (1.1, 0.1),
    "low_light": (0.1, 0.01),
    "spatter": (0.15, 0.01),
    "flare": (0.1, 0.01),
    "defocus": (1.2, 0.1),
    "foreign_object": (0.042, 0.01),
    "black_out": (0.017, 0.004),
    "low_light_noise": (1.6, 0.26),
    "gaussian_noise": (0.39, 0.065),
    "missing_data": (0.09, 0.008),
    "multipath": (0.65, 0.09),
    "quantization": (0.056, 0.006),
}
REASONS = {
    "motion_blur": "16 taps of 16-bit integers per colour value, and a padded copy of the frame.",
    "low_light": "The kernel takes under three cycles for 16 colour values; the rest is the call.",
    "spatter": "As low_light: the same kernel with another mask.",
    "flare": "As low_light, and one kernel call per view, because each view has its own mask.",
    "defocus": (
        "The target assumes a sigma of 2.5 px (s = 0.5). At s = 0.6 sigma is 3.0 px, up to 20 % "
        "more or less per episode, and needs more taps; padding adds a sixth of the pixels at 224 "
        "x 224."
    ),
    "foreign_object": "A copy of the frame, then the black disk.",
    "black_out": "A copy of the frame unless the view is dropped, and a new hash per frame.",
    "missing_data": (
        "A dozen instructions per pixel for validity, range and kind of hole; the target is about "
        "two plain copies."
    ),
    "multipath": "Four maxima per value along rows, four along columns, then a polynomial.",
    "quantization": (
        "One division per pixel. Multiplying by 1 / step would be faster, but would round some "
        "pixels differently."
    ),
}
