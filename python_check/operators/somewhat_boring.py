# SPDX-License-Identifier: Apache-2.0
"""The Somewhat Boring Display Transform."""

import numpy as np

from .base import limit_scene

TO_YCBCR = np.array([[0.2126, 0.7152, 0.0722], [-0.1146, -0.3854, 0.5], [0.5, -0.4542, -0.0458]])


def somewhat_boring(rgb):
    """1 - exp(-x) of the luminance and, after desaturation, per channel; the more colorful, the more of the latter.

    References
    ----------
    T. Stachowiak, in Bevy (MIT or Apache-2.0), tonemapping_shared.wgsl: somewhat_boring_display_transform.

    >>> somewhat_boring([1.0, 1, 1]).round(9).tolist()
    [0.613156942, 0.613156942, 0.613156942]
    """

    def curve(v):
        return 1 - np.exp(-v)

    c = limit_scene(rgb)
    ycbcr = c @ TO_YCBCR.T
    y = ycbcr[..., :1]
    colorful = curve(2.4 * np.hypot(ycbcr[..., 1:2], ycbcr[..., 2:]))
    desaturation = np.maximum(0.8 * (colorful - 0.7), 0) ** 2
    by_luminance = c * curve(y) / np.maximum(1e-5, y)
    per_channel = curve(c + desaturation * (y - c))
    return 0.97 * (by_luminance + colorful**2 * (per_channel - by_luminance))


OPERATORS = {"somewhat_boring": somewhat_boring}
