"""Define the tables of the documentation: failure, formula and sources of each corruption."""

from __future__ import annotations

from typing import NamedTuple

from mitigate.core.observation import HFOV_DEGREES
from mitigate.corruptions import depth, eld, masks, rgb
from mitigate.corruptions.unseen import calibration, codec, edges, light, optics, returns, signal


class Description(NamedTuple):
    """The cells of a corruption in the tables of the documentation.

    Attributes:
        fails: the real failure that the corruption models.
        formula: Markdown formula with the constants of the code.
        sources: sources of the constants.
    """

    fails: str
    formula: str
    sources: str


DESCRIPTIONS = {
    "motion_blur": Description(
        "the camera turned during the exposure",
        (
            f"(1 - a) x + a blur(x), a = 0.5 + 0.5 s; line of length L = {rgb.BLUR_LENGTH:g} s W "
            "at "
            f"U(-{rgb.BLUR_ANGLE:g}, {rgb.BLUR_ANGLE:g}) degrees; L < 1 px changes nothing; from "
            f"{rgb.LONG_BLUR:g} px every second column, after smoothing by (1 2 1)/4"
        ),
        (
            "kernels of ImageNet-C are 3-14 % of W; yaw turns dominate; a is the paper's blend "
            "with "
            "the original"
        ),
    ),
    "low_light": Description(
        "little light, falling off",
        (
            f"x (1 - s ({masks.DARK_BASE:g} + {masks.DARK_RAMP:g} t)); t in [0, 1] a linear ramp, "
            "or "
            "the distance to one light"
        ),
        "between RobustNav, which leaves 0.57-0.31 of the mean, and 3DCC (0.24-0.12)",
    ),
    "spatter": Description(
        "mud or water on the lens",
        (
            f"the top {masks.SPATTER_COVER:g} s of a random field, correlation "
            f"{masks.SPATTER_CORRELATION:g} side; soft edge of {masks.SPATTER_EDGE:g} sd; opacity "
            "0.5 "
            f"+ 0.5 s; mud {masks.SPATTER_COLOURS[0]} or water {masks.SPATTER_COLOURS[1]}"
        ),
        "colours and cover of ImageNet-C (0.04-0.57); correlation and edge are heuristic",
    ),
    "flare": Description(
        "a light shines into the lens",
        (
            f"x + (255 - x) g; g = s ({masks.FLARE_CORE:g} "
            f"exp(-(r/{masks.FLARE_CORE_WIDTH:g})^2/2) + "
            f"{masks.FLARE_HALO:g} exp(-r/{masks.FLARE_HALO_WIDTH:g})) times {masks.FLARE_TINT}, "
            "at "
            "most 1; r over the diagonal; centre U(0.1, 0.9) W, U(0, 0.5) H"
        ),
        "radial gradient of the paper; constants are heuristic",
    ),
    "defocus": Description(
        "out of focus",
        (
            f"Gaussian, sigma = 5 s u side/224, u ~ U({1 - rgb.DEFOCUS_SPREAD:g}, "
            f"{1 + rgb.DEFOCUS_SPREAD:g}); sigma < {rgb.DEFOCUS_LEAST:g} px changes nothing"
        ),
        "disks of ImageNet-C have radii of 3-10 px at 224; randomised as in the paper",
    ),
    "foreign_object": Description(
        "an object covers the middle of the lens",
        f"black disk at the centre, radius {masks.DISK_RADIUS:g} s side",
        "the paper; the radius is heuristic",
    ),
    "black_out": Description(
        "a view is lost",
        "black where U(0, 1) < s",
        'the paper\'s "fixed probability"; p = s is ours',
    ),
    "low_light_noise": Description(
        "little light, with sensor noise",
        "`low_light`, then the ELD model below",
        "Wei et al., TPAMI 2021 (ELD), Sony A7S2",
    ),
    "gaussian_noise": Description(
        "noise that grows with distance",
        f"z + s ({depth.NOISE_BASE:g} + {depth.NOISE_SQUARE:g} z^2) N(0, 1)",
        "D435: RMS grows with z^2; s = 0.1 is about a Kinect, 0.5 the D435's limit",
    ),
    "missing_data": Description(
        "holes",
        (
            f"the top {depth.HOLE_SHARE:g} s of a random field, correlation "
            f"{depth.HOLE_CORRELATION:g} "
            f"side; its top {100 * depth.FAR_SHARE:g} % reads z_max, the rest 0"
        ),
        "Zhang & Funkhouser 2018: often over half is missing indoors",
    ),
    "multipath": Description(
        "over-estimation beside edges",
        (
            f"far = largest depth within {depth.ECHO_REACH:g} side (a square); gap = far - z, at "
            "most "
            f"{depth.ECHO_GAP:g} metres; z + c/(4 pi f) atan2(b sin p, 1 + b cos p), p = 4 pi f "
            "gap/c, "
            f"b = {depth.ECHO_STRENGTH:g} s, f = {depth.ECHO_HERTZ / 1000000.0:g} MHz"
        ),
        "phasor sum of two paths (Fuchs 2010, Jimenez 2014); f, b, reach and gap are heuristic",
    ),
    "quantization": Description(
        "depth in coarse steps",
        f"rint(z/step) step, step = {depth.STEP:g} s metres",
        "Ideses 2007, Wei 2013; the step is heuristic",
    ),
    "white_balance": Description(
        "the camera corrects for the wrong light",
        (
            f"255 min(1, (x/255) 2^(s g/{eld.GAMMA:g})); stops g of red, green, blue = "
            f"{0.5 * light.CAST:g} (cos a, 0, -cos a) + {0.5 * light.CAST * light.TINT:g} (-sin a, "
            "sin "
            "a, -sin a), a ~ U(0, 360) degrees"
        ),
        (
            "Afifi & Brown, ICCV 2019: errors of white balance from 2850 to 7500 K; the range is "
            "heuristic"
        ),
    ),
    "haze": Description(
        "smoke, steam or dust in the room",
        (
            f"x t + A (1 - t), t = exp(-{light.HAZE_DEPTH:g} s d), A = {light.HAZE_COLOUR}; d = 1 "
            "+ "
            f"{light.HAZE_UNEVEN:g} F in [{light.HAZE_THIN:g}, {light.HAZE_THICK:g}], F the sum of "
            f"random fields of correlation {', '.join((f'{c:g}' for c, _ in light.HAZE_OCTAVES))} "
            "side "
            f"and weight {', '.join((f'{w:g}' for _, w in light.HAZE_OCTAVES))}, sd 1"
        ),
        (
            "Koschmieder's law, as 3DCC; fractal as ImageNet-C's fog; without depth, since RGB is "
            "corrupted alone; constants are heuristic"
        ),
    ),
    "overexposure": Description(
        "the exposure is set for a dark place",
        (
            f"min(255, x 2^({light.STOPS:g} s u/{eld.GAMMA:g})), u ~ U({1 - light.STOPS_SPREAD:g}, "
            f"{1 + light.STOPS_SPREAD:g})"
        ),
        "brightness of ImageNet-C; stops of light instead of grey levels are heuristic",
    ),
    "hue_shift": Description(
        "wrong Bayer order or colour matrix",
        (
            f"colours turned about the grey axis by +-{light.HUE_DEGREES:g} s degrees, clipped to "
            "0-255"
        ),
        "a wrong order of channels moves hues by 120 degrees; the range is heuristic",
    ),
    "ghosting": Description(
        "a pane or dome in front of the lens reflects",
        (
            f"(1 - a) x + a x', a = {optics.GHOST:g} s; x' moved by +-U({optics.GHOST_NEAR:g}, "
            f"{optics.GHOST_FAR:g}) W and U(-{optics.GHOST_DOWN:g}, {optics.GHOST_DOWN:g}) H"
        ),
        "double reflection of glass (Shih et al., CVPR 2015); constants are heuristic",
    ),
    "refraction": Description(
        "water or grease on the lens bends the light",
        (
            f"x at p + {optics.BEND:g} s side grad h(p); h a random field of correlation "
            f"{optics.DROPS:g} side, its slope of rms 1; bilinear"
        ),
        "caustic refraction of ImageNet-C-bar, elastic transform of ImageNet-C",
    ),
    "scratches": Description(
        "the lens is scratched or cracked",
        (
            f"{optics.SCRATCHES} s lines of length U({optics.SCRATCH_LONG[0]:g}, "
            f"{optics.SCRATCH_LONG[1]:g}) side and colour {optics.SCRATCH_COLOUR}; opacity "
            f"{optics.SCRATCH_OPACITY:g} exp(-(d/{optics.SCRATCH_CORE:g})^2/2) and "
            f"{optics.GLOW_OPACITY:g} exp(-(d/{optics.SCRATCH_GLOW:g})^2/2), d over the side"
        ),
        "camera crack of RobustNav, frost of ImageNet-C; constants are heuristic",
    ),
    "rolling_shutter": Description(
        "the camera shakes while its rows are read",
        (
            f"row y moved by {signal.WOBBLE:g} s W sin(2 pi (f y/H + p)), f ~ "
            f"U({signal.WOBBLE_WAVES[0]:g}, {signal.WOBBLE_WAVES[1]:g}), p ~ U(0, 1); bilinear, "
            "edges "
            "replicated"
        ),
        "rolling-shutter geometry (Liang et al., TIP 2008); amplitude and f are heuristic",
    ),
    "flicker_bands": Description(
        "lamps flicker faster than the rows are read",
        (
            f"min(255, x (1 + {signal.FLICKER:g} s cos(2 pi (f y/H + p)))), f ~ "
            f"U({signal.BANDS[0]:g}, "
            f"{signal.BANDS[1]:g}), p ~ U(0, 1) for each view"
        ),
        "lamps on mains under a rolling shutter (Sheinin et al., CVPR 2017); f is heuristic",
    ),
    "impulse_noise": Description(
        "bit errors between sensor and computer",
        f"each colour 0 or 255 in {signal.IMPULSES:g} s of the pixels",
        "impulse noise of ImageNet-C (0.03-0.27)",
    ),
    "compression": Description(
        "too little bandwidth for the camera's stream",
        (
            "DCT of square blocks in grey, red - blue and green against both; coefficients under "
            f"{codec.DEAD_ZONE:g} s 255 b/2 (colours: {codec.CHROMA:g} times that) become 0, "
            "except "
            f"the mean; b of {', '.join(map(str, codec.BLOCKS))} px, the nearest to "
            f"side/{codec.BLOCKS_ACROSS}"
        ),
        (
            "JPEG of ImageNet-C, H.265 of 3DCC; dead zone and block sides of H.264 and H.265; the "
            "width of the zone is heuristic"
        ),
    ),
    "lost_slices": Description(
        "packets of the camera's stream are lost",
        (
            f"of {codec.SLICES} slices each view loses each with probability {codec.LOST:g} s, "
            "from "
            f"column U(0, 1) W to the end: grey {codec.NOTHING}"
        ),
        "H.264 over IP (Wenger 2003), bit error of 3DCC; shares are heuristic",
    ),
    "scale_error": Description(
        "the baseline or focal length is miscalibrated",
        f"z (1 +- s k), k ~ U({calibration.SCALE_LEAST:g}, {calibration.SCALE_MOST:g})",
        (
            "scale errors of depth cameras (Khoshelham & Elberink 2012) and, larger, of monocular "
            "depth; the range is heuristic"
        ),
    ),
    "wiggling": Description(
        "the harmonics of a time-of-flight camera's light",
        (
            f"z + {calibration.WIGGLE:g} s sin(2 pi (z/P + p)), P = c/(8 f) = "
            f"{calibration.WIGGLE_PERIOD:.2f} metres, f = {calibration.WIGGLE_HERTZ / 1000000.0:g} "
            "MHz"
        ),
        "wiggling error (Lindner & Kolb 2006; Foix 2011); the amplitude is heuristic",
    ),
    "misalignment": Description(
        "the mount of the depth camera has moved",
        (
            f"z at p + d, d = +-{calibration.ASIDE:g} s W (1, U(-{calibration.ASIDE_DOWN:g}, "
            f"{calibration.ASIDE_DOWN:g})); an invalid one there changes nothing"
        ),
        "registration errors of RGB-D cameras (Khoshelham & Elberink 2012); d is heuristic",
    ),
    "fattening": Description(
        "the window of a stereo matcher crosses edges",
        (
            f"the least depth within r = {edges.FATTENING:g} s side (a square), linear between "
            "whole "
            "pixels"
        ),
        "edge fattening of stereo (Kanade & Okutomi 1994; Scharstein 2002); r is heuristic",
    ),
    "edge_shadow": Description(
        "objects block the projector's light",
        (
            "no reading where x + f b/z does not exceed that of all before it in the row; b = "
            f"{edges.BASELINE:g} s metres, f = W/(2 tan({HFOV_DEGREES:g}/2 degrees))"
        ),
        "shadows of structured light (Khoshelham & Elberink 2012: b = 0.075); b is heuristic",
    ),
    "flying_pixels": Description(
        "a pixel sees two surfaces at once",
        (
            "the share s of the pixels reads near + U(0, 1) (far - near), of the nearest and the "
            f"farthest within {edges.FOOTPRINT:g} side (a square)"
        ),
        "flying pixels of time of flight (Foix 2011; Reynolds et al., CVPR 2011)",
    ),
    "ripple": Description(
        "neighbouring errors of a stereo camera are correlated",
        (
            f"z + {returns.RIPPLE:g} s z^2 F; F a random field of correlation "
            f"{returns.RIPPLE_CORRELATION:g} side, sd 1"
        ),
        (
            "stereo errors grow with z^2 and are correlated over the matching window (Keselman et "
            "al. "
            "2017); constants are heuristic"
        ),
    ),
    "range_limit": Description(
        "too little signal from dark surfaces or in sunlight",
        f"no reading where z > z_max {returns.RANGE_LEFT:g}^s",
        "range of active cameras in sunlight (Fankhauser et al. 2015); 0.1 is heuristic",
    ),
    "mismatches": Description(
        "a stereo matcher confuses two places",
        (
            f"U(0, 1) z_max in the share {returns.WRONG:g} s of square cells of "
            f"{returns.SPECKLE:g} "
            "side, at least 1 px"
        ),
        "bad pixels and speckles of stereo (Scharstein 2002, Hirschmueller 2008)",
    ),
    "glossy_floor": Description(
        "a polished floor reflects the room",
        (
            f"min({returns.UPSIDE_DOWN:g} z, the largest z of the column) in the top s of a random "
            f"field, correlation {returns.GLOSS_CORRELATION:g} side, where z (y - H/2) is at least "
            f"{returns.FLOOR:g} of its largest in the view: on the floor before a level camera"
        ),
        (
            "mirror errors of RGB-D cameras (Mirror3D, CVPR 2021); the geometry of a ceiling twice "
            "as "
            "high as the camera is heuristic"
        ),
    ),
}
