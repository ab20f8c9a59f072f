#!/usr/bin/env python3
"""The hook that `tonewright shader --for mpv` writes, in mpv on a virtual screen, beside `tonewright apply`.

Usage: test_mpv.py TONEWRIGHT
"""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from pictures import read_rgb  # noqa: E402

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


def main(tonewright):
    for program in ("mpv", "xvfb-run", "oiiotool"):
        if not shutil.which(program):
            print(f"{program} is not installed")
            return 77
    tonewright = str(Path(tonewright).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def run(*arguments):
            return subprocess.run([str(a) for a in arguments], cwd=folder, check=True, capture_output=True, text=True)

        (folder / "shot.lua").write_text(SCRIPT)
        run(tonewright, "chart", "-o", "chart.exr", "-q")
        run("oiiotool", "chart.exr", "--resize:filter=box", "640x360", "--ch", "R,G,B", "--maxc", "0", "-d", "half", "-o", "scene.exr")
        width, height = 640, 360
        run(tonewright, "shader", "agx_threejs", "--for", "mpv", "-o", "hook.glsl", "-q")
        run(tonewright, "apply", "scene.exr", "right.png", "-d", "uint16", "--operator", "agx_threejs", "-q")
        run("xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", "mpv", "--no-config", "--vo=gpu", "--gpu-api=opengl", "--gpu-sw",
            "--no-audio", "--keep-open", "--pause", "--osd-level=0", f"--geometry={width}x{height}", "--no-border", "--dither=no",
            "--vf=format=gamma=srgb", "--glsl-shader=hook.glsl", "--script=shot.lua", "scene.exr")
        shot, right = (read_rgb(folder / file, folder) for file in ("shot.png", "right.png"))
        if shot.shape != right.shape:
            print(f"the picture is {shot.shape}; expected {right.shape}")
            return 1
        # The window's filter mixes a little of the neighbors into some rows.
        height, width = right.shape[:2]
        padded = np.pad(right, ((1, 1), (1, 1), (0, 0)), mode="edge")
        around = np.stack([padded[y:y + height, x:x + width] for y in range(3) for x in range(3)])
        shown = shot[..., :3].astype(float)
        error = np.abs(shown - np.clip(shown, around.min(0), around.max(0))).max()
        mean = np.abs(shown - right).mean()
        print(f"largest error {error:.2g}, bound {BOUND:.2g}; mean {mean:.2g}, bound {BOUND / 4:.2g}")
        return 0 if error <= BOUND and mean <= BOUND / 4 and right.std() > 0.1 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
