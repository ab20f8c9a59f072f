# SPDX-License-Identifier: Apache-2.0
"""Film-like curves: toe, line, shoulder.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import apply_curve, limit_scene
from .reinhard import extended


def cineon(x):
    """x (6.2x + 0.5) / (x (6.2x + 1.7) + 0.06): film stock with a 2.2 power in it, for x >= 0.

    >>> cineon(0.0)
    0.0
    """
    return x * (6.2 * x + 0.5) / (x * (6.2 * x + 1.7) + 0.06)


def hejl_burgess_dawson(rgb, output="code_values", apply="channels", **color):
    """Cineon curve of max(x - 0.004, 0). Code values of a 2.2 power; with ``output=squared`` light, their square.

    Babylon.js (@babylonjs/core 9.35.0, TonemapPostProcess) squares.

    References
    ----------
    J. Hejl, R. Burgess-Dawson, in J. Hable, "Filmic Tonemapping Operators", filmicworlds.com, 2010.

    >>> hejl_burgess_dawson([0.18, 0.18, 0.18]).round(9).tolist()
    [0.508028282, 0.508028282, 0.508028282]
    """
    power, code_power = (2, None) if output == "squared" else (1, 2.2)
    return apply_curve(lambda x: cineon(np.maximum(x - 0.004, 0)) ** power, limit_scene(rgb), apply,
                       code_power=code_power, **color)


def hejl_2015_curve(x):
    """J. Hejl's curve before it is divided by the value at white; below 0 at 0.

    >>> round(hejl_2015_curve(0.0), 9)  # 0.004 / 0.0491 - 0.0821
    -0.000633605
    """
    a = 1.435 * x + 0.05
    return (x * a + 0.004) / (x * (a + 0.55) + 0.0491) - 0.0821


def hejl_2015(rgb, white=11.2, apply="channels", **color):
    """h(x) / h(white), h(x) = (x a + 0.004) / (x (a + 0.55) + 0.0491) - 0.0821, a = 1.435x + 0.05. Negative at black.

    References
    ----------
    J. Hejl, twitter.com/jimhejl/status/633777619998130176, 2015; with white in M. Pettineo's BakingLab (MIT).

    >>> hejl_2015([0, 0.18, 11.2]).round(9).tolist()
    [-0.000716199, 0.237508884, 1.0]
    """
    return apply_curve(lambda x: hejl_2015_curve(x) / hejl_2015_curve(white), limit_scene(rgb), apply, **color)


def aldridge(rgb, cutoff=0.025, apply="channels", **color):
    """Cineon curve after a softer cut: with t = 2 cutoff, x + (t - x) clamp01(t - x) 0.25 / cutoff - cutoff.

    Code values of a 2.2 power. For cutoff <= 0.5 the softer cut is (t - x)^2 / (4 cutoff) at black and never negative;
    above, max(., 0).

    References
    ----------
    G. Aldridge, "Approximating film with tonemapping", iwasbeingirony.blogspot.com, 2010.

    >>> aldridge([0.8, 0.1, 0.05]).round(9).tolist()
    [0.805934674, 0.325463744, 0.153936545]
    """
    def f(x):
        under = 2 * cutoff - x
        return cineon(np.maximum(x + under * np.clip(under, 0, 1) * (0.25 / cutoff) - cutoff, 0))

    return apply_curve(f, limit_scene(rgb), apply, code_power=2.2, **color)


def lottes(rgb, contrast=1.6, shoulder=0.977, hdr_max=8.0, mid_in=0.18, mid_out=0.267, apply="channels", **color):
    """x^a / (b x^(ad) + c), with b and c such that mid_in becomes mid_out and hdr_max 1; a contrast, d shoulder.

    Raises ValueError where no b, c > 0 do.

    References
    ----------
    T. Lottes, "Advanced Techniques and Optimization of HDR Color Pipelines", GDC 2016.

    >>> lottes([0.18, 0.8, 8]).round(9).tolist()
    [0.267, 0.756919961, 1.0]
    """
    a, ad = contrast, contrast * shoulder
    scale = (hdr_max**ad - mid_in**ad) * mid_out
    if scale <= 0:
        raise ValueError(f"lottes: hdr_max={hdr_max} with mid_in={mid_in}; expected hdr_max > mid_in")
    b = (hdr_max**a * mid_out - mid_in**a) / scale
    c = (hdr_max**ad * mid_in**a - hdr_max**a * mid_in**ad * mid_out) / scale
    if b <= 0 or c <= 0:
        raise ValueError(f"lottes: mid_in, mid_out and hdr_max give b={b}, c={c}; expected both above 0")
    return apply_curve(lambda x: x**a / (b * x**ad + c), limit_scene(rgb), apply, **color)


def filament_generic(rgb, contrast=1.55, mid_in=0.18, mid_out=0.215, hdr_max=10.0, apply="channels", **color):
    """Lottes's curve with shoulder 1: out x^contrast / (x^contrast + in), bounded by `out`.

    Raises ValueError where no in, out > 0 bring mid_in to mid_out and hdr_max to 1.

    References
    ----------
    Filament (Apache-2.0), ToneMapper.cpp, GenericToneMapper.

    >>> filament_generic([0.18, 10]).round(9).tolist()
    [0.215, 1.0]
    """
    a, b = mid_in**contrast, hdr_max**contrast
    c = a - mid_out * b
    if c >= 0 or mid_out >= 1 or a >= b:
        raise ValueError(f"filament_generic: mid_in={mid_in}, mid_out={mid_out}, hdr_max={hdr_max}; expected "
                         "(mid_in / hdr_max)^contrast < mid_out < 1 and mid_in < hdr_max")
    scale_in, scale_out = a * b * (mid_out - 1) / c, mid_out * (a - b) / c
    return apply_curve(lambda x: x**contrast * scale_out / (x**contrast + scale_in), limit_scene(rgb), apply, **color)


def ue3(rgb, apply="channels", **color):
    """1.019 x / (x + 0.155), then limited to [0, 1]. Code values of a 2.2 power.

    References
    ----------
    Unreal Engine 3 documentation, "Color grading", through R. Guy's shader; the "Unreal" of BruOp's article.

    >>> ue3([0.18, 0.8, 16]).round(9).tolist()
    [0.547522388, 0.853612565, 1.0]
    """
    out = apply_curve(lambda x: 1.019 * x / (x + 0.155), limit_scene(rgb), apply, code_power=2.2, **color)
    return np.clip(out, 0, 1)


def day(rgb, white=10.0, black=0.1, toe=0.7, shoulder=0.8, crossover=2.0, average=1.0, apply="channels", **color):
    """Two hyperbolas that meet at `crossover` with one slope: 0 at black, 1 at white.

    Of x / average, average the mean luminance. Negative below black. Raises ValueError unless
    black < crossover < white.

    References
    ----------
    M. Day (Insomniac), "An Efficient and User-Friendly Tone Mapping Operator", 2012.

    >>> day([0.1, 0.8, 4]).round(9).tolist()
    [0.0, 0.039121482, 0.723502304]
    """
    if not black < crossover < white:
        raise ValueError(f"day: black={black}, crossover={crossover}, white={white}; expected them to rise")
    b, t, c, s, w = black, toe, crossover, shoulder, white
    low, high = (1 - t) * (c - b), (1 - s) * (w - c)
    k = low / (high + low)  # output at the crossover

    def f(x):
        x = x / average
        under, over = np.minimum(x, c), np.maximum(x, c)
        return np.where(x < c, k * (1 - t) * (under - b) / (c - (1 - t) * b - t * under),
                        (1 - k) * (over - c) / (s * over + (1 - s) * w - c) + k)

    return apply_curve(f, limit_scene(rgb), apply, **color)


def schlick(rgb, p=20.0, maximum=100.0, apply="luminance", **color):
    """p x / (p x - x + maximum): the largest luminance becomes 1.

    References
    ----------
    C. Schlick, "Quantization Techniques for Visualization of High Dynamic Range Pictures", EG Rendering Workshop 1994.

    >>> schlick([0.8, 0.1, 0.05]).round(9).tolist()
    [0.152877455, 0.019109682, 0.009554841]
    """
    return apply_curve(lambda x: p * x / (p * x - x + maximum), limit_scene(rgb), apply, **color)


def toe(rgb, form="quadratic", width=0.05, strength=1.0, brightness=0.0, contrast=1.0, white=4.0, apply="channels",
        **color):
    """Two toes known from a description only, then (y - 0.5) contrast + 0.5 + brightness.

    ``quadratic``, with t = width, k = strength: (1-k) x + k x^2 (2t - x) / t^2 below t, x above. ``ramp``, with
    p = width, d = strength: extended Reinhard y with `white`, then y - d y clamp01(1 - y/p).

    References
    ----------
    Madams, "Why Reinhard desaturates my blacks", imdoingitwrong.wordpress.com, 2010: "TFU2" and "God of War III"
    are described there without formulas; these are Tonewright's.

    >>> toe([0.025, 0.05, 4]).round(9).tolist()  # 0.025^2 0.075 / 0.0025
    [0.01875, 0.05, 4.0]
    >>> toe([0.1, 0.25, 4], form="ramp", width=0.25, strength=0.5).round(9).tolist()
    [0.062474819, 0.184082031, 1.0]
    """
    def f(x):
        if form == "quadratic":
            low = np.minimum(x, width)
            y = np.where(x < width, (1 - strength) * low + strength * low**2 * (2 * width - low) / width**2, x)
        else:
            y = extended(x, white)
            y = y - strength * y * np.clip(1 - y / width, 0, 1)
        return (y - 0.5) * contrast + 0.5 + brightness

    return apply_curve(f, limit_scene(rgb), apply, **color)


OPERATORS = {f.__name__: f for f in (hejl_burgess_dawson, hejl_2015, aldridge, lottes, filament_generic, ue3, day,
                                     schlick, toe)}
CODE_POWER = {"hejl_burgess_dawson": 2.2, "aldridge": 2.2, "ue3": 2.2}
DECODE = {"hejl_burgess_dawson": lambda output="code_values", **_: (
    lambda code: code**(1 if output == "squared" else CODE_POWER["hejl_burgess_dawson"]))}
