# SPDX-License-Identifier: Apache-2.0
"""mpv's gpu-next (libplacebo) with LUTs of `tonewright bake`, against the file and against the operator.

    python3 -m pytest tests/parity/clients/test_mpv.py --tonewright build/release/bin/tonewright

On Mesa's software renderer and a screen that nobody sees; a script of mpv's takes a screenshot of 16 bits. libplacebo
interpolates in cubes in mpv 0.35, and in tetrahedra in mpv 0.41.
"""

import os
import re
import subprocess

import pytest
from lut_client import Client
from lut_tables import tetrahedral, trilinear
from pictures import read_rgb, screen, skip

# The rounding of the screenshot, half a code of 16 bits, and the shader's float32.
SCREENSHOT = 1.6e-5
# The window has to be there before there is anything to take: `vo-configured` says when.
SCRIPT = """
mp.observe_property("vo-configured", "bool", function(_, there)
    if not there then return end
    -- Until there is a frame to take: a software renderer needs a while.
    mp.add_periodic_timer(0.5, function()
        mp.commandv("screenshot-to-file", os.getenv("SHOT"), "video")
        local shot = io.open(os.getenv("SHOT"))
        if shot then
            shot:close()
            mp.command("quit")
        end
    end)
end)
"""


def through_mpv(test, display, lut, codes, *options):
    script, out = test.scratch / "shot.lua", test.scratch / "shot.png"
    script.write_text(SCRIPT)
    out.unlink(missing_ok=True)
    arguments = [*test.program, "--no-config", "--vo=gpu-next", "--gpu-api=opengl", "--gpu-sw=yes", "--target-trc=srgb",
                 "--target-prim=bt.709", "--dither-depth=no", "--deband=no", "--screenshot-high-bit-depth=yes",
                 "--screenshot-format=png", f"--script={script}", "--pause", *options, codes]
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False, timeout=120,
                          env={**os.environ, "DISPLAY": display, "SHOT": str(out), "LIBGL_ALWAYS_SOFTWARE": "1"})
    if not out.is_file():
        if "Failed initializing any suitable GPU context" in done.stdout + done.stderr:
            skip(f"mpv finds no OpenGL ({done.stdout.strip().splitlines()[-1]})")
        raise RuntimeError(f"mpv took no screenshot: {done.stdout}{done.stderr}")
    return read_rgb(out, test.scratch)


MPV = Client("mpv", "mpv", "mpv", "mpv --version")


@pytest.mark.parametrize("client", [MPV, MPV._replace(newer=True)], ids=str)
def test_lut(test):
    codes = test.picture("codes.png")
    with screen() as display:
        if not display:
            skip("no X server without a screen (Xvfb; Debian: xvfb)")
        plain = through_mpv(test, display, None, codes)
        test.report.compare("without a LUT: the picture itself", plain, test.codes, SCREENSHOT)
        # Both are entered for the versions that ran; what is between them is not known.
        version = tuple(int(n) for n in re.search(r"(\d+)\.(\d+)", test.version).groups())
        is_old = version <= (0, 35)
        for size in (33, 65):
            # The nodes are sampled, and so the same for both; only the stated error is that of the interpolation.
            cube, table, stated = test.cube("gmic" if is_old else "mpv", size)
            shown = through_mpv(test, display, cube, codes, f"--image-lut={cube}", "--image-lut-type=native")
            interpolate = trilinear if is_old else tetrahedral
            test.compare(f".cube {size}, --image-lut, {interpolate.__name__}", shown, interpolate(table, test.flat), stated,
                         SCREENSHOT)
