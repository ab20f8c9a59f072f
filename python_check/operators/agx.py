# SPDX-License-Identifier: Apache-2.0
"""AgX and its descendants."""

import numpy as np

from .base import HALF_MAX, limit_scene, luminance
from .spaces import rgb_to_rgb

AGX_INSET = np.array([[0.842479062253094, 0.0784335999999992, 0.0792237451477643],
                      [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
                      [0.0423756549057051, 0.0784336, 0.879142973793104]])


# -10 and +6.5 stops about 0.18 as Sobotka's config and its followers truncate them. The exact log2(0.18) - 10
# and log2(0.18) + 6.5 would move code values by up to 1e-7.
AGX_LOG2 = (-12.47393, 4.026069)


def agx_shape(rgb):
    """log2 of scene-linear, normalized so that AGX_LOG2 becomes [0, 1], clamped.

    >>> agx_shape(np.array([0.0, 0.18, 99.0])).round(6).tolist()
    [0.0, 0.606061, 1.0]
    """
    low, high = AGX_LOG2
    with np.errstate(divide="ignore"):  # log2(0) = -inf, which the clamp turns into 0
        return np.clip((np.log2(rgb) - low) / (high - low), 0, 1)


def agx_sigmoid(n, pivot=(10 / 16.5, 0.5), slope=2.0, powers=(3.0, 3.25)):
    """T. Sobotka's two-sided sigmoid through (0,0), the pivot with the given slope, and (1,1).

    Each side is u / (1 + u^p)^(1/p), scaled to end exactly at its corner. Toe power first, then shoulder. The
    defaults reproduce the 4096 entries of AgX_Default_Contrast.spi1d within their seven printed decimals.

    >>> agx_sigmoid(np.array([0.5, 10 / 16.5, 0.9])).round(7).tolist()
    [0.2926735, 0.5, 0.9545841]
    """
    (px, py), k, (toe, shoulder) = pivot, slope, powers

    def side(u, lx, ly, p):  # u, lx, ly: distances from the pivot
        scale = ((k * lx) ** -p * ((k * lx / ly) ** p - 1)) ** (-1 / p)
        return scale * (k * u / scale) / (1 + (k * u / scale) ** p) ** (1 / p)

    below = np.maximum(py - side(np.maximum(px - n, 0), px, py, toe), 0)  # S(0) is 0, not -1e-16
    above = py + side(np.maximum(n - px, 0), 1 - px, 1 - py, shoulder)
    return np.where(n < px, below, above)


# ASC CDL of the config's looks, in OCIO's no-clamp style.
AGX_LOOKS = {
    "golden": {"slope": np.array([1.0, 0.9, 0.5]), "power": 0.8, "saturation": 1.3},
    "punchy": {"slope": np.ones(3), "power": 1.35, "saturation": 1.4},
}


def cdl(code, slope, power, saturation):
    """ASC CDL 1.2 without offset and without clamps: saturation about the luma of the powered value.

    >>> cdl(np.array([0.5, 0.5, 0.5]), np.ones(3), 2.0, 1.4).round(9).tolist()
    [0.25, 0.25, 0.25]
    """
    v = code * slope
    v = np.where(v > 0, np.maximum(v, 0) ** power, v)  # no-clamp: negatives pass unpowered
    luma = luminance(v)
    return luma + saturation * (v - luma)


def agx_sobotka(rgb, look=""):
    """Inset, log2 over -10..+6.5 stops about 0.18, sigmoid, look. Code values of a 2.2 power; no outset.

    References
    ----------
    T. Sobotka, AgX (github.com/sobotka/AgX), config.ocio: matrix, allocation (log2), looks.

    >>> agx_sobotka([0.8, 0.1, 0.05]).round(6).tolist()
    [0.729398, 0.437204, 0.370924]
    """
    code = agx_sigmoid(agx_shape(limit_scene(rgb) @ AGX_INSET.T))
    return cdl(code, **AGX_LOOKS[look]) if look else code


# Highest power first.
AGX_POLYNOMIALS = {
    6: [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232],
    7: [-17.86, 78.01, -126.7, 92.06, -28.72, 4.361, -0.1718, 0.002857],
}


def agx_minimal(rgb, order=6):
    """Sobotka's inset and log2, a polynomial for his curve, inverse inset on the code values.

    Code values of a 2.2 power; order 6 gives negative ones at black.

    References
    ----------
    B. Wrensch, "Minimal AgX Implementation", iolite-engine.com, 2023 (order 6); order 7: Filament, ToneMapper.cpp.

    >>> agx_minimal([0.8, 0.1, 0.05]).round(9).tolist()
    [0.79469506, 0.423532987, 0.341266439]
    """
    n = agx_shape(limit_scene(rgb) @ AGX_INSET.T)
    return np.polyval(AGX_POLYNOMIALS[int(order)], n) @ np.linalg.inv(AGX_INSET).T


# Rec.2020 inset of Blender's AgX and the inverse of its outset, as three.js and Filament print them.
INSET_2020 = np.array([[0.856627153315983, 0.0951212405381588, 0.0482516061458583],
                       [0.137318972929847, 0.761241990602591, 0.101439036467562],
                       [0.11189821299995, 0.0767994186031903, 0.811302368396859]])
OUTSET_2020 = np.array([[1.1271005818144368, -0.1106066430966033, -0.0164939387178346],
                        [-0.1413297634984383, 1.1578237022162718, -0.0164939387178343],
                        [-0.1413297634984383, -0.1106066430966029, 1.2519364065950402]])
# three.js's Rec.709 <-> Rec.2020, four digits; 0.0113 stands so there.
THREE_TO_2020 = np.array([[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0113], [0.0164, 0.0880, 0.8956]])
THREE_TO_709 = np.array([[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]])


def agx_threejs(rgb, clamp="no", matrices="printed"):
    """Wrensch's polynomial between Blender's Rec.2020 inset and outset; display-linear Rec.709, not yet limited.

    ``clamp=yes`` limits to [0, 1], as three.js does since r161. ``matrices=exact``: hdrify 1.2.1 (MIT), which takes
    Rec.709 <-> Rec.2020 from the primaries.

    The one operator here that does not limit its input at 0: negatives go through the first matrices, where the
    floor of 1e-10 before the logarithm takes what is left of them.

    References
    ----------
    three.js (MIT), tonemapping_pars_fragment: AgXToneMapping, before its last clamp.

    >>> agx_threejs([0.8, 0.1, 0.05]).round(9).tolist()
    [0.607619019, 0.177156407, 0.1125247]
    """
    to_2020, to_709 = THREE_TO_2020, THREE_TO_709
    if matrices == "exact":
        to_2020, to_709 = rgb_to_rgb("rec709", "rec2020"), rgb_to_rgb("rec2020", "rec709")
    x = np.asarray(rgb, float) @ to_2020.T @ INSET_2020.T
    code = np.polyval(AGX_POLYNOMIALS[6], agx_shape(np.maximum(x, 1e-10))) @ OUTSET_2020.T
    light = np.maximum(code, 0) ** 2.2 @ to_709.T
    return np.clip(light, 0, 1) if clamp == "yes" else light


def agx_needle(rgb):
    """Wrensch's AgX of max(x, 0.001), a look about the luma from before its power, the inverse inset, power 2.2.

    The look: slope 1.05, power 1.1, saturation 1.15. Display-linear Rec.709, may exceed 1.

    References
    ----------
    Needle Engine, @needle-tools/engine 4.16.5, engine_tonemapping.ts, which replaces three.js's chunk.

    >>> agx_needle([0.18, 0.18, 0.18]).round(6).tolist()
    [0.205799, 0.205852, 0.205856]
    """
    n = agx_shape(np.clip(np.asarray(rgb, float), 0.001, HALF_MAX) @ AGX_INSET.T)
    code = np.polyval(AGX_POLYNOMIALS[6], n)
    luma = luminance(code)
    code = (luma + 1.15 * ((1.05 * code) ** 1.1 - luma)) @ np.linalg.inv(AGX_INSET).T
    return np.maximum(code, 0) ** 2.2


def agx_filament(rgb, look=""):
    """Polynomial of order 7 between Blender's Rec.2020 inset and outset; display-linear Rec.2020.

    The looks' saturation is about the luma (0.2126, 0.7152, 0.0722) from before slope and power.

    References
    ----------
    Google, Filament (Apache-2.0), ToneMapper.cpp: AgxToneMapper.

    >>> agx_filament([0.8, 0.1, 0.05]).round(9).tolist()
    [0.544170018, 0.196591892, 0.135689105]
    """
    code = np.polyval(AGX_POLYNOMIALS[7], agx_shape(limit_scene(rgb) @ INSET_2020.T))
    if look:
        cdl_look = AGX_LOOKS[look]
        luma = luminance(code)
        powered = (code * cdl_look["slope"]) ** cdl_look["power"]
        code = luma + cdl_look["saturation"] * (powered - luma)
    return np.maximum(code @ OUTSET_2020.T, 0) ** 2.2


# Rec.709 -> Rec.2020 -> inset and outset -> Rec.709, multiplied out by Godot.
GODOT44_IN = np.array([[0.544908138163631, 0.373779459598123, 0.081384976686408],
                       [0.140440058840013, 0.754109598640138, 0.105433585368578],
                       [0.088827411851915, 0.178877124650438, 0.732249999569484]])
GODOT44_OUT = np.array([[1.964550960273326, -0.855858451178075, -0.108867108268316],
                        [-0.299322433909111, 1.326451074150236, -0.027084020983875],
                        [-0.164368338060804, -0.238224640688606, 1.402665347143272]])
GODOT_IN = np.array([[0.544814746488245, 0.373787398372697, 0.0813978551390581],
                     [0.140416948464053, 0.754137554567394, 0.105445496968552],
                     [0.0888104196149096, 0.178871756420858, 0.732317823964232]])
GODOT_OUT = np.array([[1.96488741169489, -0.855988495690215, -0.108898916004672],
                      [-0.299313364904742, 1.3263979646198, -0.0270845997150571],
                      [-0.164352742528393, -0.238183969428088, 1.40253671195648]])


def agx_godot44(rgb):
    """A polynomial for the curve of Blender's AgX, decoded with 2.4; display-linear Rec.709, may be negative.

    References
    ----------
    Godot 4.4 (MIT), tonemap.glsl: tonemap_agx. Its log2 range is exactly -10..+6.5 stops about 0.18.

    >>> agx_godot44([1.0, 1, 1]).round(9).tolist()
    [0.553931772, 0.554003629, 0.554011975]
    """
    x = np.maximum(limit_scene(rgb), 2e-10) @ GODOT44_IN.T
    n = np.clip((np.log2(x / 0.18) + 10) / 16.5, 0, 1)
    code = np.polyval([27.069, -74.778, 70.359, -25.682, 4.0111, 0.021, 0], n)
    return np.maximum(code, 0) ** 2.4 @ GODOT44_OUT.T


def agx_godot(rgb, contrast=1.25, white=16.29, output_max=1.0):
    """A. Wen's curve between the matrices: a power toe up to 0.18, a rational shoulder through (white, output_max).

    Display-linear Rec.709, each channel of the inset limited to output_max, the result not limited.

    References
    ----------
    Godot 4.6 (MIT), tonemap.glsl: tonemap_agx; the curve is allenwp's.

    >>> agx_godot([1.0, 1, 1]).round(9).tolist()
    [0.596110849, 0.596110849, 0.596110849]
    """
    gray = 0.18
    a = (1 / gray - 1) * gray**contrast
    slope = contrast * gray ** (contrast - 1) * a / (gray**contrast + a) ** 2
    room = output_max - gray
    w = (white - gray) ** 2 / room * slope
    x = limit_scene(rgb) @ GODOT_IN.T
    power = x**contrast
    s = np.maximum(x - gray, 0)
    shoulder = slope * s * (1 + s / w) / (1 + slope * s / room) + gray
    return np.minimum(np.where(x < gray, power / (power + a), shoulder), output_max) @ GODOT_OUT.T


OPERATORS = {f.__name__: f for f in (agx_sobotka, agx_minimal, agx_threejs, agx_needle, agx_filament, agx_godot44,
                                     agx_godot)}
WORKING = {"agx_filament": "rec2020"}  # operator -> working primaries, where not "rec709"
# Operators that put out code values, and the power that decodes them.
CODE_POWER = {"agx_sobotka": 2.2, "agx_minimal": 2.2}
