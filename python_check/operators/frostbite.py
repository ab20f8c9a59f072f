# SPDX-License-Identifier: Apache-2.0
"""Frostbite's hue-preserving tone mapping."""

import numpy as np

from .base import limit_scene, smoothstep
from .pq import pq_decode, pq_encode

# Rec.709 to XYZ (B. Lindbloom), to LMS with crosstalk, and to ICtCp, as the source prints them.
TO_LMS = np.array([[0.3592, 0.6976, -0.0358], [-0.1922, 1.1004, 0.0755], [0.0070, 0.0749, 0.8434]]) @ np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]])
TO_ICTCP = np.array([[0.5, 0.5, 0.0], [1.6137, -3.3234, 1.7097], [4.3780, -4.2455, -0.1325]])
UNIT = 100.0  # cd/m2 of 1.0


def to_ictcp(rgb):
    """Rec.709, 1.0 = 100 cd/m2, to ICtCp; LMS below 0 counts as 0.

    >>> to_ictcp(np.array([1.0, 1, 1])).round(6).tolist()
    [0.508076, 7e-06, 4.6e-05]
    """
    return pq_encode(UNIT * (rgb @ TO_LMS.T)) @ TO_ICTCP.T


def from_ictcp(ictcp):
    """ICtCp to Rec.709, with the inverses of the printed matrices.

    >>> from_ictcp(to_ictcp(np.array([1.0, 0.5, 0.25]))).round(9).tolist()
    [1.0, 0.5, 0.25]
    """
    return pq_decode(ictcp @ np.linalg.inv(TO_ICTCP).T) / UNIT @ np.linalg.inv(TO_LMS).T


def frostbite(rgb, linear_end=0.25):
    """Desaturated by intensity in ICtCp, compressed by largest channel (0.6) and per channel (0.4), chroma restored.

    The curve is the identity up to linear_end and 1 - exp above. May leave [0, 1] a little.

    References
    ----------
    A. Fry, "High Dynamic Range Color Grading and Display in Frostbite", GDC 2017; as mirrored by T. Stachowiak
    (Shadertoy).

    >>> frostbite([0.8, 0.1, 0.05]).round(9).tolist()
    [0.636523412, 0.092164774, 0.047135583]
    """
    e = linear_end

    def curve(v):
        return np.where(v < e, v, e + (1 - e) * (1 - np.exp(-np.maximum(v - e, 0) / (1 - e))))

    ictcp = to_ictcp(limit_scene(rgb))
    i, chroma = ictcp[..., :1], ictcp[..., 1:]
    c = from_ictcp(np.concatenate([i, chroma * smoothstep(1.0, 0.3, i) ** 1.3], axis=-1))
    peak = c.max(-1, keepdims=True)
    by_peak = c * np.where(peak < e, 1, curve(peak) / np.maximum(peak, e))
    per_channel = curve(c)
    mapped = to_ictcp(per_channel + 0.6 * (by_peak - per_channel))
    i_mapped, chroma_mapped = mapped[..., :1], mapped[..., 1:]
    boost = 0.3 * smoothstep(1.0, 0.5, i)
    restored = chroma * i_mapped / np.maximum(i, 1e-3)
    return from_ictcp(np.concatenate([i_mapped, chroma_mapped + boost * (restored - chroma_mapped)], axis=-1))


OPERATORS = {"frostbite": frostbite}
