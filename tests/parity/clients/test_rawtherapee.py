# SPDX-License-Identifier: Apache-2.0
"""RawTherapee's Film Simulation with a Hald CLUT of `tonewright bake`, against the file and against the operator.

    python3 -m pytest tests/parity/clients/test_rawtherapee.py --tonewright build/release/bin/tonewright

TIFF of 16 bits in sRGB, in and out.
"""

import os
import subprocess

import pytest
from lut_client import Client
from lut_tables import trilinear
from pictures import read_rgb

# Its pipeline is not made for numbers: without a LUT, colors come out 1.1e-3 off at most (it decodes sRGB by a table,
# works in another gamut and encodes again).
PIPELINE = 1.5e-3
PROFILE = """[Version]
AppVersion=5.9
Version=349

[Color Management]
InputProfile=(embedded)
OutputProfile=RTv4_sRGB

[Film Simulation]
Enabled={enabled}
ClutFilename={hald}
Strength=100
"""


def through_rawtherapee(test, codes, hald):
    profile, out = test.scratch / "film.pp3", test.scratch / "out.tif"
    profile.write_text(PROFILE.format(enabled="true" if hald else "false", hald=hald))
    environment = {**os.environ, "HOME": str(test.scratch), "XDG_CONFIG_HOME": str(test.scratch / "config"),
                   "XDG_CACHE_HOME": str(test.scratch / "cache")}
    done = subprocess.run(["rawtherapee-cli", "-q", "-Y", "-o", str(out), "-p", str(profile), "-b16", "-t", "-c",
                           str(codes)], capture_output=True, text=True, check=False, env=environment)
    if done.returncode or not out.is_file():
        raise RuntimeError(f"rawtherapee-cli: exit {done.returncode}: {done.stdout}{done.stderr}")
    return read_rgb(out, test.scratch)


@pytest.mark.parametrize("client", [Client("RawTherapee", "rawtherapee-cli", "rawtherapee", "rawtherapee-cli -v")], ids=str)
def test_hald(test):
    codes = test.picture("codes.tif")
    plain = through_rawtherapee(test, codes, None)
    test.report.compare("without a LUT: the picture itself", plain, test.codes, PIPELINE)
    hald, table, stated = test.hald("rawtherapee")
    shown = through_rawtherapee(test, codes, hald)
    test.compare("Hald CLUT of 36, 16 bits", shown, trilinear(table, test.flat), stated, PIPELINE)
