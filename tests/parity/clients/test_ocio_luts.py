# SPDX-License-Identifier: Apache-2.0
"""oiiotool or ocioconvert with LUT files of `tonewright bake`, against the files and against the operator.

    python3 -m pytest tests/parity/clients/test_ocio_luts.py --tonewright build/release/bin/tonewright

OpenColorIO reads all these formats and interpolates in tetrahedra, on the CPU, and in ocioconvert also in a shader, on
Mesa's software renderer and a screen that nobody sees.
"""

import os
import subprocess

import pytest
from lut_client import FLOAT32, Client
from lut_tables import read_cube, tetrahedral
from pictures import PROJECT, read_exr, run, screen, stack

FORMATS = ("cube", "clf", "spi3d")
# oiiotool wants a config even for a file that is none of it.
CONFIG = PROJECT / "ocio_config" / "config.ocio"


def through_oiiotool(test, lut, codes):
    out = test.scratch / "out.exr"
    run("oiiotool", "--colorconfig", CONFIG, codes, "--ociofiletransform", lut, "-d", "float", "--compression", "none",
        "-o", out)
    return stack(read_exr(out))


def through_ocioconvert(test, lut, codes, *options, display=None):
    out = test.scratch / "out.exr"
    environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", **({"DISPLAY": display} if display else {})}
    done = subprocess.run(["ocioconvert", "--string-attribute", "compression=none", *options, "--lut", str(lut),
                           str(codes), str(out)], capture_output=True, text=True, check=False, env=environment)
    if done.returncode:
        raise RuntimeError(f"ocioconvert {' '.join(options)}: {done.stdout}{done.stderr}")
    return stack(read_exr(out))


@pytest.mark.parametrize("client", [
    Client("oiiotool, OpenColorIO", "oiiotool", "openimageio-tools", "pkg-config --modversion OpenColorIO"),
    Client("ocioconvert, OpenColorIO", "ocioconvert", "opencolorio-tools", "pkg-config --modversion OpenColorIO")], ids=str)
def test_formats(test):
    codes = test.picture("codes.exr")
    through = through_oiiotool if test.client.program == "oiiotool" else through_ocioconvert
    for extension in FORMATS:
        lut, stated = test.bake("ocio", f"lut.{extension}", "--format", extension)
        if extension == "cube":  # the numbers of all
            cube, predicted = lut, tetrahedral(read_cube(lut)[0], test.flat)
        test.compare(f".{extension} 33", through(test, lut, codes), predicted, stated, FLOAT32, clips=False)
    if test.client.program == "oiiotool":
        return
    with screen() as display:
        if not display:
            print("skipped: the GPU path (no X server without a screen: Xvfb; Debian: xvfb)")
            return
        try:
            shown = through_ocioconvert(test, cube, codes, "--gpu", display=display)
        except RuntimeError as error:
            print(f"skipped: the GPU path ({error})")
            return
        test.compare(".cube 33, --gpu", shown, predicted, stated, FLOAT32, clips=False)
