# SPDX-License-Identifier: Apache-2.0
"""GraphicsMagick or ImageMagick with a Hald CLUT of `tonewright bake`, against the file and against the operator.

    python3 tests/parity/clients/test_magick.py build/release/bin/tonewright gm|convert

Both interpolate in cubes, on 16 bits. The last line is `N passed, M failed`.
"""

from lut_client import BITS16, Client, lut_test
from lut_tables import trilinear
from pictures import read_rgb, run


def through_magick(test, hald, codes):
    out = test.scratch / "out.tif"
    if test.client.program == "gm":
        run("gm", "convert", codes, "-hald-clut", hald, out)
    else:
        run("convert", codes, hald, "-hald-clut", "-depth", 16, out)
    return read_rgb(out, test.scratch)


def main(test):
    hald, table, stated = test.hald("imagemagick")
    for name in ("codes.tif", "codes.png"):  # a PNG says what its numbers are: its reader may act on that
        shown = through_magick(test, hald, test.picture(name))
        test.compare(f"Hald CLUT of 36, 16 bits, {name[-3:].upper()}", shown, trilinear(table, test.flat), stated,
                     BITS16)


if __name__ == "__main__":
    raise SystemExit(lut_test(__doc__, main, Client("GraphicsMagick", "gm", "graphicsmagick", "gm version"),
                              Client("ImageMagick", "convert", "imagemagick", "convert -version")))
