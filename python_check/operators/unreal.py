# SPDX-License-Identifier: Apache-2.0
"""Unreal Engine's filmic tone mapper since 4.15."""

import numpy as np

from .aces import glow, red_modifier, saturate, saturation_of
from .base import limit_scene, smoothstep
from .spaces import rgb_to_rgb

BLACK = 1e-30  # floor before the logarithm; there the toe is at -black_clip


def unreal_curve(x, slope=0.88, toe=0.55, shoulder=0.26, black_clip=0.0, white_clip=0.04):
    """Toe and shoulder as logistic functions of log10(x), a straight line between them, smoothly joined.

    0.18 stays 0.18. With the defaults the toe's end lies above the shoulder's begin, and the blend runs backwards.

    >>> unreal_curve(np.array([0.0, 0.18, 1.0, 16.0])).round(9).tolist()
    [0.0, 0.18, 0.723359457, 1.014184869]
    """
    gray = np.log10(0.18)
    toe_scale, shoulder_scale = 1 + black_clip - toe, 1 + white_clip - shoulder
    if toe > 0.8:
        toe_end = (1 - toe - 0.18) / slope + gray
    else:
        b = (0.18 + black_clip) / toe_scale - 1
        toe_end = gray - 0.5 * np.log((1 + b) / (1 - b)) * toe_scale / slope
    straight_shift = (1 - toe) / slope - toe_end
    shoulder_begin = shoulder / slope - straight_shift

    def logistic(scale, u):  # 2 scale / (1 + exp(2 slope/scale u)); a scale of 0 leaves 0
        with np.errstate(over="ignore"):  # exp -> inf, the quotient -> 0
            return 2 * scale / (1 + np.exp(2 * slope / scale * u)) if scale > 0 else 0 * u

    log = np.log10(np.maximum(x, BLACK))
    straight = slope * (log + straight_shift)
    low = np.where(log < toe_end, logistic(toe_scale, toe_end - log) - black_clip, straight)
    high = np.where(log > shoulder_begin, 1 + white_clip - logistic(shoulder_scale, log - shoulder_begin), straight)
    # Upwards from whichever comes first: the source takes 1 - t where the shoulder begins below the toe's end.
    begin, end = sorted((toe_end, shoulder_begin))
    blend = smoothstep(begin, end, log) if begin < end else np.where(log > begin, 1, 0)
    return low + blend * (high - low)


def unreal(rgb, slope=0.88, toe=0.55, shoulder=0.26, black_clip=0.0, white_clip=0.04, glow_and_red="on"):
    """AP1 in and out: glow and red modifier in AP0, saturation 0.96, the curve, saturation 0.93; limited at 0 below.

    Without the blue correction, gamut expansion and tone curve amount of the engine's grading pass.

    References
    ----------
    Unreal Engine documentation, "Color Grading and the Filmic Tonemapper"; the formulas are facts of TonemapCommon.

    >>> unreal([0.8, 0.1, 0.05]).round(9).tolist()
    [0.582348314, 0.100701155, 0.045250903]
    """
    ap1 = limit_scene(rgb)
    if glow_and_red == "on":
        ap0 = ap1 @ rgb_to_rgb("ap1", "ap0").T
        saturation = saturation_of(ap0, 1e-10)
        ap1 = red_modifier(glow(ap0, saturation), saturation) @ rgb_to_rgb("ap0", "ap1").T
    x = unreal_curve(saturate(np.maximum(ap1, 0), 0.96), slope, toe, shoulder, black_clip, white_clip)
    return np.maximum(saturate(x, 0.93), 0)


OPERATORS = {"unreal": unreal}
WORKING = {"unreal": "ap1"}
