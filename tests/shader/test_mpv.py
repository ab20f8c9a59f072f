# SPDX-License-Identifier: Apache-2.0
"""The hook that `tonewright shader --for mpv` writes, in mpv on a virtual screen, beside `tonewright apply`; AgX of Blender
with its 3D LUT in the hook, ACES 2.0 with its tables in a texture.

    python3 -m pytest tests/shader/test_mpv.py --tonewright build/release/bin/tonewright
"""

import subprocess

import numpy as np
import OpenImageIO
import pytest
from executed import colors
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


@pytest.mark.parametrize("operator, options", [
    ("agx_threejs", []), ("agx_blender", []), ("aces_20", ["--tables", "texture"]),
    *(pytest.param(o, [], marks=pytest.mark.full) for o in ("aces_20", "aces_13", "khronos_neutral", "gt7"))])
def test_hook(report, command, scratch, operator, options):
    for program, package in (("mpv", "mpv"), ("xvfb-run", "xvfb"), ("oiiotool", "openimageio-tools")):
        need_program(program, package)

    def run(*arguments):
        return subprocess.run([str(a) for a in arguments], cwd=scratch, check=True, capture_output=True, text=True)

    (scratch / "shot.lua").write_text(SCRIPT)
    # Patches, because filters of mpv and of the window mix a little of the neighbors into a pixel.
    width, height, patch = 640, 360, 8
    light = np.clip(colors(), 0, 64)[:width * height // patch**2]
    patches = np.zeros((height // patch, width // patch, 3), np.float32)
    patches.reshape(-1, 3)[:len(light)] = light
    scene = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, 3, "half"))
    scene.set_pixels(OpenImageIO.ROI(), np.ascontiguousarray(patches.repeat(patch, 0).repeat(patch, 1)))
    assert scene.write(str(scratch / "scene.exr")), scene.geterror()
    run(command, "shader", operator, "--for", "mpv", "-o", "hook.glsl", "-q", *options)
    run(command, "apply", "scene.exr", "right.png", "-d", "uint16", "--operator", operator, "-q")
    run("xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", "mpv", "--no-config", "--vo=gpu", "--gpu-api=opengl", "--gpu-sw",
        "--no-audio", "--keep-open", "--pause", "--osd-level=0", f"--geometry={width}x{height}", "--no-border", "--dither=no",
        "--vf=format=gamma=srgb", "--glsl-shader=hook.glsl", "--script=shot.lua", "scene.exr")
    shot, right = (read_rgb(scratch / file, scratch) for file in ("shot.png", "right.png"))
    if not report.check("the picture's size", shot.shape == right.shape, f"the picture is {shot.shape}; expected {right.shape}"):
        return
    middle = np.s_[patch // 2::patch, patch // 2::patch, :3]
    error = np.abs(shot[middle].astype(float) - right[middle])
    report.bound("largest error", error.max(), BOUND)
    report.bound("mean", error.mean(), BOUND / 4)
    report.check("the picture is one", right.std() > 0.1)
