# SPDX-License-Identifier: Apache-2.0
"""The output transforms of ACES 1.0 to 1.3: RRT with ODT for SDR, the single-stage ones for HDR, and the reference
gamut compression.

As the Academy's CTL computes them, or as OpenColorIO's built-in transforms do.

References
----------
Academy, aces-dev 1.3: ACESlib.RRT_Common, ACESlib.Tonescales, ACESlib.ODT_Common, ACESlib.SSTS,
ACESlib.OutputTransforms, RRT, ODT.Academy.*, RRTODT.Academy.*, LMT.Academy.ReferenceGamutCompress. OpenColorIO 2.1,
transforms/builtins/ACES.cpp, whose curves are quadratic splines through printed knots.
"""

from functools import lru_cache

import numpy as np

from .base import HALF_MAX
from .spaces import ACES_WHITE, BRADFORD, D65, rgb_to_rgb, rgb_to_xyz, xyz

AP0_TO_AP1 = rgb_to_rgb("ap0", "ap1")
AP1_WEIGHTS = rgb_to_xyz("ap1")[1]
PEAKS = {"hdr_1000": 1000.0, "hdr_2000": 2000.0, "hdr_4000": 4000.0, "hdr_cinema": 108.0}  # cd/m2
MIDDLE = {"hdr_cinema": 7.2}  # cd/m2 of scene-linear 0.18, elsewhere 15
HDR_BLACK = 1e-4  # cd/m2
SDR_BLACK, SDR_WHITE = 0.02, 48.0  # cd/m2

# --------------------------------------------------------------------------------------------------
# Before the curve


def compress_gamut(ap0):
    """The reference gamut compression: in AP1, distances from the largest channel beyond 0.8 or so come closer.

    >>> compress_gamut(np.array([[0.18, 0.18, 0.18], [0.5, -0.02, 0.1]])).round(12).tolist()
    [[0.18, 0.18, 0.18], [0.513402870414, 0.061903379035, 0.100383493546]]
    >>> compress_gamut(np.array([[10.0, -1, 3], [-0.01, -0.02, -0.03]])).round(12).tolist()
    [[10.353436450283, 1.159808955736, 3.0101128037], [-0.00440377777, -0.006759657631, -0.00677789546]]
    """
    power = 1.2
    limit = np.array([1.147, 1.264, 1.312])  # cyan, magenta, yellow
    threshold = np.array([0.815, 0.803, 0.880])
    scale = (limit - threshold) / (((1 - threshold) / (limit - threshold)) ** -power - 1) ** (1 / power)
    c = ap0 @ AP0_TO_AP1.T
    achromatic = c.max(-1, keepdims=True)
    size = np.abs(achromatic)
    distance = (achromatic - c) / np.where(size > 0, size, 1)
    n = np.maximum((distance - threshold) / scale, 0)
    small = np.minimum(n, 1e30)  # far beyond: n/(1 + n^p)^(1/p) is 1
    compressed = threshold + scale * small / (1 + small**power) ** (1 / power)
    out = np.where(distance < threshold, c, achromatic - compressed * size)
    return np.where(size > 0, out, 0) @ rgb_to_rgb("ap1", "ap0").T


def saturation_of(ap0):
    """rgb_2_saturation, as (...).

    >>> float(saturation_of(np.array([0.5, 0.25, -1.0])))
    0.9999999998
    """
    high, low = ap0.max(-1), ap0.min(-1)
    return (np.maximum(high, 1e-10) - np.maximum(low, 1e-10)) / np.maximum(high, 0.01)


def glow(ap0, saturation):
    """Saturated dark colors times up to 1.05.

    >>> glow(np.array([0.02, 0.0, 0.0]), 1.0).round(12).tolist()
    [0.021, 0.0, 0.0]
    """
    r, g, b = np.moveaxis(ap0, -1, 0)
    yc = (b + g + r + 1.75 * np.sqrt(np.maximum(b * (b - g) + g * (g - r) + r * (r - b), 0))) / 3
    x = (saturation - 0.4) / 0.2
    t = np.maximum(1 - np.abs(x / 2), 0)
    gain = 0.05 * (1 + np.where(x < 0, -1, 1) * (1 - t * t)) / 2
    mid = 0.08
    fades = gain * (mid / np.where(yc > mid / 2, yc, mid) - 0.5)
    gain = np.where(yc <= 2 / 3 * mid, gain, np.where(yc >= 2 * mid, 0, fades))
    return ap0 * (1 + gain[..., None])


