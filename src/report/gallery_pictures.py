# SPDX-License-Identifier: Apache-2.0
"""Pictures for the gallery, in scene-linear Rec.709: what operators differ in most.

    python3 src/report/gallery_pictures.py FOLDER

Computed here, so that the gallery needs no picture of anybody else. Only the standard library is used.
"""
import math
import struct
import sys
from pathlib import Path

WIDTH, HEIGHT = 768, 432


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def write_exr(path, rows):
    """OpenEXR: half floats, one scanline in a chunk, no compression."""
    width, height = len(rows[0]), len(rows)
    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", 1, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2) + b"".join((
        attribute("channels", "chlist", channels), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    size = 8 + 3 * 2 * width
    start = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header)
        file.write(struct.pack(f"<{height}Q", *(start + y * size for y in range(height))))
        for y, row in enumerate(rows):
            file.write(struct.pack("<ii", y, size - 8))
            for channel in (2, 1, 0):
                file.write(struct.pack(f"<{width}e", *(min(max(color[channel], -65504), 65504) for color in row)))


def hue(turn):
    """A hue of Rec.709, by turns of the circle."""
    return [min(max(abs((6 * turn - 2 * c) % 6 - 3) - 1, 0), 1) for c in range(3)]


def noise(x, y):
    """Value noise: smooth, the same everywhere."""
    def at(i, j):
        n = (i * 374761393 + j * 668265263) & 0xffffffff
        n = ((n ^ n >> 13) * 1274126177) & 0xffffffff
        return (n ^ n >> 16) / 0xffffffff
    i, j = math.floor(x), math.floor(y)
    fx, fy = (t * t * (3 - 2 * t) for t in (x - i, y - j))
    low = at(i, j) + (at(i + 1, j) - at(i, j)) * fx
    high = at(i, j + 1) + (at(i + 1, j + 1) - at(i, j + 1)) * fx
    return low + (high - low) * fy


def inside(distance, radius, width):
    """1 inside of the radius, 0 outside, with a soft edge."""
    return 1 / (1 + math.exp(min((distance - radius) / width, 50)))


def hue_sweep(u, v):
    """All hues from left to right, brighter from the bottom up: 6 stops below to 10 above mid gray."""
    light = 0.18 * 2 ** (10 - 16 * v)
    return [light * c for c in hue(u)]


def tubes(u, v):
    """Tubes of saturated light in front of a wall, with their glow and a wet floor."""
    colors = [(1, 0.01, 0.02), (1, 0.25, 0), (0.05, 1, 0.03), (0, 0.6, 1), (0.02, 0.04, 1), (0.9, 0.02, 1)]
    is_floor = v > 0.78
    y = v if not is_floor else 2 * 0.78 - v
    wave = 0.008 * (noise(20 * u, 90 * v) - 0.5) if is_floor else 0
    wall = 0.05 + 0.03 * noise(40 * u, 40 * v)
    total = [0.0004] * 3
    for i, color in enumerate(colors):
        x = (i + 0.8) / (len(colors) + 0.6)
        distance = math.hypot((u + wave - x) * 16 / 9, max(0.12 - y, 0, y - 0.68))
        core = 60 * inside(distance, 0.009, 0.0008)
        glow = wall * 0.35 / (0.02 + distance) ** 1.5 * 0.12
        for c in range(3):
            total[c] += core * (color[c] + 0.02) + glow * color[c]
    return [0.25 * t for t in total] if is_floor else total


def window(u, v):
    """A room with a window: a wall in its light, patches of colors, and a sky with its sun."""
    if 0.52 < u < 0.92 and 0.12 < v < 0.7 and abs(u - 0.72) > 0.006 and abs(v - 0.41) > 0.01:
        sun = math.hypot((u - 0.83) * 16 / 9, v - 0.24)
        sky = 1 - (v - 0.12) / 0.58
        cloud = max(0, noise(14 * u, 26 * v) * 0.7 + noise(40 * u, 70 * v) * 0.3 - 0.45) * 6
        disc = 20000 * inside(sun, 0.018, 0.0011) + 0.12 / (0.03 + sun)
        hill = 0.62 + 0.04 * noise(9 * u, 1)
        if v > hill:
            return [x * (0.8 + 0.5 * noise(150 * u, 150 * v)) for x in (0.3, 0.6, 0.1)]
        return [0.7 + 1.2 * (1 - sky) + cloud + disc, 1.5 + 0.8 * (1 - sky) + cloud + 0.93 * disc, 4 - sky + cloud + 0.8 * disc]
    distance = math.hypot((u - 0.72) * 16 / 9, v - 0.41)
    light = 0.9 / (0.5 + 4 * distance * distance) * (0.96 + 0.08 * noise(120 * u, 90 * v))
    warm = [0.75, 0.68, 0.6]
    if 0.07 < u < 0.43 and 0.2 < v < 0.62:
        column, row = int((u - 0.07) / 0.06), int((v - 0.2) / 0.14)
        is_gap = (u - 0.07) % 0.06 < 0.004 or (v - 0.2) % 0.14 < 0.008
        patch = hue(column / 6) if row else [0.9 * 0.5 ** column] * 3
        share = (0, 0.55, 0.92)[row]
        if not is_gap:
            warm = [0.85 * ((1 - share) + share * c) if row else c for c in patch]
    elif v > 0.86:
        light *= 0.35
        warm = [0.4, 0.2, 0.1]
    return [0.5 * light * c for c in warm]


def embers(u, v):
    """Fire: glowing bodies from 1000 to 3500 K, in the dark."""
    swirl = noise(7 * u, 6 * v + 3 * u) * 0.6 + noise(19 * u + 3, 17 * v) * 0.3 + noise(51 * u, 47 * v) * 0.1
    shape = max(0, 1 - abs(u - 0.5 + 0.16 * (swirl - 0.5)) * (1.6 + 4.5 * (1 - v)))
    heat = max(0, swirl * 1.5 - 0.35) * shape * (0.25 + v)
    kelvin = 1000 + 2500 * min(heat * 1.6, 1)
    # Planck's law at 610, 550 and 465 nm, over white light of 3500 K.
    light = [math.exp(14388e3 / nm * (1 / 3500 - 1 / kelvin)) * 24 for nm in (610, 550, 465)]
    tint = (1, 0.55, 0.18)
    return [0.002 + amount * c * min(heat * 6, 1) for amount, c in zip(light, tint)]


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for picture in (hue_sweep, tubes, window, embers):
        rows = [[picture((x + 0.5) / WIDTH, (y + 0.5) / HEIGHT) for x in range(WIDTH)] for y in range(HEIGHT)]
        write_exr(folder / f"{picture.__name__}.exr", rows)


if __name__ == "__main__":
    main()
