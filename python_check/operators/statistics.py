# SPDX-License-Identifier: Apache-2.0
"""Operators of the 1990s and 2003 that read a display and statistics of the picture: log mean, maximum, adaptation.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import HALF_MAX, apply_curve, limit_scene, log1p
from .reinhard import OPENCV_WEIGHTS

# The XYZ rows that stand with the rod formula.
ROD_XYZ = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])


def drago(rgb, bias=0.85, bias_scales_average="yes", display_max=100.0, log_average=1.0, maximum=100.0,
          apply="luminance", **color):
    """Logarithm whose base grows from 2 to 10 with x: maximum becomes display_max / 100.

    With the world adaptation a = log_average / (1 + bias - 0.85)^5 (pfstmo: log_average), l = x/a, m = maximum/a:
    (display_max / 100) / log10(1 + m) ln(1 + l) / ln(2 + 8 (l/m)^(ln bias / ln 0.5)). Without the paper's gamma.

    References
    ----------
    Drago, Myszkowski, Annen, Chiba, "Adaptive Logarithmic Mapping For Displaying High Contrast Scenes", Eurographics
    2003, equation 4.

    >>> drago([0.8, 0.1, 0.05]).round(9).tolist()
    [0.259643661, 0.032455458, 0.016227729]
    """
    adaptation = log_average / (1 + bias - 0.85) ** 5 if bias_scales_average == "yes" else log_average
    scale = display_max / 100 / np.log10(1 + maximum / adaptation)
    exponent = np.log(bias) / np.log(0.5)
    return apply_curve(lambda x: scale * log1p(x / adaptation) / np.log(2 + 8 * (x / maximum) ** exponent),
                       limit_scene(rgb), apply, **color)


def opencv_drago(rgb, bias=0.85, minimum=0.0, maximum=1.0, log_average=0.5, maximum_gray=1.0, output_minimum=0.0,
                 output_maximum=0.0, apply="luminance", **color):
    """Drago's logarithm of the gray g/a of x = (v - minimum) / (maximum - minimum), stretched to its own range.

    ln(1 + g/a) / ln(2 + 8 (g/m)^(ln bias / ln 0.5)), m the largest gray. Averages and grays are scene values;
    gray is 0.114 r + 0.587 g + 0.299 b. `output_maximum` 0 stands for the result at g = m.

    References
    ----------
    OpenCV 4.6.0 (Apache-2.0), photo/src/tonemap.cpp, TonemapDrago.

    >>> opencv_drago([1.0, 1.0, 1.0]).round(9).tolist()
    [1.0, 1.0, 1.0]
    """
    span = maximum - minimum
    average, largest = (log_average - minimum) / span, (maximum_gray - minimum) / span
    if span <= 0 or average <= 0 or largest <= 0:
        raise ValueError("minimum at or above the average, the largest gray or the maximum; expected below them")
    exponent = np.log(bias) / np.log(0.5)
    high = output_maximum if output_maximum > 0 else np.log1p(largest / average) / np.log(10)
    if high <= output_minimum:
        raise ValueError(f"output_minimum={output_minimum}; expected below {high}")
    x = np.clip((limit_scene(rgb) - minimum) / span, 0, HALF_MAX)
    out = apply_curve(lambda g: log1p(g / average) / np.log(2 + 8 * (g / largest) ** exponent), x, apply,
                      weights=OPENCV_WEIGHTS, **color)
    return (out - output_minimum) / (high - output_minimum)


def ward(rgb, display_max=80.0, log_average=0.5, apply="luminance", **color):
    """m x / display_max, m = ((1.219 + (display_max/2)^0.4) / (1.219 + log_average^0.4))^2.5: one factor.

    References
    ----------
    G. Ward, "A Contrast-Based Scalefactor for Luminance Display", Graphics Gems IV, 1994.

    >>> ward([0.8, 0.1, 0.05]).round(9).tolist()
    [0.134606522, 0.016825815, 0.008412908]
    """
    m = ((1.219 + (display_max / 2) ** 0.4) / (1.219 + log_average**0.4)) ** 2.5
    return apply_curve(lambda x: m * x / display_max, limit_scene(rgb), apply, **color)


def stevens(adaptation):
    """alpha and beta of Stevens's brightness at an adaptation in cd/m2.

    >>> [round(v, 9) for v in stevens(10**-0.84)]
    [2.92, 2.0208]
    """
    s = np.log10(adaptation) + 0.84
    return 0.4 * s + 2.92, -0.4 * s * s - 2.584 * s + 2.0208


def tumblin_rushmeier(rgb, display_max=80.0, contrast_max=36.0, log_average=0.5, apply="luminance", **color):
    """x^(aR/aD) 10^((bR-bD)/aD) / display_max - 1 / contrast_max, a and b of scene (R) and display (D).

    The display adapts to display_max / sqrt(contrast_max). Negative for dark x; 0 there where luminance is scaled.

    References
    ----------
    Tumblin, Rushmeier, "Tone Reproduction for Realistic Images", IEEE CG&A 13(6), 1993.

    >>> tumblin_rushmeier([0.8, 0.1, 0.05]).round(9).tolist()
    [0.206947682, 0.02586846, 0.01293423]
    """
    alpha, beta = stevens(log_average)
    display_alpha, display_beta = stevens(display_max / np.sqrt(contrast_max))
    scale = 10 ** ((beta - display_beta) / display_alpha) / display_max
    return apply_curve(lambda x: scale * x ** (alpha / display_alpha) - 1 / contrast_max, limit_scene(rgb), apply,
                       **color)


def cone_threshold(adaptation):
    """tp: smallest difference that cones see, adapted to cd/m2.

    >>> [round(float(cone_threshold(a)), 9) for a in (1e-4, 1.0, 100.0)]  # ends: 10^-0.72, 10^0.745
    [0.190546072, 0.391301527, 5.559042573]
    """
    l = np.log10(adaptation)
    middle = np.maximum(0.249 * l + 0.65, 0) ** 2.7 - 0.72
    return 10 ** np.where(l <= -2.6, -0.72, np.where(l >= 1.9, l - 1.255, middle))


def rod_threshold(adaptation):
    """ts: smallest difference that rods see, adapted to cd/m2.

    >>> [round(float(rod_threshold(a)), 9) for a in (1e-5, 1.0)]  # 10^-2.86, 10^-0.395
    [0.001380384, 0.402717034]
    """
    l = np.log10(adaptation)
    middle = np.maximum(0.405 * l + 1.6, 0) ** 2.18 - 2.86
    return 10 ** np.where(l <= -3.94, -2.86, np.where(l >= -1.44, l - 0.395, middle))


def rod_signal(rgb):
    """Scotopic luminance -0.702 X + 1.039 Y + 0.433 Z as (..., 1), not below 0.

    >>> rod_signal(np.array([[1.0, 1.0, 1.0], [1.0, 0.0, 0.0]])).round(9).tolist()
    [[0.84321037], [0.0]]
    """
    weights = np.array([-0.702, 1.039, 0.433]) @ ROD_XYZ
    return np.maximum((rgb * weights).sum(-1, keepdims=True), 0)


def cones_and_rods(rgb, display_max, photopic, scotopic, k, shift):
    """(mp C + k ms shift S) / display_max with S the rod signal and mp, ms the ratios of thresholds."""
    rgb = limit_scene(rgb)
    display = cone_threshold(display_max / 2)
    mp, ms = display / cone_threshold(photopic), display / rod_threshold(scotopic)
    return (mp * rgb + k * ms * np.asarray(shift) * rod_signal(rgb)) / display_max


def ferwerda(rgb, display_max=80.0, photopic_adaptation=2.0, scotopic_adaptation=1.5, rod_weight_from="adaptation",
             rod_weight=0.5):
    """Visibility matched to the display for cones, per channel, plus the rods' gray; an affine matrix.

    The rods' weight from adaptation: clamp01(1 - (photopic_adaptation/2 - 0.01) / (10 - 0.01))^2.

    References
    ----------
    Ferwerda, Pattanaik, Shirley, Greenberg, "A Model of Visual Adaptation for Realistic Image Synthesis",
    SIGGRAPH 1996.

    >>> ferwerda([0.8, 0.1, 0.05], rod_weight_from="fixed").round(9).tolist()
    [0.052895678, 0.007184791, 0.003919727]
    """
    k = rod_weight
    if rod_weight_from == "adaptation":
        k = np.clip(1 - (photopic_adaptation / 2 - 0.01) / (10 - 0.01), 0, 1) ** 2
    return cones_and_rods(rgb, display_max, photopic_adaptation, scotopic_adaptation, k, (1, 1, 1))


def durand_dorsey_rods(rgb, display_max=80.0, photopic_adaptation=2.0, scotopic_adaptation=1.5,
                       rod_weight_from="adaptation", rod_weight=0.5, blue_shift_red=1.05, blue_shift_green=0.97,
                       blue_shift_blue=1.27):
    """Ferwerda's model with the blue shift of dim light and the rods' weight from scotopic_adaptation.

    The weight: (max(100 - scotopic_adaptation/4, 0) / (100 + scotopic_adaptation))^2.

    References
    ----------
    Durand, Dorsey, "Interactive Tone Mapping", EG Rendering Workshop 2000.

    >>> durand_dorsey_rods([0.8, 0.1, 0.05], rod_weight_from="fixed").round(9).tolist()
    [0.052928411, 0.007165151, 0.004096486]
    """
    k = rod_weight
    if rod_weight_from == "adaptation":
        k = (max(100 - scotopic_adaptation / 4, 0) / (100 + scotopic_adaptation)) ** 2
    shift = (blue_shift_red, blue_shift_green, blue_shift_blue)
    return cones_and_rods(rgb, display_max, photopic_adaptation, scotopic_adaptation, k, shift)


OPERATORS = {f.__name__: f for f in (drago, opencv_drago, ward, tumblin_rushmeier, ferwerda,
                                     durand_dorsey_rods)}