def hue_weight(ap0):
    """cubic_basis_shaper of the hue, 135 degrees wide about red.

    >>> hue_weight(np.array([[1.0, 0, 0], [0.5, 0.5, 0.5], [1, 1, 0], [0, 1, 0]])).round(9).tolist()
    [1.0, 1.0, 0.002743484, 0.0]
    """
    r, g, b = np.moveaxis(ap0, -1, 0)
    degrees = np.degrees(np.arctan2(np.sqrt(3) * (g - b), 2 * r - g - b))
    knot = (degrees + 135 / 2) * 4 / 135
    j = np.floor(knot)
    t = knot - j
    pieces = (t**3 / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (1 - t) ** 3 / 6)
    return 1.5 * sum(np.where(j == k, piece, 0) for k, piece in enumerate(pieces))


def glow_and_red(ap0, spline):
    """Glow, then reds moved to 0.03. The CTL takes the saturation once, before the glow; OpenColorIO twice.

    >>> glow_and_red(np.array([0.8, 0.0, 0.0]), "ctl").round(9).tolist()
    [0.6614, 0.0, 0.0]
    """
    saturation = saturation_of(ap0)
    out = glow(ap0, saturation)
    if spline == "ocio":
        saturation = saturation_of(out)
    out[..., 0] += hue_weight(out) * saturation * (0.03 - out[..., 0]) * (1 - 0.82)
    return out


def saturate(ap1, factor):
    """AP1 towards its luminance.

    >>> saturate(np.array([1.0, 1.0, 1.0]), 0.5).round(12).tolist()
    [1.0, 1.0, 1.0]
    """
    gray = (ap1 * AP1_WEIGHTS).sum(-1, keepdims=True)
    return gray + factor * (ap1 - gray)


# --------------------------------------------------------------------------------------------------
# Curves of the CTL: quadratic B-splines of log10, two of them joined at mid gray

BASIS = np.array([[0.5, -1, 0.5], [-1, 1, 0], [0.5, 0.5, 0]])  # of t^2, t, 1


def bspline(x, low, high, points, last_slope=0.0):
    """segmented_spline_c5, _c9 and ssts, of log10 values: `points` are (log x, log y) of the two ends and the middle.

    Below the first end it is flat, above the last one straight.
    """
    (x_min, y_min), (x_mid, _), (x_max, y_max) = points
    y = np.empty_like(x)

    def segment(where, coefs, begin, end):
        knots = len(coefs) - 2
        k = knots * (x[where] - begin) / (end - begin)
        j = np.clip(np.floor(k), 0, knots - 1).astype(int)
        t = k - j
        a, b, c = np.moveaxis(np.array(coefs)[j[..., None] + np.arange(3)] @ BASIS.T, -1, 0)
        y[where] = (a * t + b) * t + c

    below, above = x <= x_min, x >= x_max
    segment(~below & (x < x_mid), low, x_min, x_mid)
    segment(~above & (x >= x_mid), high, x_mid, x_max)
    y[below] = y_min
    y[above] = y_max + last_slope * (x[above] - x_max)
    return y


# Without the last coefficient of the CTL's lists, which repeats the one before and has no interval.
RRT_LOW = [-4.0, -4.0, -3.1573765773, -0.4852499958, 1.8477324706]
RRT_HIGH = [-0.7185482425, 2.0810307172, 3.6681241237, 4.0, 4.0]
ODT_LOW = [-1.6989700043, -1.6989700043, -1.4779, -1.2291, -0.8648, -0.4480, 0.00518, 0.4511080334, 0.9113744414]
ODT_HIGH = [0.5154386965, 0.8470437783, 1.1358, 1.3802, 1.5197, 1.5985, 1.6467, 1.6746091357, 1.6878733390]
RRT_POINTS = np.log10([(0.18 * 2.0**-15, 1e-4), (0.18, 4.8), (0.18 * 2.0**18, 1e4)])


