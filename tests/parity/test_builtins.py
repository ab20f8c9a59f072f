# SPDX-License-Identifier: Apache-2.0
"""OpenColorIO's built-in ACES output transforms against the operators that they equal.

    python3 -m pytest tests/parity/test_builtins.py --tonewright build/release/bin/tonewright

Compared are the ones that the PyOpenColorIO of this Python has: those of ACES 1 from 2.1 on, those of ACES 2 from 2.4
on. Light of the limiting primaries and code values: sRGB's for SDR, PQ's for HDR.
"""

import re
import subprocess

import numpy as np
import pytest
from operators.pq import pq_encode
from operators.spaces import rgb_to_xyz, srgb_encode

ocio = pytest.importorskip("PyOpenColorIO")

STYLE = "ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - "

# (operator, settings, primaries that its native output is in, the style's name). aces_13 adapts its HDR forms to D65
# and puts them out in Rec.2020.
FORMS = [("aces_13", f"output={output};limit={limit}", "rec2020" if is_hdr else primaries, name + version)
         for output, name, is_hdr in (("sdr_video", "SDR-VIDEO", False), ("sdr_cinema", "SDR-CINEMA", False),
                                      ("hdr_1000", "HDR-VIDEO-1000nit-15nit", True),
                                      ("hdr_2000", "HDR-VIDEO-2000nit-15nit", True),
                                      ("hdr_4000", "HDR-VIDEO-4000nit-15nit", True),
                                      ("hdr_cinema", "HDR-CINEMA-108nit-7.2nit", True))
         for limit, primaries, version in (("rec709", "rec709", "-REC709lim_1.1"), ("p3d65", "p3d65", "-P3lim_1.1"),
                                           ("rec2020", "rec2020", "-REC2020lim_1.1"))]
FORMS += [("aces_20", f"peak={peak};limit={limit}", limit, f"{'SDR' if peak == 100 else 'HDR'}-{peak}nit-{name}_2.0")
          for peak in (100, 500, 1000, 2000, 4000)
          for limit, name in (("rec709", "REC709"), ("p3d65", "P3-D65"), ("rec2020", "REC2020"))]

# aces_13: float32 residue. Where one channel is bright and another nearly 0, OpenColorIO's AP0 -> AP1 in float32
# leaves 5e-6 of the bright one in it.
# aces_20: OpenColorIO's float32 differs from its own code in double by up to 3e-5 on random AP1 colors (p99.9
# 1.1e-5 to 1.9e-5).
BOUNDS = {"aces_13": {"p99.9": 1e-5, "max": 6e-5}, "aces_20": {"p99.9": 2e-5, "max": 4e-5}}


def colors():
    """ACES2065-1: grays, log-uniform colors of Rec.709, of AP1, and some beyond."""
    random = np.random.default_rng(11)
    grays = np.repeat(2.0 ** np.arange(-12, 9.01, 0.25)[:, None], 3, axis=1) * 0.18
    log = 2.0 ** random.uniform(-10, 7, (2, 6000, 3))
    log[:, ::10, 0] = 0
    to_ap0 = {name: np.linalg.solve(rgb_to_xyz("ap0"), adapted(name)) for name in ("rec709", "ap1")}
    beyond = log[0, :300] * random.uniform(-0.05, 1, (300, 3))
    return np.concatenate([grays, log[0] @ to_ap0["rec709"].T, log[1] @ to_ap0["ap1"].T, beyond]).astype(np.float32)


def adapted(primaries):
    """RGB -> XYZ under the ACES white: colors to test with, so von Kries on XYZ will do."""
    to_xyz = rgb_to_xyz(primaries)
    white = rgb_to_xyz("ap0") @ np.ones(3)
    return np.diag(white / (to_xyz @ np.ones(3))) @ to_xyz


def evaluate(command, operator, settings, rgb):
    lines = "\n".join(" ".join(repr(float(v)) for v in pixel) for pixel in rgb)
    options = [o for s in settings.split(";") for o in ("--set", s)]
    done = subprocess.run([command, "eval", operator, *options, "--input", "lin_ap0", "--display", "native",
                           "--digits", "17"], input=lines, capture_output=True, text=True, check=True)
    return np.array([[float(v) for v in line.split()] for line in done.stdout.splitlines()])


def built_in(style, primaries, rgb):
    transform = ocio.BuiltinTransform(style=style)
    config = ocio.Config.CreateRaw()
    cpu = config.getProcessor(transform).getOptimizedCPUProcessor(ocio.OPTIMIZATION_NONE)
    xyz = rgb.copy()
    cpu.applyRGB(xyz)
    return np.linalg.solve(rgb_to_xyz(primaries), xyz.astype(float).T).T


def error_of(light, expected, peak):
    """Of each color the worst channel's: of sRGB's code values for SDR, of PQ's or of light in units of the peak,
    whichever is less, for HDR: PQ is infinitely steep at black."""
    if peak == 1:
        return np.abs(srgb_encode(np.clip(light, 0, 1)) - srgb_encode(np.clip(expected, 0, 1))).max(axis=1)
    code = np.abs(pq_encode(100 * light) - pq_encode(100 * expected))
    return np.minimum(code, np.abs(light - expected) / peak).max(axis=1)


def test_built_in(report, command):
    known = set(ocio.BuiltinTransformRegistry())
    print(f"OpenColorIO {ocio.GetVersion()}")
    rgb = colors()
    for operator, settings, primaries, name in FORMS:
        if STYLE + name not in known:
            continue
        light = evaluate(command, operator, settings, rgb)
        peak = int(re.search(r"(\d+)nit", name).group(1)) / 100 if "HDR" in name else 1
        error = error_of(built_in(STYLE + name, primaries, rgb), light, peak)
        bounds = BOUNDS[operator]
        report.bound(f"{name} 99.9 %", np.quantile(error, 0.999), bounds["p99.9"])
        worst = int(error.argmax())
        report.check(f"{name} max {error[worst]:.2g}, bound {bounds['max']:.2g}", error[worst] <= bounds["max"],
                     f"at ACES2065-1 {rgb[worst]}")
    report.check("some are known", report.passed + report.failed > 10)
