# SPDX-License-Identifier: Apache-2.0
"""ICC device links of `tonewright bake` through LittleCMS (tificc) or ImageMagick, against the file and the operator.

    python3 -m pytest tests/parity/clients/test_tificc.py --tonewright build/release/bin/tonewright

Both interpolate in tetrahedra, on 16 bits; so does `tonewright eval --lut`.
"""

import numpy as np
import pytest
from lut_client import BITS16, Client
from lut_tables import tetrahedral
from pictures import evaluate, read_rgb, run


def through_link(test, link, codes):
    out = test.scratch / "out.tif"
    if test.client.program == "tificc":
        # Without -c 0 it resamples the cube.
        run("tificc", "-l", link, "-c", 0, "-w", 16, codes, out)
    else:
        run("convert", codes, "-profile", link, "-depth", 16, "+profile", "*", out)
    return read_rgb(out, test.scratch)


@pytest.mark.parametrize("client", [
    Client("LittleCMS 2.14, tificc", "tificc", "liblcms2-utils", "tificc"),
    Client("ImageMagick", "convert", "imagemagick", "convert -version")], ids=str)
def test_link(test):
    _, table, _ = test.cube("nuke")
    table = np.round(np.clip(table, 0, 1) * 65535) / 65535  # the nodes of the link have 16 bits
    expected = tetrahedral(table, test.flat)
    codes = test.picture("codes.tif")
    for version in (2, 4):
        link, stated = test.bake("icc", f"v{version}.icc", "--icc-version", version)
        test.compare(f"device link of 33, version {version}, 16 bits", through_link(test, link, codes), expected, stated, BITS16)
        some = test.flat[::17]
        got = evaluate(test.command, some, "--lut", link, "--input-encoding", "none")
        test.report.compare(f"eval --lut: device link, version {version}", got, expected[::17], BITS16)
