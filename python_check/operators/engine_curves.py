# SPDX-License-Identifier: Apache-2.0
"""Curves of single engines, from the formulas of their shaders."""

import numpy as np

from .base import limit_scene, smoothstep
from .false_color import srgb_decode


def babylon_contrast(rgb, contrast=1.5):
    """Code values of a 2.2 power within [0, 1], then away from 0.5, or towards 0.5 where contrast is below 1.

    References
    ----------
    Babylon.js (Apache-2.0), @babylonjs/core 9.35.0, applyImageProcessing.

    >>> babylon_contrast([0.18, 0.5, 4.0]).round(6).tolist()
    [0.448391, 0.775049, 1.0]
    """
    v = np.clip(np.asarray(rgb, float), 0, 1) ** (1 / 2.2)
    curved = v * v * (3 - 2 * v)
    return np.maximum(0.5 + contrast * (v - 0.5) if contrast < 1 else v + (contrast - 1) * (curved - v), 0)


def nanogl_tb(rgb):
    """sqrt(c) - c sqrt(c) + c (0.4672 c + 0.5328): code values of an sRGB display, not limited.

    References
    ----------
    nanogl-pbr 3.0.0-beta.16, glsl/includes/tonemap.glsl, ToneMapTB.

    >>> nanogl_tb([0.18, 1.0, 4.0]).round(6).tolist()
    [0.458938, 1.0, 3.6064]
    """
    c = limit_scene(rgb)
    return np.sqrt(c) * (1 - c) + c * (0.4672 * c + 0.5328)


def luma_gl(rgb, maximum_luminance=1.0):
    """Narkowicz's curve times 1 + (M - 1) smoothstep(0.72, 1.7, largest channel), limited to [0, M].

    References
    ----------
    luma.gl (MIT), @luma.gl/effects 9.4.2, toneMapping.

    >>> luma_gl([1.0, 1.0, 1.0], 4).round(6).tolist()
    [1.281858, 1.281858, 1.281858]
    """
    x = limit_scene(rgb)
    scale = 1 + (maximum_luminance - 1) * smoothstep(0.72, 1.7, x.max(-1, keepdims=True))
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14) * scale, 0, maximum_luminance)


OPERATORS = {f.__name__: f for f in (babylon_contrast, nanogl_tb, luma_gl)}
CODE_POWER = {"babylon_contrast": 2.2}
DECODE = {"nanogl_tb": lambda **_: srgb_decode}
PEAK = {"luma_gl": lambda maximum_luminance=1.0: maximum_luminance}
FROM_DISPLAY = {"luma_gl": {"maximum_luminance": lambda display: display.peak / 100}}
