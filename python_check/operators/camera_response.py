# SPDX-License-Identifier: Apache-2.0
"""Film and camera response curves, the built-in synthetic one or one from a file."""

import re
from pathlib import Path

import numpy as np

from .base import limit_scene

CHANNELS = ("red", "green", "blue")
ENDINGS = (("Red", "Green", "Blue"), ("R", "G", "B"))  # of the names of one film's channels in DoRF


def synthetic_curve():
    """The built-in curve, invented for this project: irradiance i/1023 and (1 - exp(-3 B^0.7)) / (1 - exp(-3)).

    >>> irradiance, response = synthetic_curve()
    >>> len(irradiance), float(response[-1])
    (1024, 1.0)
    """
    irradiance = np.arange(1024) / 1023
    return irradiance, (1 - np.exp(-3 * irradiance**0.7)) / (1 - np.exp(-3))


def read_dorf(lines):
    """DoRF's text layout, name -> (irradiance, response): six lines a curve, "I =" and "B =" before the numbers.

    >>> read_dorf(["slideRed", "graph", "I =", "0 0.5 1", "B =", "0 0.75 1"])["slideRed"][1].tolist()
    [0.0, 0.75, 1.0]
    """
    lines = [line.strip() for line in lines if line.strip()]
    if len(lines) % 6:
        raise ValueError(f"{len(lines)} lines; expected six for each curve")
    curves = {}
    for name, _, i, irradiance, b, response in zip(*(lines[k::6] for k in range(6))):
        if not (re.fullmatch(r"I\s*=", i) and re.fullmatch(r"B\s*=", b)):
            raise ValueError(f"curve {name}: lines {i!r} and {b!r}; expected 'I =' and 'B ='")
        curves[name] = tuple(np.array(numbers.split(), float) for numbers in (irradiance, response))
    return curves


def read_columns(lines):
    """.rf or CSV: columns irradiance and one or three responses; # begins a comment, CSV may have a line of names.

    >>> read_columns(["# film", "0 0", "1 1"]).tolist()
    [[0.0, 0.0], [1.0, 1.0]]
    """
    rows = [re.split(r"[\s,;]+", line.strip()) for line in (text.split("#")[0] for text in lines) if line.strip()]
    try:
        [float(v) for v in rows[0]]
    except ValueError:
        rows = rows[1:]  # names of the columns
    table = np.array(rows, float)
    if table.shape[1] not in (2, 4):
        raise ValueError(f"{table.shape[1]} columns; expected 2 or 4")
    return table


def read_curves(file, curve=""):
    """[(irradiance, response)] of red, green and blue.

    With columns, `curve` may name the one that serves all channels: red, green or blue. In DoRF's text it is
    a curve's name, or the name without its ending Red, Green, Blue (R, G, B) when there are all three; it may be
    empty when the file holds nothing else.
    """
    lines = Path(file).read_text(encoding="utf-8-sig").splitlines()
    if any(re.fullmatch(r"\s*I\s*=\s*", line) for line in lines):
        curves = read_dorf(lines)
        choices = {name: [name] * 3 for name in curves}
        for name in curves:
            for ends in ENDINGS:
                trio = [name.removesuffix(ends[0]) + end for end in ends]
                if trio[0] == name and all(channel in curves for channel in trio):
                    choices[name.removesuffix(ends[0])] = trio
        if not curve:
            whole = [c for c in choices if not any(c in trio for other, trio in choices.items() if other != c)]
            if len(whole) != 1:
                raise ValueError(f"{file}: {len(curves)} curves; expected curve=NAME")
            curve = whole[0]
        if curve not in choices:
            raise ValueError(f"{file}: no curve {curve}")
        result = [curves[name] for name in choices[curve]]
    else:
        table = read_columns(lines)
        columns = [1, 1, 1] if table.shape[1] == 2 else [1, 2, 3]
        if curve:
            if table.shape[1] == 2 or curve not in CHANNELS:
                raise ValueError(f"{file}: curve={curve}; expected red, green or blue, of a file with four columns")
            columns = [1 + CHANNELS.index(curve)] * 3
        result = [(table[:, 0], table[:, k]) for k in columns]
    for irradiance, response in result:
        if len(irradiance) < 2 or len(irradiance) != len(response) or (np.diff(irradiance) < 0).any():
            raise ValueError(f"{file}: expected two or more samples whose irradiance does not fall")
    # Of samples at one irradiance the last counts: a response is continuous, and a table may stutter.
    keep = [np.append(np.diff(irradiance) > 0, True) for irradiance, _ in result]
    return [(irradiance[k], response[k]) for (irradiance, response), k in zip(result, keep)]


def camera_response(rgb, file="", curve="", iso=6.0):
    """Response of each channel's curve to its value / iso, straight lines between the samples. Code values.

    Values above `iso` give the last response. The segment is the one with B_k <= x < B_(k+1). Without a file:
    synthetic_curve for all channels.

    References
    ----------
    M. Grossberg, S. Nayar, "What is the Space of Camera Response Functions?", CVPR 2003: the DoRF database; 64,
    "Tone Mapping" (64.github.io): iso.

    >>> camera_response([0.0, 1.0, 8.0]).round(9).tolist()
    [0.0, 0.60522435, 1.0]
    """
    curves = read_curves(file, curve) if file else [synthetic_curve()] * 3
    x = np.clip(limit_scene(rgb), 0, iso) / iso
    out = [np.where(x[..., k] > b[0], np.interp(x[..., k], b, i), i[0]) for k, (b, i) in enumerate(curves)]
    return np.stack(out, axis=-1)


OPERATORS = {"camera_response": camera_response}
CODE_POWER = {"camera_response": 2.2}  # a picture's pixel values, taken as those of a 2.2 power
