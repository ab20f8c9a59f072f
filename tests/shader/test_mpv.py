# SPDX-License-Identifier: Apache-2.0
"""The hook that `tonewright shader --for mpv` writes, in mpv on a virtual screen, beside `tonewright apply`; AgX of Blender
with its 3D LUT in the hook.

    python3 -m pytest tests/shader/test_mpv.py --tonewright build/release/bin/tonewright
"""

import subprocess

import numpy as np
import pytest
from pictures import need_program, read_rgb

# The window holds codes of 8 bits, rounded once.
BOUND = 1 / 255
SCRIPT = """
mp.register_event("file-loaded", function()
    mp.add_timeout(1, function()
        mp.commandv("screenshot-to-file", "shot.png", "window")
        mp.command("quit")
    end)
end)
"""


@pytest.mark.parametrize("operator", ["agx_threejs", "agx_blender"])
def test_hook(report, command, scratch, operator):
    for program, package in (("mpv", "mpv"), ("xvfb-run", "xvfb"), ("oiiotool", "openimageio-tools")):
        need_program(program, package)

    def run(*arguments):
        return subprocess.run([str(a) for a in arguments], cwd=scratch, check=True, capture_output=True, text=True)

    (scratch / "shot.lua").write_text(SCRIPT)
    run(command, "chart", "-o", "chart.exr", "-q")
    run("oiiotool", "chart.exr", "--resize:filter=box", "640x360", "--ch", "R,G,B", "--maxc", "0", "-d", "half", "-o", "scene.exr")
    width, height = 640, 360
    run(command, "shader", operator, "--for", "mpv", "-o", "hook.glsl", "-q")
    run(command, "apply", "scene.exr", "right.png", "-d", "uint16", "--operator", operator, "-q")
    run("xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", "mpv", "--no-config", "--vo=gpu", "--gpu-api=opengl", "--gpu-sw",
        "--no-audio", "--keep-open", "--pause", "--osd-level=0", f"--geometry={width}x{height}", "--no-border", "--dither=no",
        "--vf=format=gamma=srgb", "--glsl-shader=hook.glsl", "--script=shot.lua", "scene.exr")
    shot, right = (read_rgb(scratch / file, scratch) for file in ("shot.png", "right.png"))
    if not report.check("the picture's size", shot.shape == right.shape, f"the picture is {shot.shape}; expected {right.shape}"):
        return
    # The window's filter mixes a little of the neighbors into some rows.
    height, width = right.shape[:2]
    padded = np.pad(right, ((1, 1), (1, 1), (0, 0)), mode="edge")
    around = np.stack([padded[y:y + height, x:x + width] for y in range(3) for x in range(3)])
    shown = shot[..., :3].astype(float)
    error = np.abs(shown - np.clip(shown, around.min(0), around.max(0))).max()
    mean = np.abs(shown - right).mean()
    report.bound("largest error", error, BOUND)
    report.bound("mean", mean, BOUND / 4)
    report.check("the picture is one", right.std() > 0.1)
