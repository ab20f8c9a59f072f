# SPDX-License-Identifier: Apache-2.0
"""GStreamer's glshader with what `tonewright shader --for gstreamer` writes, as the command that it prints has it.

    python3 -m pytest tests/shader/test_gstreamer.py --tonewright build/release/bin/tonewright
"""

import subprocess

import numpy as np
import pytest
from executed import reference
from pictures import need_program, skip

# Frames of 8 bits on both sides: half a code, and a twentieth for llvmpipe, which rounds to 8 bits in float.
BOUND = 0.55 / 255
STOPS = 4  # the frame's 1 is 16 times white


@pytest.mark.parametrize("operator", ["agx_blender", "aces_20", "aces_13", "khronos_neutral", "gt7"])
def test_frame(report, command, scratch, operator):
    for program, package in (("gst-launch-1.0", "gstreamer1.0-tools"), ("xvfb-run", "xvfb")):
        need_program(program, package)
    if subprocess.run(["gst-inspect-1.0", "glshader"], capture_output=True, check=False).returncode:
        skip("glshader is missing (Debian: gstreamer1.0-gl)")
    frame = np.random.default_rng(1).integers(0, 256, (48, 64, 4), dtype=np.uint8)
    frame[0, :, :3] = (4 * np.arange(64, dtype=np.uint8))[:, None]
    frame[1, :4, :3] = [[0, 0, 0], [255, 255, 255], [255, 0, 0], [0, 0, 255]]
    frame.tofile(scratch / "in.raw")
    subprocess.run([command, "shader", operator, "--for", "gstreamer", "--exposure", str(STOPS), "-o", "a.frag", "-q"], check=True,
                   cwd=scratch)
    vertex = r'vertex="\"$(cat tonewright.vert)\""' if (scratch / "tonewright.vert").is_file() else ""
    report.check("arrays of constants need a vertex shader", bool(vertex) == (operator == "aces_20"))
    line = rf"""gst-launch-1.0 -q filesrc location=in.raw blocksize={frame.nbytes} \
        ! video/x-raw,format=RGBA,width=64,height=48,framerate=1/1,colorimetry=sRGB ! glupload \
        ! glshader fragment="\"$(cat a.frag)\"" {vertex} \
        ! gldownload ! video/x-raw,format=RGBA ! filesink location=out.raw"""
    done = subprocess.run(["xvfb-run", "-a", "bash", "-c", line], cwd=scratch, capture_output=True, text=True, check=False)
    if not report.check("it runs", done.returncode == 0, done.stderr):
        return
    shown = np.fromfile(scratch / "out.raw", np.uint8).reshape(-1, 4)[:, :3] / 255
    scene = frame.reshape(-1, 4)[:, :3].astype(np.float32) / np.float32(255)
    right = reference(command, operator, scene, "--exposure", str(STOPS))
    report.bound(operator, np.abs(shown - right).max(), BOUND + (3.5e-3 if operator == "gt7" else 0))
