# SPDX-License-Identifier: Apache-2.0
"""The local operators in NumPy, from their definitions (the comments at the head of src/local/*.cpp) and in double: what
`tonewright apply --display linear -d float` shows is held to them, on small pictures of all shapes.

    python3 python_check/local_operators.py build/release/bin/tonewright

With TONEWRIGHT_SHARED, this file itself is held to the check values of reference/check_values.json. The last line is
`N passed, M failed`.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "parity" / "clients"))
from pictures import Report, read_rgb, run, share_of, write_exr  # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


# --------------------------------------------------------------------------------------------------
# Reinhard, Stark, Shirley, Ferwerda 2002


def gaussian_matrix(size, reach):
    """Row i holds the weights of exp(-d^2/reach^2) about pixel i, renormalized inside the picture."""
    radius = int(np.ceil(3 * reach / np.sqrt(2)))
    d = np.arange(size)[:, None] - np.arange(size)
    weights = np.where(abs(d) <= radius, np.exp(-(d / reach) ** 2), 0)
    return weights / weights.sum(axis=1, keepdims=True)


def reinhard_local(rgb, key=0.18, log_average=0, sharpening=8, threshold=0.05, scales=8, white=0, exposure=1):
    """A list of pictures: where a scale passes or fails by less than rounding, either is right."""
    luminance = rgb @ LUMINANCE
    average = log_average or np.exp(np.log(1e-3 + luminance).mean())
    scaled = key * exposure / average * luminance
    sizes = 1.6 ** np.arange(scales + 1)
    blurred = []
    for s in sizes:
        down, across = (gaussian_matrix(n, s / (2 * np.sqrt(2))) for n in scaled.shape)
        blurred.append(down @ scaled @ across.T)
    pictures = []
    for doubt in (-1e-5, 0, 1e-5):
        adapted, passes = blurred[0].copy(), np.ones(scaled.shape, bool)
        for k in range(scales):
            activity = abs(blurred[k] - blurred[k + 1]) / (2**sharpening * key / sizes[k] ** 2 + blurred[k])
            passes &= activity < threshold + doubt
            adapted[passes] = blurred[k][passes]
        factor = key * exposure / average / (1 + adapted) * (1 + (scaled / white**2 if white else 0))
        pictures.append(rgb * factor[..., None])
    return pictures


# --------------------------------------------------------------------------------------------------
# Wronski 2022


def aces_hill(rgb):
    """The fit as three.js has it."""
    v = rgb / 0.6 @ np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]]).T
    v = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    v = v @ np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]]).T
    return np.clip(v, 0, 1)


def texture(plane, v, u):
    """Bilinear, at texel coordinates of each axis, clamped at the edges."""
    def taps(x, n):
        i = np.floor(x)
        return np.clip(i, 0, n - 1).astype(int), np.clip(i + 1, 0, n - 1).astype(int), x - i
    (y0, y1, fy), (x0, x1, fx) = taps(v, plane.shape[0]), taps(u, plane.shape[1])
    fy = fy.reshape((-1,) + (1,) * (plane.ndim - 1))
    fx = fx.reshape((1, -1) + (1,) * (plane.ndim - 2))
    rows = plane[y0] * (1 - fy) + plane[y1] * fy
    return rows[:, x0] * (1 - fx) + rows[:, x1] * fx


def centers(count, size):
    return (np.arange(count) + 0.5) / count * size - 0.5


def resample(plane, height, width):
    return texture(plane, centers(height, plane.shape[0]), centers(width, plane.shape[1]))


def exposure_fusion(rgb, exposure=0.7, shadows=1.5, highlights=2, sigma=5, mip=6, display_mip=2,
                    boost_local_contrast="no"):
    light = rgb * exposure
    if shadows == 0 and highlights == 0:
        return [aces_hill(light)]
    weights_of_channels = np.array([0.1, 0.7, 0.2])
    e = np.stack([np.sqrt(aces_hill(light * 2.0**s) @ weights_of_channels) for s in (-highlights, 0, shadows)], -1)
    w = np.exp(-0.5 * (e - 0.5) ** 2 * sigma**2)
    w = w / (w.sum(-1, keepdims=True) + 1e-5)
    levels = [(e, w)]
    while min(levels[-1][0].shape[:2]) // 2 > 1:
        size = [n // 2 for n in levels[-1][0].shape[:2]]
        levels.append(tuple(resample(p, *size) for p in levels[-1]))
    mip = min(mip, len(levels) - 1)
    display_mip = min(display_mip, mip)
    e, w = levels[mip]
    fused = (e * w).sum(-1) / (w.sum(-1) + 1e-4)
    for k in range(mip - 1, display_mip - 1, -1):
        e, w = levels[k]
        laplacian = e - resample(levels[k + 1][0], *e.shape[:2])
        q = w * (abs(laplacian) + 1e-5) if boost_local_contrast == "yes" else w
        q = q / (q.sum(-1, keepdims=True) + 1e-5)
        fused = resample(fused, *e.shape[:2]) + (q * laplacian).sum(-1)
    guide = levels[display_mip][0][..., 1]
    v, u = (centers(n, m) for n, m in zip(rgb.shape[:2], guide.shape))
    total = x = y = xx = xy = 0
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            weight = np.exp(-0.5 * (dx * dx + dy * dy) / 0.49)
            a, b = texture(guide, v + dy, u + dx), texture(fused, v + dy, u + dx)
            total += weight
            x, y, xx, xy = x + weight * a, y + weight * b, xx + weight * a * a, xy + weight * a * b
    x, y, xx, xy = x / total, y / total, xx / total, xy / total
    slope = (xy - x * y) / (np.maximum(xx - x * x, 0) + 1e-5)
    lightness = np.sqrt(aces_hill(light)) @ weights_of_channels + 1e-5
    factor = np.maximum(slope * lightness + y - slope * x, 0) / lightness
    factor = np.where(lightness < 0.007, 1 + (factor - 1) * (lightness / 0.007) ** 2, factor)
    return [aces_hill(light * factor[..., None])]


# --------------------------------------------------------------------------------------------------
# Paris, Hasinoff, Kautz 2011; Aubry et al. 2014


def along(axis, function, plane, *arguments):
    return np.moveaxis(function(np.moveaxis(plane, axis, 0), *arguments), 0, axis)


def reduce_axis(plane):
    p = np.concatenate([plane[:1], plane[:1], plane, plane[-1:], plane[-1:]])
    return ((p[:-4] + p[4:] + 4 * (p[1:-3] + p[3:-1]) + 6 * p[2:-2]) / 16)[::2]


def expand_axis(plane, count):
    p = np.concatenate([plane[:1], plane, plane[-1:]])
    fine = np.empty((2 * len(plane),) + plane.shape[1:])
    fine[::2] = (p[:-2] + 6 * p[1:-1] + p[2:]) / 8
    fine[1::2] = (p[1:-1] + p[2:]) / 2
    return fine[:count]


def gaussian_pyramid(plane):
    levels = [plane]
    while max(levels[-1].shape) > 1:
        levels.append(along(1, reduce_axis, along(0, reduce_axis, levels[-1])))
    return levels


def expand(plane, shape):
    return along(1, expand_axis, along(0, expand_axis, plane, shape[0]), shape[1])


def percentile(stops, part):
    """The middle of the bin of 1/64 stop that this part of the values lies up to."""
    if not len(stops):
        return 0
    bins = np.sort(np.floor((stops + 64) * 64))
    return (bins[int(np.ceil(part * len(bins))) - 1] + 0.5) / 64 - 64


def local_laplacian(rgb, contrast=7.5, base=0.25, detail=1, threshold=1.3, saturation=0.8):
    """A list of pictures: a value at the edge of a bin may lie in either."""
    luminance = rgb @ LUMINANCE
    if not luminance.any():
        return [np.zeros_like(rgb)]
    stops = np.log2(np.maximum(luminance, luminance.max() * 2.0**-24))
    guide = gaussian_pyramid(stops)
    steps = int(np.ceil(np.float32(np.ptp(stops)) / np.float32(threshold)))
    step = np.ptp(stops) / steps if steps else 1
    result = [np.zeros_like(level) for level in guide]
    for reference in stops.min() + step * np.arange(steps + 1):
        d = stops - reference
        remapped = gaussian_pyramid(reference + base * d + (detail - base) * d / np.sqrt(1 + (d / threshold) ** 2))
        for k in range(len(guide) - 1):
            near = np.maximum(1 - abs(guide[k] - reference) / step, 0)
            result[k] += near * (remapped[k] - expand(remapped[k + 1], guide[k].shape))
    shown = guide[-1]
    for level in result[-2::-1]:
        shown = level + expand(shown, level.shape)
    pictures = []
    for doubt in (0, -1e-4, 1e-4):
        lit = shown[luminance > 0] + doubt
        white = percentile(lit, 0.995)
        distance = white - percentile(lit, 0.005)
        slope = contrast / distance if distance > contrast else 1
        with np.errstate(invalid="ignore", divide="ignore"):
            chromaticity = saturation * rgb / luminance[..., None] + 1 - saturation
        out = 2 ** (slope * (shown - white))[..., None] * chromaticity
        pictures.append(np.where(luminance[..., None] > 0, out, 0))
    return pictures


# --------------------------------------------------------------------------------------------------

OPERATORS = {
    "reinhard_local": (reinhard_local, [{}, {"key": 0.72, "sharpening": 4, "threshold": 0.2}, {"white": 3, "scales": 3},
                                        {"log_average": 0.5, "scales": 10}]),
    "exposure_fusion": (exposure_fusion, [{}, {"boost_local_contrast": "yes", "sigma": 9}, {"display_mip": 0, "mip": 3},
                                          {"shadows": 0, "highlights": 0}, {"mip": 0, "shadows": 4}]),
    "local_laplacian": (local_laplacian, [{}, {"contrast": 3, "base": 0, "detail": 2}, {"threshold": 0.4, "base": 0.7},
                                          {"saturation": 1, "contrast": 20}]),
}
# Of the value, with a floor of 1e-2: floats on the way. Exposure fusion divides by variances of 1e-5, and light may be
# the quotient of two small numbers. The filter adds 24 stops in floats: 24 * 2^-24 * ln 2 is 1e-6, for each of some 20
# references and levels.
BOUND = {"reinhard_local": 2e-6, "exposure_fusion": 2e-4, "local_laplacian": 5e-5}


def scene(height, width, seed=1):
    """Log-uniform blobs and noise over 14 stops, saturated colors, black."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    stops = 5 * np.sin(x / 7 + seed) * np.cos(y / 5) + rng.normal(0, 0.3, (height, width)) + 2 * (x > width // 2)
    rgb = 0.18 * 2.0 ** stops[..., None] * rng.uniform(0.05, 1, (height, width, 3)) ** 2
    rgb[rng.uniform(size=(height, width)) < 0.02] = 0
    return rgb.astype(np.float32).astype(float)


