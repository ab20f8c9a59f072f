# SPDX-License-Identifier: Apache-2.0
"""The tone mapping of Gran Turismo 7."""

import numpy as np

from .base import limit_scene, smoothstep
from .pq import pq_decode, pq_encode

TO_LMS = np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096  # ITU-R BT.2100-2, table 7
TO_ICTCP = np.array([[2048, 2048, 0], [6610, -13613, 7003], [17933, -17390, -543]]) / 4096
# The inverses as the source prints them, six digits: grays leave with a tint of 1e-6.
FROM_ICTCP = np.array([[1, 0.00860904, 0.11103], [1, -0.00860904, -0.11103], [1, 0.560031, -0.320627]])
FROM_LMS = np.array([[3.43661, -2.50645, 0.0698454], [-0.79133, 1.9836, -0.192271],
                     [-0.0259499, -0.0989137, 1.12486]])
UNIT = 100.0  # cd/m2 of scene-linear and display-linear 1


def to_ictcp(rgb):
    """Rec.2020, 1.0 = 100 cd/m2, to ICtCp.

    >>> to_ictcp(np.array([1.0, 1, 1])).round(9).tolist()
    [0.508078422, 0.0, 0.0]
    """
    return pq_encode(UNIT * (rgb @ TO_LMS.T)) @ TO_ICTCP.T


def from_ictcp(ictcp):
    """ICtCp to Rec.2020, 1.0 = 100 cd/m2, not below 0.

    >>> from_ictcp(to_ictcp(np.array([1.0, 1, 1]))).round(6).tolist()
    [1.000005, 0.999999, 0.999996]
    """
    # The source's PQ takes codes in [0, 1] only.
    return np.maximum(pq_decode(np.clip(ictcp @ FROM_ICTCP.T, 0, 1)) / UNIT @ FROM_LMS.T, 0)


def gt7_curve(x, target, alpha=0.25, mid=0.538, linear=0.444, toe=1.28):
    """Power toe faded into the identity at `mid`, and an exponential shoulder from linear * target on.

    The shoulder's limit is 1.18533 target; it passes the target at 1.4717 target.

    >>> gt7_curve(np.array([0.0, 0.18, 1.0]), 2.5).round(9).tolist()
    [0.0, 0.144873953, 1.0]
    """
    k = (linear - 1) / (alpha - 1)
    w = smoothstep(0, mid, x)
    below = (1 - w) * mid * (x / mid) ** toe + w * x
    shoulder = target * (linear + k) - target * k * np.exp(linear / k - x / (k * target))
    return np.where(x < linear * target, below, shoulder)


def gt7(rgb, output="sdr", peak=1000.0):
    """The curve per channel ("skewed"), mixed 0.4 : 0.6 with a color of its ICtCp intensity and the input's chroma.

    Chroma fades out about the target's intensity. Rec.2020 in and out, 1.0 in = 100 cd/m2. ``sdr`` maps to 250 cd/m2
    and puts out 1 for it; ``hdr`` maps to `peak` and puts out units of 100 cd/m2.

    References
    ----------
    Polyphony Digital, "Driving Toward Reality: Physically Based Tone Mapping and Perceptual Fidelity in Gran
    Turismo 7", SIGGRAPH 2025 course; gt7_tone_mapping.cpp 1.0 (MIT), with ICtCp.

    >>> gt7([0.8, 0.1, 0.05]).round(9).tolist()
    [0.304075357, 0.031957147, 0.014812903]
    """
    target = 250 / UNIT if output == "sdr" else peak / UNIT
    c = limit_scene(rgb)
    ictcp = to_ictcp(c)
    skewed = gt7_curve(c, target)
    chroma = 1 - smoothstep(0.98, 1.16, ictcp[..., :1] / to_ictcp(np.full(3, target))[0])
    scaled = np.concatenate([to_ictcp(skewed)[..., :1], ictcp[..., 1:] * chroma], axis=-1)
    out = np.minimum(0.4 * skewed + 0.6 * from_ictcp(scaled), target)
    return out / target if output == "sdr" else out


OPERATORS = {"gt7": gt7}
WORKING = {"gt7": "rec2020"}
PEAK = {"gt7": lambda output="sdr", peak=1000.0: peak / UNIT if output == "hdr" else 1.0}
FROM_DISPLAY = {"gt7": {"output": lambda display: "hdr" if display.is_hdr else "sdr",
                        "peak": lambda display: max(display.peak, 250.0) if display.is_hdr else 1000.0}}
