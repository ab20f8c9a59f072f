# SPDX-License-Identifier: Apache-2.0
"""Colour spaces by their chromaticities, display encodings, and what happens to scene-linear before an operator."""

import numpy as np

from .base import HALF_MAX

D65 = (0.3127, 0.3290)  # ITU-R BT.709-6, table 1
ACES_WHITE = (0.32168, 0.33767)  # SMPTE ST 2065-1
# xy of red, green, blue, white.
PRIMARIES = {
    "rec709": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), D65),  # ITU-R BT.709-6
    "rec2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65),  # ITU-R BT.2020-2
    "p3d65": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), D65),  # SMPTE EG 432-1
    "ap0": ((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770), ACES_WHITE),  # SMPTE ST 2065-1
    "ap1": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), ACES_WHITE),  # Academy S-2014-004
}
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz(xy):
    """CIE XYZ with Y = 1 of a chromaticity.

    >>> xyz((0.25, 0.5)).tolist()
    [0.5, 1.0, 0.5]
    """
    x, y = xy
    return np.array([x / y, 1, (1 - x - y) / y])


def rgb_to_xyz(name):
    """Matrix of linear RGB to CIE XYZ under the space's own white (SMPTE RP 177).

    >>> rgb_to_xyz("ap1")[1].round(9).tolist()
    [0.272228717, 0.674081766, 0.053689517]
    """
    *rgb, white = PRIMARIES[name]
    columns = np.stack([xyz(p) for p in rgb], axis=-1)
    return columns * np.linalg.solve(columns, xyz(white))


def rgb_to_rgb(source, target):
    """Matrix between linear RGB spaces, Bradford-adapted (ICC.1 annex E) where their whites differ.

    >>> rgb_to_rgb("ap0", "ap1")[0].round(10).tolist()  # Academy S-2014-004: 1.4514393161, ...
    [1.4514393161, -0.2365107469, -0.2149285693]
    """
    if source == target:
        return np.eye(3)
    cones = [BRADFORD @ xyz(PRIMARIES[name][3]) for name in (source, target)]
    adapt = np.linalg.solve(BRADFORD, np.diag(cones[1] / cones[0]) @ BRADFORD)
    if PRIMARIES[source][3] == PRIMARIES[target][3]:
        adapt = np.eye(3)
    return np.linalg.solve(rgb_to_xyz(target), adapt @ rgb_to_xyz(source))


def srgb_encode(light):
    """Display light -> code value, IEC 61966-2-1:1999.

    >>> srgb_encode(np.array([0.001, 0.5])).round(9).tolist()
    [0.01292, 0.735356983]
    """
    light = np.asarray(light, float)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def power_encode(exponent):
    """Display light -> code value of a pure power display; negatives become 0.

    >>> power_encode(2.0)(np.array([-1.0, 0.25])).tolist()
    [0.0, 0.5]
    """
    return lambda light: np.maximum(light, 0) ** (1 / exponent)


INPUTS = {f"lin_{name}": name for name in PRIMARIES}
DISPLAYS = {
    "srgb": ("rec709", srgb_encode),
    "rec1886": ("rec709", power_encode(2.4)),  # ITU-R BT.1886 with black at 0
    "g22": ("rec709", power_encode(2.2)),
    "display_p3": ("p3d65", srgb_encode),
    "rec2020": ("rec2020", power_encode(2.4)),
}


def sanitise(rgb):
    """NaN -> 0, then each channel limited to +-65504.

    >>> sanitise([np.nan, -np.inf, np.inf]).tolist()
    [0.0, -65504.0, 65504.0]
    """
    return np.clip(np.nan_to_num(np.asarray(rgb, float), nan=0.0), -HALF_MAX, HALF_MAX)
