# SPDX-License-Identifier: Apache-2.0
"""Encodings of the input of LUTs: those of `tonewright bake --input-encoding`, from their makers' papers.

ENCODINGS: name -> Encoding(encode, decode, primaries); light is scene-linear, 0.18 mid gray, codes are 0..1.
"""

from typing import Callable, NamedTuple

import numpy as np

from operators.pq import pq_decode, pq_encode
from operators.spaces import CAMERAS, D65, PRIMARIES

# xy of red, green, blue, white.
DAVINCI_WIDE_GAMUT = ((0.8000, 0.3130), (0.1682, 0.9877), (0.0790, -0.1155), D65)  # "DaVinci Resolve 17 Wide Gamut..."


class Encoding(NamedTuple):
    encode: Callable
    decode: Callable
    primaries: tuple


def acescct_encode(light):
    """Academy S-2016-001."""
    curve = (np.log2(np.maximum(light, 0.0078125)) + 9.72) / 17.52
    return np.where(light <= 0.0078125, 10.5402377416545 * light + 0.0729055341958355, curve)


def acescct_decode(code):
    toe = (code - 0.0729055341958355) / 10.5402377416545
    return np.where(code <= 0.155251141552511, toe, 2.0 ** (code * 17.52 - 9.72))


# ARRI, "ALEXA Log C Curve, Usage in VFX", EI 800: a, b, c, d, e, f and the cut.
A3, B3, C3, D3, E3, F3, CUT3 = 5.555556, 0.052272, 0.247190, 0.385537, 5.367655, 0.092809, 0.010591


def logc3_encode(light):
    return np.where(light > CUT3, C3 * np.log10(np.maximum(A3 * light + B3, 1e-9)) + D3, E3 * light + F3)


def logc3_decode(code):
    return np.where(code > E3 * CUT3 + F3, (10 ** ((code - D3) / C3) - B3) / A3, (code - F3) / E3)


def davinci_encode(light):
    """"DaVinci Resolve 17 Wide Gamut Intermediate", Blackmagic Design, 2021."""
    curve = (np.log2(np.maximum(light + 0.0075, 1e-9)) + 7) * 0.07329248
    return np.where(light <= 0.00262409, light * 10.44426855, curve)


def davinci_decode(code):
    return np.where(code <= 0.02740668, code / 10.44426855, 2 ** (code / 0.07329248 - 7) - 0.0075)


def unity_logc_encode(light):
    """Color.hlsl of Unity's render pipelines: LinearToLogC."""
    return 0.244161 * np.log10(np.maximum(5.555556 * light + 0.047996, 0)) + 0.386036


def unity_logc_decode(code):
    return (10 ** ((code - 0.386036) / 0.244161) - 0.047996) / 5.555556


def srgb_encode(light):
    """IEC 61966-2-1."""
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * np.maximum(light, 0) ** (1 / 2.4) - 0.055)


def srgb_decode(code):
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


ENCODINGS = {
    "acescct": Encoding(acescct_encode, acescct_decode, PRIMARIES["ap1"]),
    "logc3": Encoding(logc3_encode, logc3_decode, CAMERAS["awg3"]),
    "davinci": Encoding(davinci_encode, davinci_decode, DAVINCI_WIDE_GAMUT),
    "unity_logc": Encoding(unity_logc_encode, unity_logc_decode, PRIMARIES["rec709"]),
    "srgb": Encoding(srgb_encode, srgb_decode, PRIMARIES["rec709"]),
    # SMPTE ST 2084: scene-linear 1 at 100 cd/m2.
    "pq": Encoding(lambda light: pq_encode(100 * light), lambda code: pq_decode(code) / 100, PRIMARIES["rec2020"]),
}
