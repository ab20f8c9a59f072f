# SPDX-License-Identifier: Apache-2.0
"""FFmpeg's filter tonemap and its curve mobius, from libavfilter/vf_tonemap.c of FFmpeg 5.1.9 (formulas only).

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import apply_curve, limit_scene, luminance
from .hable import hable_curve

DEFAULTS = {"linear": 1.0, "gamma": 1.8, "clip": 1.0, "reinhard": 0.5, "mobius": 0.3}
LARGEST = {"reinhard": 1.0, "mobius": 0.99}


def mobius_curve(x, j, peak):
    """x up to j, a hyperbola through (j, j) with slope 1 and through (peak, 1) above.

    >>> mobius_curve(np.array([0.2, 0.3, 10.0]), 0.3, 10.0).round(12).tolist()
    [0.2, 0.3, 1.0]
    """
    a = -j * j * (peak - 1) / (j * j - 2 * j + peak)
    b = (j * j - 2 * j * peak + peak) / (peak - 1)
    y = np.where(x.real > j, x, j)
    return np.where(x.real > j, (b * b + 2 * b * j + j * j) / (b - a) * (y + a) / (y + b), x)


def mobius(rgb, knee=0.3, peak=10.0, apply="max", **color):
    """mobius_curve, as `apply` chooses.

    >>> mobius([1.0, 1, 1], peak=100).round(6).tolist()
    [0.651233, 0.651233, 0.651233]
    """
    return apply_curve(lambda x: mobius_curve(x, knee, peak), limit_scene(rgb), apply, **color)


def ffmpeg(rgb, tonemap="hable", param=0.0, desat=2.0, peak=10.0):
    """Mix towards the luminance L by max(L - desat, 1e-6)/max(L, 1e-6), then the color times f(m)/m, m the largest channel.

    `param` 0 stands for the default of the curve.

    References
    ----------
    FFmpeg 5.1.9, libavfilter/vf_tonemap.c.

    >>> ffmpeg([100.0, 0, 0], "reinhard", peak=100).round(5).tolist()
    [0.97596, 0.65569, 0.65569]
    """
    param = param or DEFAULTS.get(tonemap, 0)
    if param > LARGEST.get(tonemap, np.inf):
        raise ValueError(f"param={param} with tonemap={tonemap}; expected up to {LARGEST[tonemap]}")
    curves = {
        "none": lambda x: x,
        "linear": lambda x: x * param / peak,
        "gamma": lambda x: np.where(x > 0.05, (np.maximum(x, 0.05) / peak) ** (1 / param),
                                    x * (0.05 / peak) ** (1 / param) / 0.05),
        "clip": lambda x: np.clip(x * param, 0, 1),
        "reinhard": lambda x: x / (x + (1 - param) / param) * (peak + (1 - param) / param) / peak,
        "hable": lambda x: hable_curve(x) / hable_curve(peak),
        "mobius": lambda x: mobius_curve(x, param, peak),
    }
    c = limit_scene(rgb)
    if desat > 0:
        light = luminance(c)
        c = c + np.maximum(light - desat, 1e-6) / np.maximum(light, 1e-6) * (light - c)
    return apply_curve(curves[tonemap], c, "max")


OPERATORS = {f.__name__: f for f in (ffmpeg, mobius)}