def rrt_ctl(x):
    """log10 of AP1 light to log10 of the rendered light.

    >>> (10 ** rrt_ctl(np.log10(np.array([1e-7, 0.18, 65504])))).round(7).tolist()
    [0.0001, 4.8, 10000.0]
    """
    return bspline(x, RRT_LOW, RRT_HIGH, RRT_POINTS)


def odt_ctl(x):
    """The cinema curve of 48 cd/m2, on log10.

    >>> (10 ** odt_ctl(np.array([-4, np.log10(4.8), 4]))).round(6).tolist()
    [0.02, 4.8, 52.618948]
    """
    ends = rrt_ctl(np.log10(0.18 * 2.0 ** np.array([-6.5, 0, 6.5])))
    return bspline(x, ODT_LOW, ODT_HIGH, list(zip(ends, np.log10([SDR_BLACK, 4.8, SDR_WHITE]))), 0.04)


@lru_cache(maxsize=None)
def ssts_parameters(peak, middle):
    """init_TsParams with the exposure at which scene-linear 0.18 comes out at `middle` cd/m2.

    >>> [round(float(x), 8) for x, _ in ssts_parameters(1000.0, 15.0)[2]]
    [-5.60050155, -1.08505161, 2.840515]
    """
    log_min, log_max = np.log10([HDR_BLACK, peak])
    stops_min = np.interp(log_min, np.log10([1e-4, 0.02]), [-15, -6.5])
    stops_max = np.interp(log_max, np.log10([48, 1e4]), [6.5, 18])
    x_min, x_mid, x_max = (np.log10(0.18) + s * np.log10(2) for s in (stops_min, 0, stops_max))
    y_mid, slope = np.log10(4.8), 1.55
    step = (x_mid - x_min) / 3
    low = [log_min, log_min, log_min + np.interp(stops_min, [-15, -6.5], [0.18, 0.35]) * (y_mid - log_min),
           y_mid - slope * step / 2, y_mid + slope * step / 2]
    step = (x_max - x_mid) / 3
    high = [y_mid - slope * step / 2, y_mid + slope * step / 2,
            y_mid + np.interp(stops_max, [6.5, 18], [0.89, 0.90]) * (log_max - y_mid), log_max, log_max]
    # inv_ssts(middle): the middle of either form lies in the first interval above mid gray.
    a, b, c = BASIS @ high[:3]
    c -= np.log10(middle)
    t = 2 * c / (-np.sqrt(b * b - 4 * a * c) - b)
    shift = t * step
    assert 0 <= t < 1
    points = [(x_min - shift, log_min), (x_mid - shift, y_mid), (x_max - shift, log_max)]
    return low, high, points


# --------------------------------------------------------------------------------------------------
# Curves of OpenColorIO: knots and slopes as printed there

LOW_Y, LOW_SLOPES = [-4, -3.57868829, -1.82131329, 0.68124124], [0, 0.55982688, 1.77532247, 1.55]
# x of the seven knots, y of the last three, their slopes. "refit": the last slopes get the correction below.
OCIO_KNOTS = {
    "rrt": ([-5.26017743, -3.75502745, -2.24987747, -0.74472749, 1.06145248, 2.86763245, 4.67381243],
            [2.87457742, 3.83406206, 4], [0.8787017, 0.18374463, 0], True),
    "hdr_1000": ([-5.60050155, -4.09535157, -2.59020159, -1.08505161, 0.22347059, 1.53199279, 2.84051500],
                 [2.22673503, 2.87906206, 3], [0.81219728, 0.1848466, 0], True),
    "hdr_2000": ([-5.59738488, -4.09223490, -2.58708492, -1.08193494, 0.37639718, 1.83472930, 3.29306142],
                 [2.42130131, 3.16609199, 3.30103], [0.83637009, 0.18505799, 0], False),
    "hdr_4000": ([-5.59503319, -4.08988322, -2.58473324, -1.07958326, 0.52855878, 2.13670081, 3.74484285],
                 [2.61625839, 3.45351273, 3.60205999], [0.85652519, 0.18474395, 0], False),
    "hdr_cinema": ([-5.37852506, -3.87337508, -2.36822510, -0.86307513, -0.03557710, 0.79192092, 1.61941895],
                   [1.60464482, 1.96008059, 2.03342376], [0.68179646, 0.17726487, 0], True),
}
OCIO_ODT = (
    [-2.54062362, -2.08035721, -1.62009080, -1.15982439, -0.69955799, -0.23929158, 0.22097483, 0.68124124, 1.01284632,
     1.34445140, 1.67605648, 2.00766156, 2.33926665, 2.67087173, 3.00247681],
    [-1.69897, -1.588435, -1.3535, -1.04695, -0.6564, -0.22141, 0.22814402, 0.68124124, 0.99142189, 1.258, 1.44995,
     1.5591, 1.6226, 1.66065457, 1.68124124],
    [0, 0.4803088, 0.5405565, 0.79149813, 0.9055625, 0.98460368, 0.96884766, 1, 0.87078346, 0.73702127, 0.42068113,
     0.23763206, 0.14535362, 0.08416378, 0.04])