def checker(height, width, square, low, high):
    picture = np.full((height, width, 3), low, float)
    picture[square] = high
    return picture


def fusion_picture():
    """For the check values."""
    y, x = np.mgrid[:64, :64]
    v = 0.02 * 2 ** (8 * x / 63)
    rgb = np.stack([v, 0.8 * v, v * (0.3 + 0.7 * y / 63)], -1)
    rgb[16:32, 16:32] *= 8
    return rgb


def check_values(report):
    """This file, held to the numbers of others."""
    shared = os.environ.get("TONEWRIGHT_SHARED")
    path = Path(shared or "") / "reference" / "check_values.json"
    if not shared or not path.is_file():
        print(f"without check values: {path} is no file")
        return
    square = np.s_[32:48, 32:48]
    shown = {"reinhard_local": reinhard_local(checker(64, 64, square, 0.1, 10))[1],
             "exposure_fusion": exposure_fusion(fusion_picture())[0]}
    for row in json.loads(path.read_text()):
        if row["operator"] in shown:
            y, x = row["params"]["pixel_row_col"]
            report.bound(f"{row['operator']} at {y}, {x}", abs(shown[row["operator"]][y, x] - row["output"]).max(), 1e-11)


def main(command):
    report = Report()
    check_values(report)
    pictures = {f"{w} x {h}": scene(h, w) for w, h in
                [(1, 1), (1, 9), (23, 1), (2, 2), (7, 5), (33, 64), (150, 97), (1100, 40)]}
    pictures["a square"] = checker(64, 64, np.s_[32:48, 32:48], 0.1, 10)
    pictures["black"] = np.zeros((6, 4, 3))
    pictures["uniform"] = np.full((12, 31, 3), [0.4, 0.1, 2.0])
    with tempfile.TemporaryDirectory() as folder:
        source, result = f"{folder}/in.exr", f"{folder}/out.exr"
        for name, rgb in share_of(pictures.items(), 2):
            rgb = rgb.astype(np.float32).astype(float)
            write_exr(source, {c: rgb[..., i] for i, c in enumerate("RGB")})
            for op, (function, settings) in OPERATORS.items():
                for setting in settings if name in ("7 x 5", "150 x 97", "a square") else [{}]:
                    given = [x for k, v in setting.items() for x in ("--set", f"{k}={v}")]
                    run(command, "apply", source, result, "--operator", op, *given, "--display", "linear", "-d", "float")
                    shown = read_rgb(result, folder)
                    errors = [abs(shown - e) / np.maximum(abs(e), 1e-2) for e in function(rgb, **setting)]
                    # Pixel by pixel for Reinhard's scales, all at once for the others' pictures.
                    error = np.min(errors, axis=0).max() if op == "reinhard_local" else min(e.max() for e in errors)
                    report.bound(f"{name}: {op} {setting or ''}", error, BOUND[op])
    return report.finish()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    sys.exit(main(parser.parse_args().command))
