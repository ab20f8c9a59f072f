# SPDX-License-Identifier: Apache-2.0
"""darktable's module "LUT 3D" with a .cube of `tonewright bake`, against the file and against the operator.

    python3 -m pytest tests/parity/clients/test_darktable.py --tonewright build/release/bin/tonewright

Float EXR in and out; the module works in linear Rec.709, so that its numbers are the picture's.
"""

import re
import struct

import pytest
from lut_client import Client
from lut_tables import tetrahedral, trilinear
from pictures import read_rgb, run

# Its working profile is Rec.2020: to it and back costs 6e-5 of the codes, as the first check shows, times the steepest
# of the table.
IDENTITY = 1e-4
WORKING_PROFILE = 5e-4
LINEAR_REC709 = 3
TETRAHEDRAL, TRILINEAR = 0, 1

# The parameters of "LUT 3D", version 3: the file, color space, interpolation, and room for compressed LUTs.
SIDECAR = """<?xml version="1.0" encoding="UTF-8"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/">
 <rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
  <rdf:Description rdf:about="" xmlns:darktable="http://darktable.sf.net/" xmlns:xmpMM="http://ns.adobe.com/xap/1.0/mm/"
   xmpMM:DerivedFrom="codes.exr" darktable:xmp_version="4" darktable:auto_presets_applied="1"
   darktable:history_end="1">
   <darktable:history><rdf:Seq>
    <rdf:li darktable:num="0" darktable:operation="lut3d" darktable:enabled="1" darktable:modversion="3"
     darktable:params="{params}" darktable:multi_name="" darktable:multi_priority="0"/>
   </rdf:Seq></darktable:history>
  </rdf:Description>
 </rdf:RDF>
</x:xmpmeta>
"""


def through_darktable(test, codes, cube, interpolation):
    """cube: None for no module at all."""
    sidecar, out = test.scratch / "darktable.xmp", test.scratch / "darktable.exr"
    name = cube.name.encode() if cube else b""
    params = struct.pack("<512siii12288s128s", name, LINEAR_REC709, interpolation, 0, b"", b"")
    text = SIDECAR.format(params=params.hex())
    if not cube:
        text = re.sub(r"<rdf:li .*/>", "", text, flags=re.S).replace('history_end="1"', 'history_end="0"')
    sidecar.write_text(text)
    out.unlink(missing_ok=True)  # it would write beside it
    said = run("darktable-cli", codes, sidecar, out, "--hq", "true", "--apply-custom-presets", "false",
               "--icc-type", "LIN_REC709", "--core", "--configdir", test.scratch / "config", "--library", ":memory:",
               "--conf", f"plugins/darkroom/lut3d/def_path={test.scratch}",
               "--conf", "plugins/imageio/format/exr/bpp=32", "--conf", "plugins/darkroom/workflow=none",
               "--conf", "plugins/darkroom/chromatic-adaptation=legacy",
               "--disable-opencl")
    if not out.is_file():
        raise RuntimeError(f"darktable-cli wrote no picture: {said}")
    return read_rgb(out, test.scratch)


@pytest.mark.parametrize("client", [Client("darktable", "darktable-cli", "darktable", "darktable-cli --version")], ids=str)
def test_cube(test):
    codes = test.picture("codes.exr")
    plain = through_darktable(test, codes, None, 0)
    test.report.compare("without a LUT: the picture itself", plain, test.codes, IDENTITY)
    # The same table for two applications: `bake` says what each makes of it.
    for name, number, interpolate, host in (("tetrahedral", TETRAHEDRAL, tetrahedral, "darktable"),
                                            ("trilinear", TRILINEAR, trilinear, "gmic")):
        cube, table, stated = test.cube(host)
        test.compare(f".cube 33, {name}", through_darktable(test, codes, cube, number), interpolate(table, test.flat),
                     stated, WORKING_PROFILE, clips=False)
