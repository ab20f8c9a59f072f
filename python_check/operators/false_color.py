# SPDX-License-Identifier: Apache-2.0
"""Exposure as colors: a diagnostic of this project."""

import numpy as np

from .base import limit_scene, luminance, smoothstep
from .reinhard import WEIGHTS

# -7 stops and below, -6, ... +6, +7 and above: sRGB code values.
COLORS = ("000000 16003B 3B0A6B 2A2A9E 1F5FBF 1E97B5 1FA36B 808080 7FB13A C9C22A E8982A E2602C D62839 F27BB5 "
           "FFFFFF").split()


def srgb_decode(code):
    """Code value -> display light, IEC 61966-2-1:1999.

    >>> srgb_decode(np.array([0.02, 0.5])).round(9).tolist()
    [0.001547988, 0.21404114]
    """
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


# lygia 1.4.1, tonemapDebug: light of -5 stops and below, -4, ... +10 and above, with its weights of luminance.
LYGIA = [(0, 0, 0), (0, 0, 0.1647), (0, 0, 0.3647), (0, 0, 0.6647), (0, 0, 0.9647), (0, 0.9255, 0.9255), (0, 0.5647, 0),
         (0, 0.7843, 0), (1, 1, 0), (0.90588, 0.75294, 0), (1, 0.5647, 0), (1, 0, 0), (0.8392, 0, 0), (1, 0, 1),
         (0.6, 0.3333, 0.7882), (1, 1, 1)]


def false_color(rgb, palette="tonewright"):
    """One color for each stop of luminance about 0.18, changing over 1/4 stop half-way between two.

    ``palette=lygia``: other colors, with straight lines between them.

    >>> srgb = false_color([[0.18] * 3, [0.18 * 2**5.49] * 3, [0.0] * 3])
    >>> srgb.round(6).tolist()
    [[0.215861, 0.215861, 0.215861], [0.767282, 0.099056, 0.22628], [0.0, 0.0, 0.0]]
    """
    if palette == "lygia":
        y = luminance(limit_scene(rgb), WEIGHTS["lygia"])[..., 0]
        stops = np.where(y > 0, np.log2(np.where(y > 0, y, 1) / 0.18), -np.inf)
        return np.stack([np.interp(stops, np.arange(-5, 11), channel) for channel in np.array(LYGIA).T], axis=-1)
    light = srgb_decode(np.array([[int(text[k:k + 2], 16) for k in (0, 2, 4)] for text in COLORS]) / 255)
    y = luminance(limit_scene(rgb))
    stops = np.where(y > 0, np.log2(np.where(y > 0, y, 1) / 0.18), -np.inf)
    out = np.broadcast_to(light[0], (*y.shape[:-1], 3))
    for k in range(-7, 7):
        out = out + smoothstep(k + 0.5 - 1 / 8, k + 0.5 + 1 / 8, stops) * (light[k + 8] - light[k + 7])
    return out


OPERATORS = {"false_color": false_color}
