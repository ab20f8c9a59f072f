# SPDX-License-Identifier: Apache-2.0
"""Curves from one display's range of luminance into a smaller one, in cd/m2 of Rec.2020.

`common` stands for the settings of map_range, and `color` for those of apply_curve beside `apply`.
"""

import numpy as np

from .base import REC2020_WEIGHTS, apply_curve, limit_scene, smoothstep
from .pq import positive, pq_decode, pq_encode


def limit(x, low, high):
    """np.clip by the real part, so that curves can be differentiated by a complex step.

    >>> limit(np.array([-1.0, 0.5, 2.0]), 0, 1).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.where(x.real < low, low, np.where(x.real > high, high, x))


def lerp(a, b, t):
    """a at t = 0, b at t = 1.

    >>> lerp(2, 4, 0.25)
    2.5
    """
    return a + t * (b - a)


def map_range(curve, rgb, source_peak=1000.0, target_peak=100.0, source_black=0.0, target_black=0.0,
              reference_white=100.0, output="sdr", apply="channels", **color):
    """Scene-linear -> cd/m2 within the source's range -> curve -> cd/m2 within the target's range -> 1.0 = its peak.

    With ``output=hdr``, 1.0 = 100 cd/m2.

    `curve` gets (cd/m2, source_black, source_peak, target_black, target_peak). When the source's peak is not above
    the target's, only the limits remain.

    >>> map_range(None, [0.5, 5.0], source_peak=100.0).tolist()
    [0.5, 1.0]
    """
    if source_black >= source_peak or target_black >= target_peak:
        raise ValueError("black at or above the peak; expected below it")

    def f(x):
        nits = limit(x * reference_white, source_black, source_peak)
        nits = curve(nits, source_black, source_peak, target_black, target_peak) if source_peak > target_peak else (
            limit(nits, 0, target_peak))
        unit = 100 if output == "hdr" else target_peak
        return limit(nits, target_black, np.inf) / unit  # a lifted black may lift the peak as well

    return apply_curve(f, limit_scene(rgb), apply=apply, weights=REC2020_WEIGHTS, **color)


def bt2390(rgb, knee_offset=0.5, black_lift="report", **common):
    """PQ code relative to the source's range: identity up to a knee, a Hermite spline to the target's peak, black lift.

    The knee is at (1 + o) max - o of the target's largest code, o = knee_offset. ``black_lift=report`` adds
    min (1 - E)^4; ``libplacebo`` adds min (1 - E)^p with p = 1/min up to 4, and scales in turn.

    References
    ----------
    Report ITU-R BT.2390-11, 5.4; libplacebo, tone_mapping.c (the facts of its formula): offset 1.

    >>> (100 * bt2390([0.18, 0.5, 1.0])).round(9).tolist()
    [18.0, 46.142954755, 69.454403036]
    """

    def curve(nits, source_black, source_peak, target_black, target_peak):
        low, span = pq_encode(np.float64(source_black)), pq_encode(np.float64(source_peak))
        span = span - low
        least, most = ((pq_encode(np.float64(v)) - low) / span for v in (target_black, target_peak))
        e = (pq_encode(nits) - low) / span
        knee = (1 + knee_offset) * most - knee_offset
        t = (e - knee) / (1 - knee)
        spline = ((2 * t**3 - 3 * t**2 + 1) * knee + (t**3 - 2 * t**2 + t) * (1 - knee) + (3 * t**2 - 2 * t**3) * most)
        e = np.where(e.real < knee, e, spline)
        if black_lift == "report":
            e = e + least * positive(1 - e) ** 4
        else:
            p = min(1 / least, 4) if least > 0 else 4
            gain = 1 / (1 + least / most * (1 - most) ** p)
            e = gain * (e + least * positive(1 - e) ** p - least) + least
        return pq_decode(e * span + low)

    return map_range(curve, rgb, **common)


def bt2446a(rgb, **common):
    """A power of 1/2.4, a logarithm, three pieces about the knee, and back: method A of the Report, its curve alone.

    The pieces miss each other by 1e-4 at their joints, as printed.

    References
    ----------
    Report ITU-R BT.2446-1, 4.2; the black level as libplacebo has it.

    >>> (100 * bt2446a([0.18, 0.5, 1.0])).round(8).tolist()
    [5.25011362, 12.64842069, 22.66341554]
    """

    def rho(peak):
        return 1 + 32 * (peak / 10000) ** (1 / 2.4)

    def curve(nits, source_black, source_peak, target_black, target_peak):
        y = (positive(nits - source_black) / (source_peak - source_black)) ** (1 / 2.4)
        y = np.log(1 + (rho(source_peak) - 1) * y) / np.log(rho(source_peak))
        middle = -1.1510 * y**2 + 2.7811 * y - 0.6302
        y = np.where(y.real <= 0.7399, 1.0770 * y, np.where(y.real < 0.9909, middle, 0.5 * y + 0.5))
        y = (rho(target_peak) ** y - 1) / (rho(target_peak) - 1)
        low, high = target_black ** (1 / 2.4), target_peak ** (1 / 2.4)
        return positive(low + y * (high - low)) ** 2.4

    return map_range(curve, rgb, **common)


def spline(rgb, contrast=0.5, average=0.0, apply="luminance", **common):
    """A quadratic and a cubic in PQ that meet at the picture's average with the same slope.

    `average` is the scene's average in cd/m2; 0, unknown, takes 0.4 of the source's range. `contrast` 0 gives the
    pivot the slope of the darks, 1 a slope of 1.

    References
    ----------
    libplacebo, tone_mapping.c, its default `spline` (the facts of its formula, knee adaptation 0.4).

    libplacebo puts the curve on I of an IPT. `apply` is luminance, because that comes closer than channels.

    >>> (100 * spline([0.18, 0.5, 1.0], apply="channels")).round(8).tolist()
    [10.52697221, 23.4649935, 36.15717847]
    """

    def curve(nits, source_black, source_peak, target_black, target_peak):
        smin, smax, dmin, dmax = (pq_encode(np.float64(v))
                                  for v in (source_black, source_peak, target_black, target_peak))
        src = pq_encode(np.float64(average)) if average > 0 else lerp(smin, smax, 0.4)
        src = np.clip(src, lerp(smin, smax, 0.1), lerp(smin, smax, 0.8))
        place = (src - smin) / (smax - smin)
        tuning = 1 - smoothstep(0.8, 0.4, place) * smoothstep(0.1, 0.4, place)
        dst = lerp(src, lerp(dmin, dmax, place), lerp(0.4, 1, tuning))
        dst = np.clip(dst, lerp(dmin, dmax, 0.1), lerp(dmin, dmax, 0.8))
        ratio = np.clip(1.5 * (smax / dmax - 1), 0.2, 1.2)
        slope = ((dst - dmin) / (src - smin)) ** ((1 - contrast) * ratio)
        x, low, high = pq_encode(nits) - src, smin - src, smax - src
        pa = (dmin - dst - slope * low) / low**2
        qa = (slope * high - (dmax - dst)) / (2 * high**3)
        qb = -3 * (slope * high - (dmax - dst)) / (2 * high**2)
        y = np.where(x.real <= 0, (pa * x + slope) * x, ((qa * x + qb) * x + slope) * x)
        return pq_decode(limit(y + dst, dmin, dmax))

    return map_range(curve, rgb, apply=apply, **common)


OPERATORS = {f.__name__: f for f in (bt2390, bt2446a, spline)}
WORKING = {name: "rec2020" for name in OPERATORS}
PEAK = {name: lambda target_peak=100.0, output="sdr", **_: target_peak / 100 if output == "hdr" else 1.0
        for name in OPERATORS}
FROM_DISPLAY = {name: {"target_peak": lambda display: display.peak,
                       "output": lambda display: "hdr" if display.is_hdr else "sdr"} for name in OPERATORS}
