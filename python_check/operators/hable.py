# SPDX-License-Identifier: Apache-2.0
"""J. Hable's curves.

`color` stands for the settings of apply_curve beside `apply`: color_correction, saturation, saturation_from.
"""

import numpy as np

from .base import apply_curve, limit_scene


def hable_curve(x, a=0.15, b=0.50, c=0.10, d=0.20, e=0.02, f=0.30):
    """(x(Ax + CB) + DE) / (x(Ax + B) + DF) - E/F: Uncharted 2 before it is divided by the value at white.

    >>> round(hable_curve(11.2), 9)
    0.725129378
    """
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f


def hable(rgb, shoulder_strength=0.15, linear_strength=0.50, linear_angle=0.10, toe_strength=0.20,
          toe_numerator=0.02, toe_denominator=0.30, white=11.2, exposure_bias=2.0, apply="channels", **color):
    """h(exposure_bias x) / h(white), h(x) = (x(Ax + CB) + DE) / (x(Ax + B) + DF) - E/F.

    The white is not scaled by the bias, as in the author's code: 1 is reached at x = white / exposure_bias.

    References
    ----------
    J. Hable, "Uncharted 2: HDR Lighting", GDC 2010, and "Filmic Tonemapping Operators", filmicworlds.com, 2010:
    A..F in the order of the parameters, W = white.

    >>> hable([0.18, 1, 5.6]).round(9).tolist()
    [0.128338449, 0.492918546, 1.0]
    """
    constants = (shoulder_strength, linear_strength, linear_angle, toe_strength, toe_numerator, toe_denominator)
    return apply_curve(lambda x: hable_curve(exposure_bias * x, *constants) / hable_curve(white, *constants),
                       limit_scene(rgb), apply, **color)


def hable_gdc(rgb, white=11.2, exposure_bias=1.0, black=0.0, apply="channels", **color):
    """Hable's curve with A 0.22, B 0.30, C 0.10, D 0.20, E 0.01, F 0.30, without a bias.

    ``black`` is subtracted from the scene value after the bias: 0.004 in PlayCanvas 2.23.3 (TONEMAP_HEJL), which
    multiplies the curve by 1.25, as this does with a white where it is 0.8.

    References
    ----------
    J. Hable, "Uncharted 2: HDR Lighting", GDC 2010, slides.

    >>> hable_gdc([0.18, 1, 11.2]).round(9).tolist()  # 0.18: (0.014528 / 0.121128 - 1/30) / 0.867301
    [0.099856784, 0.462526102, 1.0]
    """
    constants = (0.22, 0.30, 0.10, 0.20, 0.01, 0.30)

    def f(x):
        x = exposure_bias * x - black
        return hable_curve(np.where(x.real > 0, x, 0), *constants) / hable_curve(white, *constants)

    return apply_curve(f, limit_scene(rgb), apply, **color)


def hable_piecewise(rgb, toe_strength=0.0, toe_length=0.5, shoulder_strength=0.0, shoulder_length=0.5,
                    shoulder_angle=0.0, gamma=1.0, max_brightness=1.0, apply="channels", **color):
    """Toe and shoulder of power curves about a straight line; `gamma` is baked in. Without a toe or shoulder, x.

    Where the toe ends, (x0, y0), and the shoulder starts, (x1, y1), value and slope are those of the line. The
    shoulder heads for a point beyond (1, 1) when it has strength and angle, and all is scaled to be 1 at the white,
    which lies 2^shoulder_strength - 1 beyond the end of the line; above it the shoulder goes on to its own end.
    A display `max_brightness` times as bright as white has the same curve, that much larger both ways.

    References
    ----------
    J. Hable, "Filmic Tonemapping with Piecewise Power Curves", filmicworlds.com, 2017, and github.com/johnhable/
    fw-public (CC0). toe_length is raised to 2.2; shoulder_strength is in stops.

    >>> film = {"toe_strength": 0.5, "shoulder_strength": 2, "shoulder_angle": 1}
    >>> hable_piecewise([0.05, 0.18, 10], **film).round(9).tolist()
    [0.006077882, 0.066451285, 1.058090902]
    """
    # Corners before gamma; x in units of the white from `/ white` on.
    x0 = toe_length**2.2 / 2
    y0 = (1 - toe_strength) * x0
    rest = 1 - y0
    straight = (1 - shoulder_length) * rest
    white = x0 + rest + 2**shoulder_strength - 1
    x0, x1, y1 = x0 / white, (x0 + straight) / white, y0 + straight
    slope = (y1 - y0) / (x1 - x0) if x1 > x0 else 1.0
    offset = y0 - x0 * slope
    over_x = 2 * shoulder_angle * shoulder_strength
    over_y = (1 + 0.5 * shoulder_angle * shoulder_strength) ** gamma - 1

    # Slopes and heights at the corners after gamma. With toe_strength 1 the height is 0 and, for gamma < 1, the slope
    # infinite: 1e-300 gives the same toe, which is 0 up to its corner.
    slope0, slope1 = (gamma * slope * max(slope * x + offset, 1e-300) ** (gamma - 1) for x in (x0, x1))
    y0, y1 = max(1e-5, y0**gamma), max(1e-5, y1**gamma)
    run, rise = 1 + over_x - x1, 1 + over_y - y1

    def power(base, exponent):  # 0 at 0 and below
        positive = base > 0
        return np.where(positive, np.exp(exponent * np.log(np.where(positive, base, 1))), 0)

    def shoulder(x):
        return 1 + over_y - rise * power((1 + over_x - x) / run, slope1 * run / rise)

    def f(x):
        x = x / max_brightness / white
        toe = y0 * power(np.minimum(x, x0) / x0, slope0 * x0 / y0) if x0 > 0 else 0
        line = power(slope * np.clip(x, x0, x1) + offset, gamma)
        y = np.where(x < x0, toe, np.where(x < x1, line, shoulder(np.maximum(x, x1)))) / shoulder(1.0)
        return max_brightness * y

    return apply_curve(f, limit_scene(rgb), apply, **color)


OPERATORS = {f.__name__: f for f in (hable, hable_gdc, hable_piecewise)}
PEAK = {"hable_piecewise": lambda max_brightness=1.0, **_: max_brightness}
FROM_DISPLAY = {"hable_piecewise": {"max_brightness": lambda display: display.peak / 100}}
