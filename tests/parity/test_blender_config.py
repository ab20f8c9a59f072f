# SPDX-License-Identifier: Apache-2.0
"""Blender's own OpenColorIO config against the operators that make its pictures.

    TONEWRIGHT_BLENDER_CONFIG=.../datafiles/colormanagement/config.ocio \\
        python3 -m pytest tests/parity/test_blender_config.py --tonewright build/release/bin/tonewright

Needs an OpenColorIO that can read that config: 2.5 for Blender 5.2.
"""

import os
import subprocess

import numpy as np
import pytest
from operators.pq import pq_decode
from pictures import skip

ocio = pytest.importorskip("PyOpenColorIO")

DISPLAYS = {"sRGB": "srgb", "Display P3": "display_p3", "Rec.1886": "rec1886", "Rec.2020": "rec2020",
            "Rec.2100-PQ": "rec2100_pq", "Rec.2100-HLG": "rec2100_hlg"}
LOOKS = ("Punchy", "Greyscale", "Very High Contrast", "High Contrast", "Medium High Contrast", "Base Contrast",
         "Medium Low Contrast", "Low Contrast", "Very Low Contrast")
# 1e-5 is how far OpenColorIO's sRGB operation is from IEC 61966-2-1, near 0.003 of light; the rest is float32.
BOUND = 1.4e-5
ACES_20 = 4e-5  # OpenColorIO's float32 against itself in double
# Light of code values, in units in which 12.92 times it is no more than sRGB's code: PQ, HLG and powers are infinitely
# steep at black, where errors count in light.
LIGHT = {"rec1886": lambda code: code**2.4, "rec2020": lambda code: code**2.4,
         "rec2100_pq": lambda code: pq_decode(code) / 100,
         "rec2100_hlg": lambda code: np.where(code <= 0.5, code**2 / 3, 1 / 12 + (code - 0.5) / 6)}


def colors():
    random = np.random.default_rng(5)
    grays = np.repeat(0.18 * 2.0 ** np.arange(-10, 7, 0.5)[:, None], 3, axis=1)
    return np.concatenate([grays, 2.0 ** random.uniform(-10, 6, (3000, 3)), np.eye(3), 1 - np.eye(3),
                           [[-0.1, 0.2, 3], [0, 0.18, 0.18]]]).astype(np.float32)


def error_of(code, expected, display):
    error = np.abs(code - expected)
    if display in LIGHT:
        error = np.minimum(error, 12.92 * np.abs(LIGHT[display](code) - LIGHT[display](expected)))
    return error.max(axis=1)


def ours(command, rgb, operator, display, look=""):
    lines = "\n".join(" ".join(repr(float(v)) for v in pixel) for pixel in rgb)
    done = subprocess.run([command, "eval", operator, "--display", display, "--digits", "17",
                           *(["--look", look] if look else [])],
                          input=lines, capture_output=True, text=True, check=True)
    return np.array([[float(v) for v in line.split()] for line in done.stdout.splitlines()])


def blenders(config, rgb, display, view, look=""):
    """Code values, limited to [0, 1] as a picture of them is."""
    group = ocio.GroupTransform()
    if look:
        group.appendTransform(ocio.LookTransform(src="Linear Rec.709", dst="Linear Rec.709", looks=look))
    group.appendTransform(ocio.DisplayViewTransform(src="Linear Rec.709", display=display, view=view,
                                                    looksBypass=True))
    pixels = rgb.copy()
    config.getProcessor(group).getOptimizedCPUProcessor(ocio.OPTIMIZATION_NONE).applyRGB(pixels)
    return np.clip(pixels.astype(float), 0, 1)


def test_views(report, command):
    path = os.environ.get("TONEWRIGHT_BLENDER_CONFIG", "")
    if not os.path.isfile(path):
        skip("TONEWRIGHT_BLENDER_CONFIG does not name a config of Blender")
    try:
        config = ocio.Config.CreateFromFile(path)
    except ocio.Exception as error:
        skip(f"OpenColorIO {ocio.GetVersion()}: {str(error).splitlines()[0]}")
    print(f"OpenColorIO {ocio.GetVersion()}, {config.getName() or path}")
    rgb = colors()
    jobs = [(display, "AgX", "agx_blender", "") for display in ("sRGB", "Display P3", "Rec.1886", "Rec.2020")]
    jobs += [("sRGB", "AgX", "agx_blender", look) for look in LOOKS]
    jobs += [(display, "AgX - HDR 1000 nits", "agx_blender", "") for display in ("Rec.2100-PQ", "Rec.2100-HLG")]
    jobs += [("sRGB", "ACES 1.3", "aces_13", ""), ("Display P3", "ACES 1.3", "aces_13", ""),
             ("sRGB", "ACES 2.0", "aces_20", ""), ("Display P3", "ACES 2.0", "aces_20", "")]
    for display, view, operator, look in jobs:
        mine = ours(command, rgb, operator, DISPLAYS[display], look.lower().replace(" ", "_"))
        theirs = blenders(config, rgb, display, view, f"AgX - {look}" if look else "")
        error = error_of(theirs, mine, DISPLAYS[display])
        report.bound(f"{display}, {view} {look}", error.max(), ACES_20 if operator == "aces_20" else BOUND,
                     f"at {rgb[error.argmax()]}: {theirs[error.argmax()]}, expected {mine[error.argmax()]}")
