# SPDX-License-Identifier: Apache-2.0
"""ociochecklut with LUTs of `tonewright bake`, color by color, on its CPU and its GPU path.

    python3 -m pytest tests/parity/clients/test_ociochecklut.py --tonewright build/release/bin/tonewright
"""

import os
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from lut_client import FLOAT32, OPERATOR, Client
from lut_tables import read_cube, tetrahedral
from pictures import evaluate, log2_decode, screen

# It prints seven digits.
PRINTED = FLOAT32 + 1e-6
COUNT = 40


def through_ociochecklut(lut, codes, *options, environment=None):
    def one(code):
        done = subprocess.run(["ociochecklut", *options, str(lut), *(repr(float(v)) for v in code)], text=True,
                              capture_output=True, check=False, env=environment)
        if done.returncode:
            raise RuntimeError(f"ociochecklut {lut.name}: {done.stdout}{done.stderr}")
        return [float(v) for v in done.stdout.split()[-3:]]

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return np.array(list(pool.map(one, codes)))


@pytest.mark.parametrize("client", [Client(
    "ociochecklut, OpenColorIO", "ociochecklut", "opencolorio-tools", "pkg-config --modversion OpenColorIO")], ids=str)
def test_formats(test):
    # Some of the picture's codes, and what lies outside of them: below 0 and above 1, where a table ends.
    test.flat = np.concatenate([test.flat[::len(test.flat) // COUNT], [[-0.25, 0.5, 1.5], [1, 1, 1], [0, 0, 0]]])
    test.truth = evaluate(test.command, log2_decode(np.clip(test.flat, 0, 1)), OPERATOR)
    for extension in ("cube", "clf", "spi3d"):
        lut, stated = test.bake("ocio", f"lut.{extension}", "--format", extension)
        if extension == "cube":  # the numbers of all
            cube, table = lut, read_cube(lut)[0]
        test.compare(f".{extension} 33", through_ociochecklut(lut, test.flat), tetrahedral(table, test.flat), stated,
                     PRINTED, clips=False)
    with screen() as display:
        if not display:
            print("skipped: the GPU path (no X server without a screen: Xvfb; Debian: xvfb)")
            return
        environment = {**os.environ, "DISPLAY": display, "LIBGL_ALWAYS_SOFTWARE": "1"}
        # Its context is made again for each color.
        test.flat, test.truth = test.flat[::5], test.truth[::5]
        shown = through_ociochecklut(cube, test.flat, "--gpu", environment=environment)
        test.compare(".cube 33, --gpu", shown, tetrahedral(table, test.flat), stated, PRINTED, clips=False)
