# SPDX-License-Identifier: Apache-2.0
"""Reinhard's curves and what others made of them.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import HALF_MAX, REC709_WEIGHTS, apply_curve, limit_scene, luminance

# Luminance in Babylon.js' tonemapPixelShader (@babylonjs/core 9.35.0) and in lygia 1.4.1.
WEIGHTS = {"rec709": REC709_WEIGHTS, "babylon": np.array([0.22, 0.707, 0.071]),
           "lygia": np.array([0.21250175, 0.71537574, 0.07212251])}


def reinhard(rgb, weights="rec709", apply="channels", **color):
    """f(x) = x / (1 + x).

    References
    ----------
    Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images", ACM TOG 21(3),
    2002, equation 3. The paper maps luminance; per channel is how most code uses it.

    >>> reinhard([0.18, 1, 4]).round(9).tolist()
    [0.152542373, 0.5, 0.8]
    """
    return apply_curve(lambda x: x / (1 + x), limit_scene(rgb), apply, weights=WEIGHTS[weights], **color)


def extended(x, white):
    """x (1 + x / white^2) / (1 + x), equation 4 of Reinhard et al. 2002.

    >>> extended(4.0, white=4.0)
    1.0
    """
    return x * (1 + x / white**2) / (1 + x)


def reinhard_extended(rgb, white=4.0, apply="channels", **color):
    """f(x) = x (1 + x / white^2) / (1 + x); f(white) = 1, unbounded above.

    References
    ----------
    Reinhard et al. 2002, equation 4. `white` (L_white) is the smallest scene value mapped to 1.

    >>> reinhard_extended([0.18, 4, 16], white=4).round(9).tolist()
    [0.154258475, 1.0, 1.882352941]
    >>> mantiuk = {"apply": "luminance", "color_correction": "luminance_preserving", "saturation": 0.6}
    >>> reinhard_extended([0.8, 0.1, 0.05], **mantiuk).round(9).tolist()
    [0.471361054, 0.128899331, 0.104437779]
    """
    return apply_curve(lambda x: extended(x, white), limit_scene(rgb), apply, **color)


def reinhard2(rgb, middle_grey=0.6, white=4.0, average=1.0, clamp="yes"):
    """Color times extended(L middle_grey / average, white), without the division by L; limited to [0, 1].

    ``clamp=no`` with white 16: three-stdlib 2.36.1, ToneMapShader.

    References
    ----------
    postprocessing 6.39.6 (Zlib), REINHARD2.

    >>> reinhard2([0.18, 0.18, 0.18]).round(6).tolist()
    [0.017664, 0.017664, 0.017664]
    """
    c = limit_scene(rgb)
    c = c * extended(luminance(c) * (middle_grey / average), white)
    return np.clip(c, 0, 1) if clamp == "yes" else c


def reinhard_jodie(rgb, weights="rec709"):
    """Blend of Reinhard on luminance, C/(1+L), and per channel, t = C/(1+C), with t as the weight.

    ``weights=lygia``: tonemapReinhardJodie of lygia 1.4.1.

    References
    ----------
    Jodie, shader "Tone mapping" (shadertoy.com/view/4dBcD1); weights 0.2126, 0.7152, 0.0722.

    >>> reinhard_jodie([0.8, 0.1, 0.05]).round(9).tolist()
    [0.55445415, 0.081271498, 0.040509354]
    """
    c = limit_scene(rgb)
    t = c / (1 + c)
    return (1 - t) * (c / (1 + luminance(c, WEIGHTS[weights]))) + t * t


def reinhard_constant_luminance(rgb):
    """C/(1+L); what a channel has above 1 goes to the other two, so that the luminance stays once it is clipped.

    With c = C/(1+L) and n = max(c - 1, 0) w / (1 - w), red becomes c_r + n_g + n_b, and so on. Not clipped here.

    References
    ----------
    The variant beside Reinhard-Jodie in the program of the 64.github.io guide to tone mapping (MIT).

    >>> reinhard_constant_luminance([0.05, 0.1, 4]).round(9).tolist()  # blue: 4 / 1.37095, 1.917684817 above 1
    [0.185702407, 0.222173467, 2.917684817]
    """
    c = limit_scene(rgb)
    c = c / (1 + luminance(c))
    excess = np.maximum(c - 1, 0) * REC709_WEIGHTS / (1 - REC709_WEIGHTS)
    return c + excess.sum(-1, keepdims=True) - excess


def nebula(rgb, middle_grey=0.6, maximum=16.0, average=0.5, apply="luminance", **color):
    """Extended Reinhard of x middle_grey / average, with `maximum` as its white; average the mean luminance.

    References
    ----------
    The post on tone mapping in the Nebula engine: with the division by the luminance, which the printed code lacks.

    >>> nebula([0.8, 0.1, 0.05]).round(9).tolist()
    [0.742593749, 0.092824219, 0.046412109]
    """
    return apply_curve(lambda x: extended(x * middle_grey / average, maximum), limit_scene(rgb), apply, **color)


def reinhard_devlin(rgb, intensity=0.0, contrast=0.6, chromatic_adaptation=0.0, light_adaptation=1.0,
                    mean_red=0.5, mean_green=0.5, mean_blue=0.5, mean_luminance=0.5):
    """C / (C + (e^-intensity Ia)^contrast), 0 at 0, with the adaptation Ia mixed from pixel and picture.

    With c and a the chromatic and the light adaptation: the pixel's Il = c C + (1-c) L, the picture's
    Ig = c mean C + (1-c) mean L, and Ia = a Il + (1-a) Ig.

    References
    ----------
    Reinhard, Devlin, "Dynamic Range Reduction Inspired by Photoreceptor Physiology", IEEE TVCG 11(1), 2005.

    >>> reinhard_devlin([0.8, 0.1, 0.05]).round(9).tolist()
    [0.650273273, 0.188589573, 0.104112006]
    >>> means = {"mean_red": 0.6, "mean_green": 0.5, "mean_blue": 0.4, "mean_luminance": 0.5}
    >>> reinhard_devlin([0.8, 0.1, 0.05], -1, 0.5, 0.3, 0.7, **means).round(9).tolist()
    [0.420501212, 0.101048205, 0.054986204]
    """
    c, a = chromatic_adaptation, light_adaptation
    rgb = limit_scene(rgb)
    local = c * rgb + (1 - c) * luminance(rgb)
    whole = c * np.array([mean_red, mean_green, mean_blue]) + (1 - c) * mean_luminance
    half = (np.exp(-intensity) * (a * local + (1 - a) * whole)) ** contrast  # input that becomes 0.5
    return np.where(rgb > 0, rgb / np.where(rgb > 0, rgb + half, 1), 0)


# Gray of OpenCV's Tonemap classes: cvtColor(RGB2GRAY) of pictures whose first channel is blue.
OPENCV_WEIGHTS = np.array([0.114, 0.587, 0.299])


def opencv_reinhard(rgb, intensity=0.0, light_adaptation=1.0, color_adaptation=0.0, minimum=0.0, maximum=1.0,
                    contrast=0.6, mean_red=0.5, mean_green=0.5, mean_blue=0.5, mean_gray=0.5, output_minimum=0.0,
                    output_maximum=0.0):
    """x / (x + (e^-intensity A)^contrast) of x = (v - minimum) / (maximum - minimum), stretched to its own range.

    A mixes pixel and picture as in reinhard_devlin; gray is 0.114 r + 0.587 g + 0.299 b. `output_maximum` 0 stands
    for the result at x = (1, 1, 1). The means are scene values.

    References
    ----------
    OpenCV 4.6.0 (Apache-2.0), photo/src/tonemap.cpp, TonemapReinhard.

    >>> opencv_reinhard([0.25, 1.0, 4.0], light_adaptation=0, maximum=4, mean_gray=1, contrast=1).round(9).tolist()
    [0.25, 0.625, 1.0]
    """
    c, a = color_adaptation, light_adaptation
    span = maximum - minimum
    if span <= 0:
        raise ValueError(f"maximum={maximum}; expected above minimum={minimum}")

    def formed(x):
        gray = luminance(x, OPENCV_WEIGHTS)
        local = c * x + (1 - c) * gray
        whole = c * (np.array([mean_red, mean_green, mean_blue]) - minimum) / span + (1 - c) * (mean_gray - minimum) / span
        half = np.maximum(np.exp(-intensity) * (a * local + (1 - a) * whole), 0) ** contrast
        return np.where(x > 0, x / np.where(x > 0, x + half, 1), 0)

    high = output_maximum if output_maximum > 0 else formed(np.ones(3)).max()
    if high <= output_minimum:
        raise ValueError(f"output_minimum={output_minimum}; expected below {high}")
    return (formed(np.clip((limit_scene(rgb) - minimum) / span, 0, HALF_MAX)) - output_minimum) / (high - output_minimum)


OPERATORS = {f.__name__: f for f in (reinhard, reinhard_extended, reinhard2, reinhard_jodie,
                                     reinhard_constant_luminance, nebula, reinhard_devlin, opencv_reinhard)}
