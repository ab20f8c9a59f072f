#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the synthetic response curves of tests/data: they are not measured, so they may be distributed.

    python_check/make_synthetic_response.py [FOLDER]        (tests/data by default)

Intensity I(B) = (1 - exp(-k B^p)) / (1 - exp(-k)) at irradiance B, with k and p different for red, green and blue.

    synthetic_response.rf           256 equal distances, columns irradiance, red, green, blue
    synthetic_response_uneven.csv   64 distances that grow with the irradiance, the same columns
    synthetic_dorf.txt              DoRF's six lines a curve: three channels of one name, and one curve more
"""

import sys
from pathlib import Path

import numpy as np

CHANNELS = {"red": (3.0, 0.7), "green": (2.8, 0.75), "blue": (3.3, 0.8)}


def response(irradiance, k, p):
    """(1 - exp(-k B^p)) / (1 - exp(-k)).

    >>> response(np.array([0.0, 1.0]), 3.0, 0.7).tolist()
    [0.0, 1.0]
    """
    return (1 - np.exp(-k * irradiance**p)) / (1 - np.exp(-k))


def columns(irradiance):
    return np.stack([irradiance] + [response(irradiance, *constants) for constants in CHANNELS.values()], axis=1)


def text_of(rows, separator):
    """Irradiances as the shortest decimals that read back the same, intensities with 12 decimals."""
    return "".join(separator.join([repr(float(row[0]))] + [f"{v:.12g}" for v in row[1:]]) + "\n" for row in rows)


def remarks():
    formulas = "".join(f"#   {name:6s} k = {k}, p = {p}\n" for name, (k, p) in CHANNELS.items())
    return (
        "# SYNTHETIC: the response of no film and no camera. Written by python_check/make_synthetic_response.py.\n"
        "# intensity = (1 - exp(-k B^p)) / (1 - exp(-k)) at irradiance B\n" + formulas
    )


def dorf(irradiance):
    curves = {f"Synthetic-1{name.capitalize()}": constants for name, constants in CHANNELS.items()}
    curves["SyntheticMono"] = (2.0, 1.0)
    lines = []
    for name, (k, p) in curves.items():
        graph = f"graph of a synthetic response, (1 - exp(-{k} I^{p})) / (1 - exp(-{k}))"
        numbers = [" ".join(f"{v:.6e}" for v in values) for values in (irradiance, response(irradiance, k, p))]
        lines += [name, graph, "I =", numbers[0], "B =", numbers[1]]
    return "\n".join(lines) + "\n"


def main(folder):
    even = np.arange(256) / 255
    uneven = (np.arange(64) / 63) ** 2
    (folder / "synthetic_response.rf").write_text(remarks() + text_of(columns(even), " "))
    names = ",".join(["irradiance", *CHANNELS]) + "\n"
    (folder / "synthetic_response_uneven.csv").write_text(remarks() + names + text_of(columns(uneven), ","))
    (folder / "synthetic_dorf.txt").write_text(dorf(np.arange(32) / 31))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent / "tests" / "data")
