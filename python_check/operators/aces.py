# SPDX-License-Identifier: Apache-2.0
"""Fits of the ACES 1.x rendering, and the two steps of it that Filament and Unreal keep: glow and red modifier.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import HALF_MAX, apply_curve, limit_scene, smoothstep
from .spaces import rgb_to_rgb, rgb_to_xyz

AP1_WEIGHTS = rgb_to_xyz("ap1")[1]


def aces_narkowicz(rgb, prescale=1.0, clamp="yes", apply="channels", **color):
    """x(2.51x + 0.03) / (x(2.43x + 0.59) + 0.14) of prescale x; limited to [0, 1] after apply_curve.

    ``clamp=no`` leaves the limit out: PlayCanvas 2.23.3 (TONEMAP_ACES), claygl 1.3.0, Orillusion 0.9.2.

    References
    ----------
    K. Narkowicz, "ACES Filmic Tone Mapping Curve", knarkowicz.wordpress.com, 2016-01-06. Its note: multiply
    the input by 0.6 to match the exposure of ACES.

    >>> aces_narkowicz([0.18, 1, 16]).round(9).tolist()
    [0.26689892, 0.803797468, 1.0]
    """

    def f(x):
        x = x * prescale
        return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)

    out = apply_curve(f, limit_scene(rgb), apply, **color)
    return np.clip(out, 0, 1) if clamp == "yes" else out


def aces_cesium(rgb, apply="channels", **color):
    """(x(x + 0.065) - 0.0001) / (x(0.985x + 0.433) + 0.238), limited to [0, 1].

    References
    ----------
    CesiumJS (Apache-2.0), @cesium/engine 26.3.0, AcesTonemappingStage. The form is Hill's, see hill_curve.

    >>> aces_cesium([0.18, 1, 4]).round(6).tolist()
    [0.12649, 0.643056, 0.917084]
    """
    return np.clip(apply_curve(lambda x: (x * (x + 0.065) - 0.0001) / (x * (0.985 * x + 0.433) + 0.238),
                               limit_scene(rgb), apply, **color), 0, 1)


HILL_IN = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
HILL_OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])


def hill_curve(v):
    """S. Hill's fit of the ACES RRT and ODT curves, between his two matrices.

    >>> float(hill_curve(np.float64(0)).round(9))
    -0.000380278
    """
    return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)


def aces_hill(rgb, prescale=1.0, gain=1.0, white=0.0, clamp="yes"):
    """Rec.709 -> AP1 with RRT_SAT, curve, ODT_SAT and AP1 -> Rec.709 of prescale x, limited to [0, 1], times gain.

    With white > 0 the result is divided by the curve at prescale * white, before the limit. ``clamp=no`` leaves
    the limit out.

    References
    ----------
    S. Hill, ACES.hlsl in M. Pettineo's BakingLab (MIT), there with gain 1.8. Input and output are Rec.709: the
    matrices hold the conversions. three.js: prescale 1/0.6. Godot, tonemap.glsl: prescale 1.8, white 1, no limit.

    >>> aces_hill([0.8, 0.1, 0.05]).round(9).tolist()
    [0.572381943, 0.051640303, 0.02338771]
    >>> aces_hill([1.0, 1, 1], prescale=1.8, white=1, clamp="no").round(9).tolist()
    [1.0, 1.0, 0.99999]
    """
    out = hill_curve(limit_scene(rgb) * prescale @ HILL_IN.T) @ HILL_OUT.T
    if white > 0:
        norm = hill_curve(prescale * white)
        if norm <= 0:
            raise ValueError(f"white={white}: the curve is {norm} at prescale * white; expected above 0")
        out = out / norm
    return (np.clip(out, 0, 1) if clamp == "yes" else out) * gain


# --------------------------------------------------------------------------------------------------
# Glow and red modifier of the ACES 1.0.3 RRT, in AP0


def saturation_of(ap0, tiny):
    """(max - min) / max with the floors `tiny` and 0.01, as (..., 1).

    >>> saturation_of(np.array([0.5, 0.25, 0.25]), 1e-10).tolist()
    [0.5]
    """
    high, low = ap0.max(-1, keepdims=True), ap0.min(-1, keepdims=True)
    return (np.maximum(high, tiny) - np.maximum(low, tiny)) / np.maximum(high, 0.01)


def glow(ap0, saturation):
    """ACES glow: saturated dark colors times up to 1.05.

    References
    ----------
    Academy, aces-dev, RRT.ctl and ACESlib.RRT_Common.ctl 1.0.3.

    >>> glow(np.array([0.02, 0.0, 0.0]), np.array([1.0])).round(12).tolist()
    [0.021, 0.0, 0.0]
    """
    r, g, b = np.moveaxis(ap0, -1, 0)[..., None]
    chroma = np.sqrt(np.maximum(b * (b - g) + g * (g - r) + r * (r - b), 0))
    yc = (b + g + r + 1.75 * chroma) / 3
    x = (saturation - 0.4) / 0.2
    t = np.maximum(1 - np.abs(x / 2), 0)
    gain = 0.05 * (1 + np.sign(x) * (1 - t * t)) / 2
    mid = 0.08
    fade = np.where(yc <= 2 / 3 * mid, 1, np.where(yc >= 2 * mid, 0, mid / np.maximum(yc, 2 / 3 * mid) - 0.5))
    return ap0 * (1 + gain * fade)


def red_modifier(ap0, saturation):
    """ACES red modifier with smoothstep(0, 1, 1 - |2 hue/135|)^2 for the B-spline: red moves to 0.03 about hue 0.

    References
    ----------
    Academy, aces-dev, RRT.ctl 1.0.3; the hue weight as Unreal Engine and Filament have it.

    >>> red_modifier(np.array([0.8, 0.0, 0.0]), np.array([1.0])).round(12).tolist()
    [0.6614, 0.0, 0.0]
    """
    r, g, b = np.moveaxis(ap0, -1, 0)[..., None]
    hue = np.degrees(np.arctan2(np.sqrt(3) * (g - b), 2 * r - g - b))  # already centered on red, (-180, 180]
    weight = smoothstep(0, 1, 1 - np.abs(2 * hue / 135)) ** 2
    red = r + weight * saturation * (0.03 - r) * (1 - 0.82)
    return np.concatenate([red, g, b], axis=-1)


def saturate(ap1, factor):
    """AP1 towards its luminance: factor 1 keeps the color, 0 is gray.

    >>> saturate(np.array([1.0, 1.0, 1.0]), 0.5).round(12).tolist()
    [1.0, 1.0, 1.0]
    """
    gray = (ap1 * AP1_WEIGHTS).sum(-1, keepdims=True)
    return gray + factor * (ap1 - gray)


def aces_filament(rgb, brightness=1.0):
    """Filament's ACES, Rec.2020 in and out: glow, red, saturation 0.96, a curve, dim surround, saturation 0.93.

    Its matrices leave out the adaptation between D65 and the ACES white, so neutrals leave slightly tinted. Not
    limited to [0, 1].

    References
    ----------
    Google, Filament (Apache-2.0), ToneMapper.cpp: ACES with brightness 1, ACESLegacy with 1/0.6. The curve is
    T. Mansencal's (colour-unity).

    >>> aces_filament([0.8, 0.1, 0.05]).round(9).tolist()
    [0.480543759, 0.059830671, 0.027653591]
    """
    to_ap1 = np.linalg.solve(rgb_to_xyz("ap1"), rgb_to_xyz("rec2020"))  # unadapted
    ap0 = limit_scene(rgb) @ to_ap1.T @ rgb_to_rgb("ap1", "ap0").T
    saturation = saturation_of(ap0, 1e-5)
    ap0 = red_modifier(glow(ap0, saturation), saturation)
    x = saturate(np.clip(ap0 @ rgb_to_rgb("ap0", "ap1").T, 0, HALF_MAX), 0.96) * brightness
    x = x * (2.785085 * x + 0.107772) / (x * (2.936045 * x + 0.887122) + 0.806889)
    light = (x * AP1_WEIGHTS).sum(-1, keepdims=True)  # Filament's floor, below 1e-5, only keeps it from 0/0
    x = np.where(light > 0, x * np.where(light > 0, light, 1) ** (0.9811 - 1), 0)
    return saturate(x, 0.93) @ np.linalg.inv(to_ap1).T


# @galacean/engine-core 1.6.13 (MIT), ColorTransform: digits as it prints them.
GALACEAN_TO_AP0 = np.array([[0.4397010, 0.3829780, 0.1773350], [0.0897923, 0.8134230, 0.0967616],
                            [0.0175440, 0.1115440, 0.8707040]])
GALACEAN_AP0_TO_AP1 = np.array([[1.4514393161, -0.2365107469, -0.2149285693], [-0.0765537734, 1.1762296998, -0.0996759264],
                                [0.0083161484, -0.0060324498, 0.9977163014]])
GALACEAN_AP1_TO_XYZ = np.array([[0.6624541811, 0.1340042065, 0.1561876870], [0.2722287168, 0.6740817658, 0.0536895174],
                                [-0.0055746495, 0.0040607335, 1.0103391003]])
GALACEAN_XYZ_TO_AP1 = np.array([[1.6410233797, -0.3248032942, -0.2364246952], [-0.6636628587, 1.6153315917, 0.0167563477],
                                [0.0117218943, -0.0082844420, 0.9883948585]])
GALACEAN_D60_TO_D65 = np.array([[0.987224, -0.00611327, 0.0159533], [-0.00759836, 1.00186, 0.00533002],
                                [0.00307257, -0.00509595, 1.08168]])
GALACEAN_XYZ_TO_709 = np.array([[3.2409699419, -1.5373831776, -0.498610760], [-0.9692436363, 1.8759675015, 0.0415550574],
                                [0.0556300797, -0.2039769589, 1.0569715142]])


def aces_galacean(rgb):
    """Glow, red, saturation 0.96, Hill's curve, dim surround, saturation 0.93, and the way to Rec.709; not limited.

    References
    ----------
    Galacean (MIT), @galacean/engine-core 1.6.13, ACESTonemap. It floors X + Y + Z and y at 1e-4; here only luminance
    below 5e-7 fades to black.

    >>> aces_galacean([0.18, 0.18, 0.18]).round(6).tolist()
    [0.110195, 0.110172, 0.11014]
    """
    weights = GALACEAN_AP1_TO_XYZ[1]

    def mixed(c, factor):
        gray = (c * weights).sum(-1, keepdims=True)
        return gray + factor * (c - gray)

    ap0 = limit_scene(rgb) @ GALACEAN_TO_AP0.T
    saturation = saturation_of(ap0, 1e-4)
    ap0 = red_modifier(glow(ap0, saturation), saturation)
    x = hill_curve(mixed(np.maximum(ap0 @ GALACEAN_AP0_TO_AP1.T, 0), 0.96))
    xyz = x @ GALACEAN_AP1_TO_XYZ.T
    y = xyz[..., 1:2]
    xyz = np.where(y > 0, xyz * np.where(y > 0, y, 1) ** (0.9811 - 1) * np.minimum(y / 5e-7, 1), 0)
    return mixed(xyz @ GALACEAN_XYZ_TO_AP1.T, 0.93) @ (GALACEAN_XYZ_TO_709 @ GALACEAN_D60_TO_D65 @ GALACEAN_AP1_TO_XYZ).T


OPERATORS = {f.__name__: f for f in (aces_narkowicz, aces_cesium, aces_hill, aces_filament, aces_galacean)}
WORKING = {"aces_filament": "rec2020"}  # operator -> working primaries, where not "rec709"
