# SPDX-License-Identifier: Apache-2.0
"""G'MIC with LUTs of `tonewright bake`: a .cube, a Hald CLUT and a strip, against the file and against the operator.

    python3 -m pytest tests/parity/clients/test_gmic.py --tonewright build/release/bin/tonewright

As `list --hosts` says: G'MIC's own `map_clut` takes v n / 256 for the place of v, so that no table fits. The strip has
the layout of Unreal and Godot, whose programs are not here.
"""

import pytest
from lut_client import FLOAT32, Client
from lut_tables import strip_cube, trilinear
from pictures import read_rgb, run

STRIP = 32


def through_gmic(test, codes, lut, *words, size):
    """words: what makes n x n x n voxels of 0..1 of the LUT."""
    out = test.scratch / "gmic.tif"
    last = size - 1
    run("gmic", "-v", "-", codes, lut, *words, "fill[0]", f"I(#1,R*{last},G*{last},B*{last},1,0)", "keep[0]",
        "output[0]", f"{out},float")
    return read_rgb(out, test.scratch)


@pytest.mark.parametrize("client", [Client("G'MIC", "gmic", "gmic", "gmic -version")], ids=str)
def test_lut(test):
    codes = test.picture("codes.tif", "float")
    cube, table, stated = test.cube("gmic")
    shown = through_gmic(test, codes, cube, "div[1]", 255, size=33)
    test.compare(".cube 33", shown, trilinear(table, test.flat), stated, FLOAT32, clips=False)
    hald, table, stated = test.hald("imagemagick")
    shown = through_gmic(test, codes, hald, "div[1]", 65535, "resize[1]", "36,36,36,3,-1", size=36)
    test.compare("Hald CLUT of 36, 16 bits", shown, trilinear(table, test.flat), stated, FLOAT32)
    path, stated = test.bake("godot", "strip.png", "--depth", 16)
    table = strip_cube(read_rgb(path, test.scratch))
    shown = through_gmic(test, codes, path, "div[1]", 65535, "split[1]", f"x,{STRIP}", "append[1--1]", "z", size=STRIP)
    test.compare("strip of 32, 16 bits", shown, trilinear(table, test.flat), stated, FLOAT32)
