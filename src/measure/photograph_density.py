#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes photograph_density.inc: which colors photographs and renders contain.

    /usr/bin/python3 src/measure/photograph_density.py PICTURE... > src/measure/photograph_density.inc

Each PICTURE is a scene-linear EXR or HDR file. Its colors become linear Rec.709. An environment map (twice as wide as high)
is exposed so that its log-average luminance is 0.18 (Reinhard 2002); others count as they are stored. Each picture has the
same weight, a quarter of it a stop darker and a quarter a stop brighter, because people expose differently. The numbers are counts
per million of a histogram over three axes, a tenth of them spread over neighboring bins:

    stops       log2 of the largest channel over 0.18, in steps of 0.5
    saturation  1 - smallest/largest channel, at the ends SATURATIONS; above 1: outside Rec.709
    hue         of the hexcone, in steps of 15 degrees from red through yellow

The committed numbers come from these pictures: of openexr-images, Beachball/singlepart.0001, Bonita, Cannon, Carrots, Desk,
GoldenGate, KernerEnvLatLong, MtTamWest, MultiView/Adjuster and StillLife (Bonita and KernerEnvLatLong scaled to 960 pixels); and of
the npm package @pmndrs/assets 1.7.0 (CC0), city, lab, night, park, sunset, venice and warehouse. Of 34 pictures, sorted by their share
of saturated pixels, they are one of each pair of neighbors; tests/parity/clients/test_photographs.py measures on the others.
"""

import sys

import numpy as np
import OpenImageIO as oiio

DARKEST, STEP = -13.0, 0.5
SATURATIONS = (0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97, 1, 1.1, 1.5)
HUES = 24
REC709 = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]])
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz_of(xy):
    return np.array([xy[0] / xy[1], 1, (1 - xy[0] - xy[1]) / xy[1]])


def to_xyz(ends):
    columns = np.array([[x, y, 1 - x - y] for x, y in ends[:3]]).T
    return columns * np.linalg.solve(columns, xyz_of(ends[3]))


def to_rec709(ends):
    white, wanted = BRADFORD @ xyz_of(ends[3]), BRADFORD @ xyz_of(REC709[3])
    return np.linalg.inv(to_xyz(REC709)) @ np.linalg.inv(BRADFORD) @ np.diag(wanted / white) @ BRADFORD @ to_xyz(ends)


def light_of(path):
    """(pixels, 3): linear Rec.709 without pixels of no light or no cover."""
    image = oiio.ImageBuf(path)
    spec = image.spec()
    names = list(spec.channelnames)
    pixels = image.get_pixels(oiio.FLOAT).reshape(-1, spec.nchannels).astype(float)
    color = pixels[:, [names.index(c) for c in "RGB"]] if "R" in names else pixels[:, :3]
    alpha = pixels[:, names.index("A")] if "A" in names else np.zeros(1)
    if alpha.max() > 0.5:  # files of scans have an alpha of 0
        color = color[alpha > 0.5] / alpha[alpha > 0.5, None]
    ends = spec.getattribute("chromaticities")
    if ends is not None:
        color = color @ to_rec709(np.array(ends).reshape(4, 2)).T
    color = np.clip(color[np.isfinite(color).all(1) & (color.max(1) > 0)], -65504, 65504)
    if spec.full_width == 2 * spec.full_height:
        luminance = color @ [0.2126, 0.7152, 0.0722]
        color = color * 0.18 / np.exp(np.log(luminance[luminance > 0]).mean())
    return color


def bins_of(color):
    largest, smallest = color.max(1), color.min(1)
    chroma = np.maximum(largest - smallest, 1e-30)
    r, g, b = color.T
    hue = np.where(largest == r, (g - b) / chroma % 6, np.where(largest == g, (b - r) / chroma + 2, (r - g) / chroma + 4))
    saturation = 1 - smallest / largest
    return (np.floor((np.log2(largest / 0.18) - DARKEST) / STEP).astype(int),
            np.maximum(np.searchsorted(SATURATIONS, saturation) - 1, 0), (hue * HUES / 6).astype(int) % HUES)


def spread(count, axis, sigma):
    """Blurred along an axis; the hue is a circle."""
    steps = np.arange(-3 * sigma, 3 * sigma + 1)
    weights = np.exp(-0.5 * (steps / sigma) ** 2)
    result = np.zeros_like(count)
    size = count.shape[axis]
    for step, weight in zip(steps, weights / weights.sum()):
        to = np.arange(size) + step
        to = to % size if axis == 2 else np.clip(to, 0, size - 1)
        moved = np.zeros_like(count)
        np.add.at(np.moveaxis(moved, axis, 0), to, np.moveaxis(count, axis, 0))
        result += weight * moved
    return result


def main(paths):
    count = np.zeros((56, len(SATURATIONS) - 1, HUES))
    for path in paths:
        color = light_of(path)
        for exposure, weight in ((0.5, 0.25), (1, 0.5), (2, 0.25)):
            stops, saturation, hue = bins_of(color * exposure)
            inside = (stops >= 0) & (stops < count.shape[0]) & (saturation < count.shape[1])
            np.add.at(count, (stops[inside], saturation[inside], hue[inside]), weight / len(color))
    # Other scenes have other lamps and paints: a tenth of the weight goes to neighboring colors inside Rec.709.
    inside = count[:, :SATURATIONS.index(1)]
    near = spread(spread(spread(inside, 0, 2), 1, 1), 2, 2)
    count[:, :SATURATIONS.index(1)] = 0.9 * inside + 0.1 * near
    count /= count.sum()
    million = np.round(count * 1e6).astype(int)
    print("// Written by photograph_density.py: {stops, saturation, hue, count per million}")
    bins = [f"{{{s},{t},{h},{million[s, t, h]}}}," for s, t, h in zip(*np.nonzero(million))]
    line = ""
    for text in bins:
        if len(line) + len(text) > 100:
            print(line)
            line = ""
        line += text
    print(line)


if __name__ == "__main__":
    main(sys.argv[1:])