def refit(x0, x1, y0, y1, s0, s1):
    """Two quadratics over one interval, with the slopes at its ends: [(x, y, slope), ...] of their begins.

    The quadratic of both slopes would miss y1. The last entry is the interval's end.
    """
    mean = (y1 - y0) / (x1 - x0)
    a, b = s0 - mean, s1 - mean
    split = x1 + a * (x1 - x0) / (s1 - s0) if abs(a) > abs(b) else x0 + b * (x1 - x0) / (s1 - s0)
    slope = 2 * mean - s1 + (s1 - s0) * (split - x0) / (x1 - x0)
    return [(x0, y0, s0), (split, y0 + (s0 + slope) / 2 * (split - x0), slope), (x1, y1, s1)]


def quadratics(x, knots):
    """One quadratic between neighboring knots (x, y, slope), straight lines with the end slopes outside.

    >>> quadratics(np.array([-1.0, 0.5, 1.0, 2.0]), [(0, 0, 0), (1, 1, 2)]).tolist()
    [0.0, 0.25, 1.0, 3.0]
    """
    at, y, slope = np.array(knots, float).T
    i = np.clip(np.searchsorted(at, x, "right") - 1, 0, len(at) - 2)
    t = x - at[i]
    inside = y[i] + t * (slope[i] + t * (slope[i + 1] - slope[i]) / (2 * (at[i + 1] - at[i])))
    above = y[-1] + slope[-1] * (x - at[-1])
    return np.where(x < at[0], y[0] + slope[0] * (x - at[0]), np.where(x >= at[-1], above, inside))


@lru_cache(maxsize=None)
def ocio_knots(name):
    """Knots as OpenColorIO evaluates them.

    In the flat last interval of three of the curves its limit of slopes finds the slope too steep by a rounding of
    float, takes 0.995 of it, and splits the two intervals that meet there.
    """
    x, y, slopes, is_limited = OCIO_KNOTS[name]
    y, slopes = LOW_Y + y, LOW_SLOPES + slopes
    if not is_limited:
        return list(zip(x, y, slopes))
    slopes[5] *= 0.995
    knots = list(zip(x, y, slopes))[:4]
    for i in (4, 5):
        knots += refit(x[i], x[i + 1], y[i], y[i + 1], slopes[i], slopes[i + 1])[:2]
    return knots + [(x[6], y[6], slopes[6])]


# --------------------------------------------------------------------------------------------------
# The whole


def tone(ap1, output, spline):
    """AP1 light to light between black, 0, and the peak of the output, 1.

    >>> abs(tone(np.array([0.0, 0.18]), "sdr_cinema", "ctl")).round(9).tolist()
    [0.0, 0.099624844]
    >>> (1000 * tone(np.array([0.18]), "hdr_1000", "ctl")).round(3).tolist()
    [15.0]
    """
    x = np.log10(np.maximum(ap1, 2.0**-24))
    if output in PEAKS:
        black, white = HDR_BLACK, PEAKS[output]
        if spline == "ctl":
            y = bspline(x, *ssts_parameters(PEAKS[output], MIDDLE.get(output, 15.0)))
        else:
            y = quadratics(x, ocio_knots(output))
    else:
        black, white = SDR_BLACK, SDR_WHITE
        y = odt_ctl(rrt_ctl(x)) if spline == "ctl" else quadratics(quadratics(x, ocio_knots("rrt")),
                                                                   list(zip(*OCIO_ODT)))
    black = 10 ** np.log10(black) if spline == "ctl" else black
    return (10**y - black) / (white - black)


