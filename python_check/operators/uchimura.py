# SPDX-License-Identifier: Apache-2.0
"""H. Uchimura's curve of Gran Turismo.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import apply_curve, limit_scene, smoothstep


def uchimura(rgb, max_brightness=1.0, contrast=1.0, linear_start=0.22, linear_length=0.4,
             black_tightness=1.33, pedestal=0.0, apply="channels", **color):
    """Toe m(x/m)^c + b, line m + a(x-m) and exponential shoulder to P, blended; range [b, P].

    Parameters are the paper's P, a, m, l, c, b in this order; m, a > 0 and l < 1.

    References
    ----------
    H. Uchimura, "HDR Theory and Practice", CEDEC 2017; curve: desmos.com/calculator/gslcdxvipg.

    >>> uchimura([0.18, 1, 4]).round(9).tolist()
    [0.178994806, 0.827832422, 0.999716853]
    """
    p, a, m, l, c, b = max_brightness, contrast, linear_start, linear_length, black_tightness, pedestal
    l0 = (p - m) * l / a
    s0, s1 = m + l0, m + a * l0  # where the line ends: input, output

    def f(x):
        toe = m * (x / m) ** c + b
        line = m + a * (x - m)
        shoulder = p - (p - s1) * np.exp(-(a * p / (p - s1)) * (np.maximum(x, s0) - s0) / p)
        w_toe = 1 - smoothstep(0, m, x)
        w_shoulder = np.where(x >= s0, 1.0, 0.0)
        return toe * w_toe + line * (1 - w_toe - w_shoulder) + shoulder * w_shoulder

    return apply_curve(f, limit_scene(rgb), apply, **color)


OPERATORS = {f.__name__: f for f in (uchimura,)}
PEAK = {"uchimura": lambda max_brightness=1.0, **_: max_brightness}
FROM_DISPLAY = {"uchimura": {"max_brightness": lambda display: display.peak / 100}}
