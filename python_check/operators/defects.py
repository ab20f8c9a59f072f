# SPDX-License-Identifier: Apache-2.0
"""Mistakes of public programs, from those programs' own text. `tonewright verify --lut` recognizes them.

No name of the command line finds them, so `check_operators.py` cannot run them; the rows of `operators.csv` test them.
"""

import numpy as np

from .aces import HILL_IN, HILL_OUT, hill_curve
from .agx import AGX_INSET, AGX_LOG2, AGX_POLYNOMIALS
from .base import limit_scene, luminance
from .hable import hable_curve
from .reinhard import extended


def agx_minimal_clamped(rgb):
    """AgX (Wrensch) with the light limited to 1 before the logarithm. Code values of a 2.2 power.

    Below the shaper's lower end, where the source leaves the polynomial's range (black is NaN), that end.

    References
    ----------
    matiaszanolli/ByroRedux, presentation.frag since commit c5663fe39; issue 4578, whose figures these are:

    >>> (agx_minimal_clamped(np.repeat([[0.5], [1.0], [1.5], [16.0]], 3, 1)) ** 2.2)[:, 1].round(2).tolist()
    [0.43, 0.59, 0.59, 0.59]
    """
    low, high = AGX_LOG2
    light = np.clip(limit_scene(rgb) @ AGX_INSET.T, 2.0**low, 1)
    n = (np.log2(light) - low) / (high - low)
    return np.polyval(AGX_POLYNOMIALS[6], n) @ np.linalg.inv(AGX_INSET).T


def agx_matrix_and_power(rgb):
    """Light limited to [0, 1], a matrix, the power 1.35, called AgX; display-linear.

    References
    ----------
    fernandotonon/QtMeshEditor, commit 251f723f, src/HDR/HdrTonemap.cpp: tonemapAgx.

    >>> agx_matrix_and_power([1.0, 1, 1]).round(6).tolist()
    [0.290256, 1.0, 1.0]
    """
    matrix = np.array([[0.224282, 0.130789, 0.044929], [0.050223, 0.873461, 0.076316], [0.020833, 0.080745, 0.898422]])
    return np.clip((np.clip(limit_scene(rgb), 0, 1) @ matrix.T) ** 1.35, 0, 1)


def aces_hill_misplaced_bracket(rgb):
    """S. Hill's fit as in three.js, with a bracket of the denominator at another place.

    References
    ----------
    three.js, commit 0a0cd97338d377a1f28c0e62cfe0defa0aaebcc4, src/nodes/display/ToneMappingFunctions.js.

    >>> aces_hill_misplaced_bracket([1.0, 1, 1]).round(6).tolist()
    [0.765833, 0.765833, 0.765825]
    """
    v = limit_scene(rgb) / 0.6 @ HILL_IN.T
    fitted = (v * (v + 0.0245786) - 0.000090537) / (v * ((v + 0.4329510) * 0.983729) + 0.238081)
    return np.clip(fitted @ HILL_OUT.T, 0, 1)


def aces_hill_misprinted_product(rgb):
    """S. Hill's fit with a product of matrix and vector that reads v[1] for v[0] in rows 2 and 3.

    References
    ----------
    64.github.io/tonemapping before commit 936048c ("fix matrix multiplication in tonemapping post"): mul.

    >>> aces_hill_misprinted_product([0.8, 0.1, 0.05]).round(4).tolist()
    [0.5946, 0.0421, 0.0158]
    """
    def mul(m, v):
        return np.stack([m[0][0] * v[..., 0] + m[0][1] * v[..., 1] + m[0][2] * v[..., 2],
                         m[1][0] * v[..., 1] + m[1][1] * v[..., 1] + m[1][2] * v[..., 2],
                         m[2][0] * v[..., 1] + m[2][1] * v[..., 1] + m[2][2] * v[..., 2]], -1)

    return mul(HILL_OUT, hill_curve(mul(HILL_IN, limit_scene(rgb))))


def uchimura_misprinted(rgb):
    """H. Uchimura's curve with l0 = ((P - m) / l) / a, limited to [0, 1].

    References
    ----------
    tizian/tonemapper, pull request 3 as first proposed: gran_turismo.h, with its default parameters.

    >>> uchimura_misprinted([0.1, 0.5, 4.0]).round(6).tolist()
    [0.086988, 0.5, 1.0]
    """
    x = limit_scene(rgb)
    p, a, m, l, c, b = 1.0, 1.0, 0.22, 0.4, 1.33, 0.0
    l0 = ((p - m) / l) / a
    s0, s1 = m + l0, m + a * l0
    toe = m * (x / m) ** c + b
    line = m + a * (x - m)
    with np.errstate(over="ignore"):  # infinite light is limited to 1
        shoulder = p - (p - s1) * np.exp(-(a * p / (p - s1)) * (np.maximum(x, s0) - s0) / p)
    t = np.clip(x / m, 0, 1)
    w_toe = 1 - t * t * (3 - 2 * t)
    return np.clip(np.where(x < s0, toe * w_toe + line * (1 - w_toe), shoulder), 0, 1)


def nebula_as_printed(rgb):
    """Reinhard's equation 4 of the scaled luminance times the color, without the division by the luminance.

    References
    ----------
    The post on tone mapping in the Nebula engine, with its parameters: middle gray 0.6, average 0.5, white 16.

    >>> nebula_as_printed([0.8, 0.1, 0.05]).round(9).tolist()
    [0.182091413, 0.022761427, 0.011380713]
    """
    c = limit_scene(rgb)
    return c * extended(luminance(c) * 0.6 / 0.5, 16.0)


def hable_bias_on_result(rgb):
    """J. Hable's curve with the exposure bias as a factor on the result, limited to [0, 1].

    References
    ----------
    tizian/tonemapper, commit 5215acc3, src/operators/HableFilmicOperator.cpp.

    >>> hable_bias_on_result([0.18, 1, 4]).round(6).tolist()
    [0.13422, 0.608601, 1.0]
    """
    return np.clip(2 * hable_curve(limit_scene(rgb)) / hable_curve(11.2), 0, 1)


OPERATORS = {f.__name__: f for f in (agx_minimal_clamped, agx_matrix_and_power, aces_hill_misplaced_bracket,
                                     aces_hill_misprinted_product, uchimura_misprinted, nebula_as_printed,
                                     hable_bias_on_result)}
CODE_POWER = {"agx_minimal_clamped": 2.2}
