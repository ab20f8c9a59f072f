# SPDX-License-Identifier: Apache-2.0
"""Clamp, division, exponential, logarithmic and power curves: what needs a constant or one figure of the picture.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import apply_curve, limit_scene, log1p


def clamp(rgb, apply="channels"):
    """Limit each channel to [0, 1]: no tone mapping, the baseline. ``apply=max`` divides by a largest channel above 1.

    >>> clamp([-0.1, 0.18, 4]).tolist()
    [0.0, 0.18, 1.0]
    >>> clamp([2.0, 1, 0.5], apply="max").tolist()
    [1.0, 0.5, 0.25]
    """
    if apply == "channels":
        return np.clip(np.asarray(rgb, float), 0, 1)
    rgb = limit_scene(rgb)
    return rgb / np.maximum(rgb.max(-1, keepdims=True), 1)


def linear(rgb, divisor=4.0, apply="channels", **color):
    """x / divisor, then limited to [0, 1]; with the largest luminance as divisor the "maximum division".

    References
    ----------
    tizian/tonemapper (MIT), "Maximum division".

    >>> linear([0.8, 2, 16]).tolist()
    [0.2, 0.5, 1.0]
    """
    return np.clip(apply_curve(lambda x: x / divisor, limit_scene(rgb), apply, **color), 0, 1)


def exponential(rgb, average=1.0, apply="luminance", **color):
    """1 - exp(-x / average), average the mean luminance.

    References
    ----------
    Ferschin, Tastl, Purgathofer, "A comparison of techniques for the transformation of radiosity values to monitor
    colors", ICIP 1994.

    >>> exponential([0.8, 0.1, 0.05]).round(9).tolist()
    [0.709464744, 0.088683093, 0.044341547]
    """
    return apply_curve(lambda x: -np.expm1(-x / average), limit_scene(rgb), apply, **color)


def logarithmic(rgb, p=1.0, maximum=100.0, apply="luminance", **color):
    """log10(1 + p x) / log10(1 + p maximum): the largest luminance becomes 1.

    References
    ----------
    tizian/tonemapper (MIT), "Logarithmic mapping"; the base of the logarithms cancels.

    >>> logarithmic([0.8, 0.1, 0.05]).round(9).tolist()
    [0.155029981, 0.019378748, 0.009689374]
    """
    return apply_curve(lambda x: log1p(p * x) / log1p(p * maximum), limit_scene(rgb), apply, **color)


def log_tonemap(rgb, limit=16.0, contrast=0.0, apply="luminance", **color):
    """ln(1 + x) / ln(1 + limit); with contrast > 0 then limited to [0, 1] and mixed with x^2 (3 - 2x) by it.

    References
    ----------
    Comment 9 to Madams, "Why Reinhard desaturates my blacks", imdoingitwrong.wordpress.com, 2010: the curve
    `logToneMap` and `hackyContrast`, which holds in [0, 1] only.

    >>> log_tonemap([0.8, 0.1, 0.05]).round(9).tolist()
    [0.252533769, 0.031566721, 0.015783361]
    >>> log_tonemap([0.8, 0.1, 0.05], contrast=0.5).round(9).tolist()
    [0.205821929, 0.017246593, 0.00826142]
    """
    out = apply_curve(lambda x: log1p(x) / log1p(limit), limit_scene(rgb), apply, **color)
    if contrast > 0:
        out = np.clip(out, 0, 1)
        out = out + (out * out * (3 - 2 * out) - out) * contrast
    return out


def exponentiation(rgb, p=0.5, maximum=100.0, apply="luminance", **color):
    """(x / maximum)^p: the largest luminance becomes 1.

    References
    ----------
    tizian/tonemapper (MIT), "Exponentiation".

    >>> exponentiation([0.8, 0.1, 0.05]).round(9).tolist()
    [0.161555184, 0.020194398, 0.010097199]
    """
    return apply_curve(lambda x: (x / maximum) ** p, limit_scene(rgb), apply, **color)


OPERATORS = {f.__name__: f for f in (clamp, linear, exponential, logarithmic, log_tonemap, exponentiation)}
