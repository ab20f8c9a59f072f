# SPDX-License-Identifier: Apache-2.0
"""Color spaces by their chromaticities, display encodings, and what happens to scene-linear before an operator."""

from typing import Callable, NamedTuple

import numpy as np

from .base import HALF_MAX, REC2020_WEIGHTS, luminance
from .pq import pq_encode

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
# Cameras: ARRI, "ALEXA Log C Curve", 2017, and "LogC4", 2022; Sony, "Technical Summary for S-Gamut3.Cine/S-Log3".
CAMERAS = {
    "awg3": ((0.6840, 0.3130), (0.2210, 0.8480), (0.0861, -0.1020), D65),
    "awg4": ((0.7347, 0.2653), (0.1424, 0.8576), (0.0991, -0.0308), D65),
    "sgamut3": ((0.730, 0.280), (0.140, 0.855), (0.100, -0.050), D65),
    "sgamut3cine": ((0.766, 0.275), (0.225, 0.800), (0.089, -0.087), D65),
}
CAT02 = np.array([[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.0030, 0.0136, 0.9834]])  # CIE 159:2004
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz(xy):
    """CIE XYZ with Y = 1 of a chromaticity.

    >>> xyz((0.25, 0.5)).tolist()
    [0.5, 1.0, 0.5]
    """
    x, y = xy
    return np.array([x / y, 1, (1 - x - y) / y])


def chromaticities(space):
    """xy of red, green, blue and white of a key of PRIMARIES; other than texts are taken for these themselves."""
    return PRIMARIES[space] if isinstance(space, str) else space


def rgb_to_xyz(space):
    """Matrix of linear RGB to CIE XYZ under the space's own white (SMPTE RP 177).

    >>> rgb_to_xyz("ap1")[1].round(9).tolist()
    [0.272228717, 0.674081766, 0.053689517]
    """
    *rgb, white = chromaticities(space)
    columns = np.stack([xyz(p) for p in rgb], axis=-1)
    return columns * np.linalg.solve(columns, xyz(white))


def rgb_to_rgb(source, target, cone=BRADFORD):
    """Matrix between linear RGB spaces, Bradford-adapted (ICC.1 annex E) where their whites differ.

    The makers of CAMERAS state their matrix to ACES2065-1 with CAT02, so those gamuts go through ACES2065-1.

    >>> rgb_to_rgb("ap0", "ap1")[0].round(10).tolist()  # Academy S-2014-004: 1.4514393161, ...
    [1.4514393161, -0.2365107469, -0.2149285693]
    >>> rgb_to_rgb(CAMERAS["awg3"], "ap0")[0].round(5).tolist()  # the Academy's IDT by ARRI: 0.680206, ...
    [0.68021, 0.23614, 0.08366]
    """
    if source == target:
        return np.eye(3)
    cameras = CAMERAS.values()
    if cone is BRADFORD and (source in cameras or target in cameras):
        to_ap0, from_ap0 = (rgb_to_rgb(space, "ap0", CAT02 if space in cameras else None) for space in (source, target))
        return np.linalg.solve(from_ap0, to_ap0)
    cone = BRADFORD if cone is None else cone
    whites = [chromaticities(space)[3] for space in (source, target)]
    cones = [cone @ xyz(white) for white in whites]
    adapt = np.linalg.solve(cone, np.diag(cones[1] / cones[0]) @ cone)
    if whites[0] == whites[1]:
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


UNIT = 100.0  # cd/m2 of light 1 on an HDR display, before the reference white


def pq_display(light):
    """Light in units of 100 cd/m2 -> code value of SMPTE ST 2084.

    >>> pq_display(np.array([1.0, 100.0])).round(12).tolist()
    [0.508078421517, 1.0]
    """
    return pq_encode(light * UNIT)


HLG_A, HLG_GAMMA = 0.17883277, 1.2  # ITU-R BT.2100-2, table 5; the OOTF of 1000 cd/m2
HLG_B, HLG_C = 1 - 4 * HLG_A, 0.5 - HLG_A * np.log(4 * HLG_A)
HLG_FLOOR = 1e-4 / 3**HLG_GAMMA  # of the luminance in the OOTF's gain, in OpenColorIO: black stays 0
HLG_PEAK = 1000.0


def hlg_oetf(scene):
    """Scene light of [0, 1] -> code value, ITU-R BT.2100-2, table 5.

    >>> hlg_oetf(np.array([0.0, 1 / 12, 1])).round(8).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.where(scene <= 1 / 12, np.sqrt(3 * scene), HLG_A * np.log(np.maximum(12 * scene - HLG_B, 1e-9)) + HLG_C)


def hlg_display(light):
    """Rec.2020 light in units of 100 cd/m2 -> code value of a display of 1000 cd/m2, at most 1: OpenColorIO's.

    >>> hlg_display(np.full(3, 0.18)).round(7).tolist(), hlg_display(np.full(3, 2.03)).round(7).tolist()
    ([0.3247812, 0.3247812, 0.3247812], [0.7498774, 0.7498774, 0.7498774])
    >>> hlg_display(np.array([0.0, 0.0, 10.0])).round(7).tolist()
    [0.0, 0.0, 1.0]
    """
    e = light * UNIT / HLG_PEAK
    return np.minimum(hlg_oetf(e * np.maximum(luminance(e, REC2020_WEIGHTS), HLG_FLOOR) ** (1 / HLG_GAMMA - 1)), 1)


class Display(NamedTuple):
    """Primaries, light -> code values, and what operators may ask: cd/m2 of the peak. `largest`: light of code 1."""

    primaries: str
    encode: Callable
    is_hdr: bool = False
    peak: float = 100.0
    largest: float = 1.0


INPUTS = {f"lin_{name}": name for name in PRIMARIES}
DISPLAYS = {
    "srgb": Display("rec709", srgb_encode),
    "rec1886": Display("rec709", power_encode(2.4)),  # ITU-R BT.1886 with black at 0
    "g22": Display("rec709", power_encode(2.2)),
    "display_p3": Display("p3d65", srgb_encode),
    "rec2020": Display("rec2020", power_encode(2.4)),
    "rec2100_pq": Display("rec2020", pq_display, True, 1000.0, 100.0),
    "rec2100_hlg": Display("rec2020", hlg_display, True, HLG_PEAK, HLG_PEAK / UNIT),
    "p3d65_pq": Display("p3d65", pq_display, True, 1000.0, 100.0),
}


def sanitize(rgb):
    """NaN -> 0, then each channel limited to +-65504.

    >>> sanitize([np.nan, -np.inf, np.inf]).tolist()
    [0.0, -65504.0, 65504.0]
    """
    return np.clip(np.nan_to_num(np.asarray(rgb, float), nan=0.0), -HALF_MAX, HALF_MAX)
