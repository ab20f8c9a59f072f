# SPDX-License-Identifier: Apache-2.0
"""Khronos PBR Neutral and Filament's divergent copy."""

import numpy as np

from .base import limit_scene


def compress(rgb, start_compression, desaturation, aim):
    """The common part; `aim` is what bright colors desaturate to, None for their own new peak."""
    c = limit_scene(rgb)
    start = start_compression - 0.04
    low = c.min(-1, keepdims=True)
    c = c - np.where(low < 0.08, low - 6.25 * low * low, 0.04)  # takes the Fresnel reflection of 0.04 away
    peak = np.maximum(c.max(-1, keepdims=True), start)
    d = 1 - start
    new_peak = 1 - d * d / (peak + d - start)
    compressed = c * (new_peak / peak)
    g = 1 - 1 / (desaturation * (peak - new_peak) + 1)
    mixed = compressed + g * ((new_peak if aim is None else aim) - compressed)
    return np.where(c.max(-1, keepdims=True) < start, c, mixed)


def khronos_neutral(rgb, start_compression=0.8, desaturation=0.15):
    """Base colors stay as they are; above start_compression - 0.04 the peak is compressed and desaturates to itself.

    References
    ----------
    Khronos Group, "PBR Neutral Tone Mapper" (KhronosGroup/ToneMapping), 2024.

    >>> khronos_neutral([0.8, 0.1, 0.05]).round(9).tolist()
    [0.765496183, 0.065627482, 0.01563686]
    """
    return compress(rgb, start_compression, desaturation, None)


def khronos_neutral_filament(rgb, start_compression=0.8, desaturation=0.15):
    """Khronos PBR Neutral, but bright colors desaturate to 1 instead of their new peak.

    References
    ----------
    Google, Filament (Apache-2.0), ToneMapper.cpp: PBRNeutralToneMapper.

    >>> khronos_neutral_filament([0.18, 0.18, 0.18]).round(9).tolist()
    [0.14, 0.14, 0.14]
    """
    return compress(rgb, start_compression, desaturation, 1.0)


def khronos_neutral_needle(rgb):
    """Colors below 0.8 stay; above, the peak is compressed and mixed towards 1 by the light beyond 0.8 of all channels.

    References
    ----------
    Needle Engine, @needle-tools/engine 4.16.5, engine_tonemapping.ts: model-viewer's first commerce tone mapper
    (github.com/google/model-viewer/pull/4495).

    >>> khronos_neutral_needle([2.0, 1.0, 0.5]).round(6).tolist()
    [0.978836, 0.619048, 0.439153]
    """
    c = limit_scene(rgb)
    largest = c.max(-1, keepdims=True)
    peak = np.maximum(largest, 0.8)
    brightness = c.sum(-1, keepdims=True) * (1 - 0.8 / peak)
    kept = 3 / (0.5 * brightness + 3)
    return np.where(largest < 0.8, c, c * (1 - 0.04 / (peak - 0.6)) / peak * kept + 1 - kept)


OPERATORS = {f.__name__: f for f in (khronos_neutral, khronos_neutral_filament, khronos_neutral_needle)}
