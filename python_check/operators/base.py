# SPDX-License-Identifier: Apache-2.0
"""Functions that the operators share: the limit of scene-linear, luminance, and the ways a curve meets a color."""

import numpy as np

HALF_MAX = 65504.0  # largest finite IEEE 754 half float
REC709_WEIGHTS = np.array([0.2126, 0.7152, 0.0722])  # ITU-R BT.709-6, item 3.2
REC2020_WEIGHTS = np.array([0.2627, 0.6780, 0.0593])  # ITU-R BT.2020-2, table 4
# Mantiuk et al. 2009, saturation from the contrast: k1, k2 of each correction.
MANTIUK = {"nonlinear": (1.6774, 0.9925), "luminance_preserving": (2.3892, 0.8552)}
F0_ROUNDING = 1e-9  # a curve's f(0) up to here is 0, left over from a difference


def limit_scene(rgb):
    """Scene-linear limited to [0, 65504] per channel, the first step of every operator here.

    >>> limit_scene([-0.1, 0.18, 1e9]).tolist()
    [0.0, 0.18, 65504.0]
    """
    return np.clip(np.asarray(rgb, float), 0, HALF_MAX)


def luminance(rgb, weights=REC709_WEIGHTS):
    """Weighted sum of (..., 3), as (..., 1).

    >>> luminance(np.array([1.0, 0.0, 0.0])).tolist()
    [0.2126]
    """
    return (rgb * weights).sum(-1, keepdims=True)


def smoothstep(low, high, x):
    """0 at `low`, 1 at `high` and beyond, t^2 (3 - 2t) between; `low` > `high` falls instead.

    >>> smoothstep(0, 2, np.array([-1, 1, 5.0])).tolist()
    [0.0, 0.5, 1.0]
    """
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def log1p(x):
    """ln(1 + x), also of a complex x whose imaginary part is a small step: np.log1p of those cancels near 0.

    >>> float(log1p(np.complex128(1e-9 + 1e-20j)).real)
    9.999999995e-10
    """
    return np.log1p(x.real) + 1j * x.imag / (1 + x.real) if np.iscomplexobj(x) else np.log1p(x)


def curve_contrast(f, x):
    """Slope of f in log-log, d ln f / d ln x = x f'(x) / f(x), at x > 0; 0 where f is not above 0.

    By a complex step, f(x + ih) = f(x) + ih f'(x) + O(h^2): no difference is taken, so 15 digits are right. The
    curve has to be written with functions that are analytic between its joints.

    >>> curve_contrast(lambda x: x / (1 + x), np.array([0.25, 3.0])).round(12).tolist()
    [0.8, 0.25]
    """
    x = np.maximum(x, 1e-290)  # so that x h is no denormal
    h = 1e-12
    z = f(x * (1 + 1j * h))
    return np.where(z.real > 0, z.imag / h / np.where(z.real > 0, z.real, 1), 0)


def mantiuk_saturation(contrast, correction):
    """(1 + k1) c^k2 / (1 + k1 c^k2) of the contrast c: 1 where the curve keeps contrast, less where it compresses.

    References
    ----------
    R. Mantiuk, R. Mantiuk, Tomaszewska, Heidrich, "Color correction for tone mapping", Computer Graphics Forum
    28(2), 2009.

    >>> mantiuk_saturation(np.array([-1.0, 0.0, 1.0]), "nonlinear").tolist()
    [0.0, 0.0, 1.0]
    """
    k1, k2 = MANTIUK[correction]
    power = np.maximum(contrast, 0) ** k2
    return (1 + k1) * power / (1 + k1 * power)


def hue_preserving(f, rgb):
    """Largest and smallest channel through f; the middle one keeps its relative place between them.

    >>> hue_preserving(np.sqrt, np.array([[4.0, 2.5, 1.0], [4.0, 4.0, 4.0]])).tolist()
    [[2.0, 1.5, 1.0], [2.0, 2.0, 2.0]]
    """
    low, high = rgb.min(-1, keepdims=True), rgb.max(-1, keepdims=True)
    place = (rgb - low) / np.where(high > low, high - low, 1)
    return f(low) + (f(high) - f(low)) * place


def apply_curve(f, rgb, apply="channels", color_correction="ratio", saturation=1.0, saturation_from="fixed",
                weights=REC709_WEIGHTS, contrast=None, code_power=None):
    """Tone-map a color with a curve.

    ``channels``: f of each. ``luminance``, ``max``: with n the weighted sum or the largest channel, the color
    times f(n)/n, black where n is 0; negative f counts as 0, and f(0) > 0 is an error. ``hue_preserving``: see there.

    Color corrections of ``luminance``, with L = n, Lo = f(L), s = saturation: ``ratio`` (C/L) Lo; ``nonlinear``
    (C/L)^s Lo; ``luminance_preserving`` ((C/L - 1) s + 1) Lo. Saturation from ``contrast`` multiplies s by
    mantiuk_saturation of the curve's contrast at L.

    Parameters
    ----------
    f : callable, (...) array -> (...) array; for saturation from contrast also of complex numbers
    rgb : (..., 3) array, >= 0
    apply : {'channels', 'luminance', 'max', 'hue_preserving'}
    color_correction : {'ratio', 'nonlinear', 'luminance_preserving'}; other than 'ratio' only with 'luminance'
    saturation : float; other than 1 only with a correction other than 'ratio'
    saturation_from : {'fixed', 'contrast'}; 'contrast' only with a correction other than 'ratio'
    weights : (3,) array, of the luminance
    contrast : callable, L -> log-log slope of Lo, where it is known; None differentiates f
    code_power : float, where f puts out code values of this power; luminance and max then scale light, f^power

    References
    ----------
    Mantiuk et al. 2009. The hue-preserving form is that of Adobe's DNG SDK (RefBaselineRGBTone).

    >>> apply_curve(np.sqrt, np.array([4.0, 2.0, 1.0]), "max").tolist()
    [2.0, 1.0, 0.5]
    """
    if color_correction != "ratio" and apply != "luminance":
        raise ValueError(f"color_correction={color_correction} with apply={apply}; expected apply=luminance")
    if color_correction == "ratio" and (saturation != 1 or saturation_from != "fixed"):
        raise ValueError("saturation with color_correction=ratio; expected another correction")
    if apply == "channels":
        return f(rgb)
    if apply == "hue_preserving":
        return hue_preserving(f, rgb)
    if (f(np.zeros(1)) > F0_ROUNDING).any():
        raise ValueError(f"f(0) > 0 with apply={apply}; expected a curve that keeps black")

    norm = {"luminance": lambda c: luminance(c, weights), "max": lambda c: c.max(-1, keepdims=True)}[apply](rgb)
    black = norm <= 0
    norm = np.where(black, 1, norm)
    ratio = rgb / norm
    power = code_power or 1
    light = np.maximum(f(norm), 0) ** power
    if saturation_from == "contrast":
        slope = contrast(norm) if contrast else power * curve_contrast(f, norm)
        saturation = saturation * mantiuk_saturation(slope, color_correction)
    if color_correction == "nonlinear":
        # 0**s is 0 for s above 0; a saturation that follows the contrast is 0 only as the limit of such s.
        ratio = np.where((ratio == 0) & (saturation_from == "contrast"), 0, ratio**saturation)
    elif color_correction == "luminance_preserving":
        ratio = (ratio - 1) * saturation + 1
    out = np.where(black, 0, ratio * light)
    return np.maximum(out, 0) ** (1 / power) if code_power else out
