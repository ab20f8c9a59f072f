# SPDX-License-Identifier: Apache-2.0
"""Lookup table files, and what is between their nodes: linear, trilinear and tetrahedral, in float64."""

import re

import numpy as np


def read_cube(path):
    """(table, lines of text): (n, 3) for a 1D file, (blue, green, red, 3) for a cube. The domain has to be 0..1."""
    lines = path.read_text().splitlines()
    keys = {line.split()[0]: line.split()[1:] for line in lines if re.match("[A-Z]", line)}
    for key, expected in (("DOMAIN_MIN", 0), ("DOMAIN_MAX", 1)):
        if any(float(v) != expected for v in keys.get(key, [])):
            raise ValueError(f"{path.name}: {key} is {keys[key]}; programs agree about no other domain than 0..1")
    is_row = [bool(re.match("[-0-9.]", line)) for line in lines]
    table = np.array([line.split() for line, row in zip(lines, is_row) if row], float)
    if "LUT_3D_SIZE" in keys:
        n = int(keys["LUT_3D_SIZE"][0])
        table = table.reshape(n, n, n, 3)
    return table, [line for line, row in zip(lines, is_row) if not row]


def stated_errors(lines):
    """{interpolation: (max, 99.9 %, mean)} of the comments of a file."""
    pattern = r"Error .*, (\w+) interpolation,.* max ([^,]+), 99.9 % ([^,]+), mean (\S+)"
    found = [match.groups() for match in map(re.compile(pattern).search, lines) if match]
    return {name: tuple(map(float, figures)) for name, *figures in found}


def hald_cube(pixels):
    """The nodes of a Hald CLUT, (height, width, 3), as (blue, green, red, 3)."""
    nodes = np.asarray(pixels, float).reshape(-1, 3)
    n = round(len(nodes) ** (1 / 3))
    return nodes.reshape(n, n, n, 3)


def strip_cube(pixels):
    """The nodes of a strip, n slices of n x n side by side, as (blue, green, red, 3): red to the right, green down."""
    n = len(pixels)
    return np.asarray(pixels, float).reshape(n, n, n, 3).transpose(1, 0, 2, 3)


def cell_of(table, code):
    """(the node below, the place in its cell in 0..1) of (n, 3) codes, red first."""
    at = np.clip(code, 0, 1) * (len(table) - 1)
    corner = np.minimum(at.astype(int), len(table) - 2)
    return corner, at - corner


def tetrahedral(table, code):
    """A cube at (n, 3) codes: the six tetrahedra are the six orders of the fractions, largest first."""
    corner, fraction = cell_of(table, code)
    order = np.argsort(-fraction, axis=1, kind="stable")
    sorted_fraction = np.take_along_axis(fraction, order, axis=1)
    weights = -np.diff(sorted_fraction, axis=1, prepend=1, append=0)
    out = np.zeros((len(code), 3))
    for step in range(4):
        if step:
            corner[np.arange(len(code)), order[:, step - 1]] += 1
        out += weights[:, step, None] * table[corner[:, 2], corner[:, 1], corner[:, 0]]
    return out


def trilinear(table, code):
    corner, fraction = cell_of(table, code)
    out = np.zeros((len(code), 3))
    for step in np.ndindex(2, 2, 2):
        weight = np.where(step, fraction, 1 - fraction).prod(axis=1)
        r, g, b = (corner + step).T
        out += weight[:, None] * table[b, g, r]
    return out


def linear(table, code):
    """A 1D table at (n, 3) codes."""
    n = len(table)
    return np.stack([np.interp(code[:, c], np.arange(n) / (n - 1), table[:, c]) for c in range(3)], axis=1)
