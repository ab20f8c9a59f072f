# SPDX-License-Identifier: Apache-2.0
"""GraphicsMagick or ImageMagick with a Hald CLUT of `tonewright bake`, against the file and against the operator.

    python3 -m pytest tests/parity/clients/test_magick.py --tonewright build/release/bin/tonewright

All interpolate in cubes, on 16 bits.
"""

import numpy as np
import pytest
from lut_client import BITS16, Client
from lut_tables import trilinear
from pictures import read_rgb, run, unstack, write_exr


def through_magick(test, hald, codes):
    out = test.scratch / "out.tif"
    if test.client.program == "gm":
        run("gm", "convert", codes, "-hald-clut", hald, out)
    else:
        run(*test.program, codes, hald, "-hald-clut", "-depth", 16, out)
    return read_rgb(out, test.scratch)


def check_above(test):
    """Above 1, a build with float pixels leaves the last column of the CLUT: red falls again. -clamp before it helps."""
    is_float = "HDRI" in run(*test.program, "-version")
    bright = np.full((8, 8, 3), 4, np.float32)
    write_exr(test.scratch / "bright.exr", unstack(bright))
    run("oiiotool", test.scratch / "bright.exr", "-d", "float", "-o", test.scratch / "bright.tif")
    run(test.command, "bake", "clamp", "--format", "hald", "--size", 36, "--depth", 16, "--input-encoding", "srgb", "-o",
        test.scratch / "same.png")
    for options, largest in (((), 0 if not is_float else 0.03), (("-clamp",), 0)):
        out = test.scratch / "bright_out.tif"
        run(*test.program, test.scratch / "bright.tif", *options, test.scratch / "same.png", "-hald-clut", "-type", "TrueColor",
            "-depth", 16, out)
        shown = 1 - read_rgb(out, test.scratch)[4, 4]
        test.report.check(f"4.0 through an identity, {' '.join(options) or 'as it is'}: 1 - {shown}",
                          abs(shown[1:]).max() < 1e-4 and (shown[0] > largest if largest else abs(shown[0]) < 1e-4))


@pytest.mark.parametrize("client", [
    Client("GraphicsMagick", "gm", "graphicsmagick", "gm version"),
    Client("ImageMagick", "convert", "imagemagick", "convert -version"),
    Client("ImageMagick", "magick", "imagemagick", "magick -version", newer=True)], ids=str)
def test_hald(test):
    hald, table, stated = test.hald("imagemagick")
    for name in ("codes.tif", "codes.png"):  # a PNG says what its numbers are: its reader may act on that
        shown = through_magick(test, hald, test.picture(name))
        test.compare(f"Hald CLUT of 36, 16 bits, {name[-3:].upper()}", shown, trilinear(table, test.flat), stated,
                     BITS16)
    if test.client.program != "gm":
        check_above(test)