def dim(ap1, spline):
    """From a dark to a dim surround: luminance^0.9811, with the chromaticity kept.

    >>> dim(np.array([0.5, 0.5, 0.5]), "ctl").round(9).tolist()
    [0.506593334, 0.506593334, 0.506593334]
    """
    light = (ap1 * AP1_WEIGHTS).sum(-1, keepdims=True)
    floor = 1e-10 if spline == "ocio" else 1e-300
    return np.where(light > 0, ap1, 0) * np.maximum(light, floor) ** (0.9811 - 1)


def adaptation():
    """Bradford, XYZ of the ACES white to D65.

    >>> (adaptation() @ xyz(ACES_WHITE) - xyz(D65)).round(12).tolist()
    [0.0, 0.0, 0.0]
    """
    white, d65 = BRADFORD @ xyz(ACES_WHITE), BRADFORD @ xyz(D65)
    return np.linalg.solve(BRADFORD, np.diag(d65 / white) @ BRADFORD)


def aces_13(rgb, output="sdr_video", limit="rec709", gamut_compression="no", spline="ocio"):
    """AP0 to display light. SDR: in the limiting primaries (limit=none: AP1, not limited), 1 = white. HDR: in Rec.2020,
    1 = 100 cd/m2.

    HDR forms are limited before they are adapted from the ACES white to D65, which moves colors at the limit a little
    beyond the limiting primaries and blue up to 1.09 of the peak.

    >>> aces_13([0.18, 0.18, 0.18]).round(9).tolist()
    [0.104063516, 0.104063516, 0.104063516]
    >>> aces_13([1000.0, 1000.0, 1000.0], output="hdr_1000", limit="rec2020").round(6).tolist()
    [9.762815, 10.000127, 9.999856]
    """
    if output in PEAKS and limit == "none":
        raise ValueError(f"limit is none; expected rec709, p3d65 or rec2020 with output={output}")
    ap0 = np.clip(np.asarray(rgb, float), -HALF_MAX, HALF_MAX)
    if gamut_compression == "yes":
        ap0 = compress_gamut(ap0)
    ap1 = np.maximum(glow_and_red(ap0, spline), 0) @ AP0_TO_AP1.T
    ap1 = np.clip(ap1, 0, HALF_MAX if spline == "ctl" else None)
    light = tone(saturate(ap1, 0.96), output, spline)
    if output in PEAKS:
        to_limit = np.linalg.solve(rgb_to_xyz(limit), rgb_to_xyz("ap1"))  # unadapted
        limited = np.clip(light @ to_limit.T, 0, 1)
        adapted = np.linalg.solve(rgb_to_xyz("rec2020"), adaptation() @ rgb_to_xyz(limit))
        return limited @ adapted.T * (PEAKS[output] / 100)
    if output == "sdr_video":
        light = saturate(dim(light, spline), 0.93)
    if limit == "none":
        return light
    return np.clip(light @ rgb_to_rgb("ap1", limit).T, 0, 1)


def output_primaries(output="sdr_video", limit="rec709", **_):
    """Primaries of what aces_13 puts out.

    >>> output_primaries(), output_primaries(limit="none"), output_primaries(output="hdr_1000", limit="p3d65")
    ('rec709', 'ap1', 'rec2020')
    """
    return "rec2020" if output in PEAKS else "ap1" if limit == "none" else limit


def output_for(display):
    """The SDR form for televisions, or the HDR form of the largest peak that the display reaches.

    >>> from .spaces import DISPLAYS
    >>> output_for(DISPLAYS["srgb"]), output_for(DISPLAYS["rec2100_pq"]._replace(peak=2000.0))
    ('sdr_video', 'hdr_2000')
    """
    if not display.is_hdr:
        return "sdr_video"
    return next((f"hdr_{peak}" for peak in (4000, 2000) if display.peak >= peak), "hdr_1000")


OPERATORS = {"aces_13": aces_13}
WORKING = {"aces_13": "ap0"}
OUTPUT_PRIMARIES = {"aces_13": output_primaries}
PEAK = {"aces_13": lambda output="sdr_video", **_: 1.09 * PEAKS[output] / 100 if output in PEAKS else 1.0}
FROM_DISPLAY = {"aces_13": {"output": output_for, "limit": lambda display: display.primaries}}
