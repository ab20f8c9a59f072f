# SPDX-License-Identifier: Apache-2.0
"""ocioconvert with the OpenColorIO config against `tonewright apply`: its CPU path, and its GPU path without a GPU.

    python3 -m pytest tests/parity/clients/test_ocioconvert.py --tonewright build/release/bin/tonewright

ocioconvert is OpenColorIO's own program: its GPU path is the shader that viewers draw with, here with tables of 32
bits, on Mesa's software renderer and a screen that nobody sees. The config is ocio_config/ of the working directory.
"""

import os
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from pictures import (LIGHT, PROJECT, nearest_of_bytes, need_program, read_exr, read_rgb, run, screen, shared_picture, stack, unstack,
                      write_exr)
from test_blender import OPERATORS
from test_oiiotool import EXACT, bound_of

# The error that a shader adds: where a view is matrices and curves, float32 in another order; where it samples a
# cube, goes through HSV or through OpenColorIO's glow and red modifier, the weights and logarithms of the renderer.
GPU_CURVES, GPU_OTHERS = 1e-6, 5e-5
CURVES = 2e-6  # a view with a lower bound on the CPU is matrices and curves
# Float32 leaves as much of a matrix from another gamut, where it subtracts.
FROM_ANOTHER_GAMUT = 1e-6
# Views whose published error is one of light without negatives: outside the gamut their cube is coarser.
CUBES = {"ACES 2.0"}
WIDTH, HALF = 256, 128

# (view, display, its name for `apply`, also by the GPU). Every view on sRGB; every display.
ON_GPU = {"AgX", "ACES 2.0", "ACES 1.3", "Khronos PBR Neutral", "Hable", "AgX Sobotka", "False Color"}
JOBS = [(view, "sRGB", "srgb", view in ON_GPU) for view in OPERATORS] + [
    ("AgX", "Display P3", "display_p3", False), ("AgX Punchy", "Rec.2020", "rec2020", False),
    ("AgX Sobotka", "Display P3", "display_p3", True), ("Hable", "Rec.1886", "rec1886", True),
    ("Standard", "Gamma 2.2", "g22", False), ("AgX - HDR 1000 nits", "Rec.2100-PQ", "rec2100_pq", True),
    ("ACES 1.3 - HDR 1000 nits", "Rec.2100-PQ", "rec2100_pq", False),
    ("Gran Turismo - HDR 1000 nits", "Rec.2100-HLG", "rec2100_hlg", True),
    ("Reinhard Extended", "P3-D65 PQ", "p3d65_pq", False)]


def make_picture(scratch):
    """Random colors of 18 stops, a fifth of them with negatives, primaries, black; a real picture where there is one.

    Its sides are powers of two: ocioconvert's GPU path reads the picture by filtering, at positions in float32, so
    that other pixels get 1e-5 of their neighbor's light, which is much beside the sun.
    """
    random = np.random.default_rng(11)
    rgb = 0.18 * 2.0 ** random.uniform(-10, 8, (HALF, WIDTH, 3))
    rgb[:26] *= random.choice([-1, 1], (26, WIDTH, 3), p=[0.3, 0.7])
    for channel in range(3):  # a primary and its complement, of all these brightnesses
        rgb[30 + channel] *= np.eye(3)[channel]
        rgb[40 + channel] *= 1 - np.eye(3)[channel]
    rgb[50] = 0
    rgb[51] = np.geomspace(1e-6, 65504, WIDTH)[:, None]
    real = shared_picture("memorial.hdr")
    if real:
        run("oiiotool", real, "--ch", "R,G,B", "--resize", f"{WIDTH}x{HALF}", "-d", "float", "-o", scratch / "real.exr")
        rgb = np.concatenate([rgb, read_rgb(scratch / "real.exr", scratch)])
    path = scratch / "picture.exr"
    write_exr(path, unstack(rgb.astype(np.float32)))
    return path


class Ocioconvert:
    """Runs the program with a config; every picture it makes is read as floats."""

    def __init__(self, config, scratch):
        self.scratch = scratch
        self.environment = {**os.environ, "OCIO": str(config), "LIBGL_ALWAYS_SOFTWARE": "1"}
        self.environment.pop("DISPLAY", None)

    def run(self, options, picture, source, out, *target):
        """ocioconvert [OPTIONS] PICTURE SOURCE OUT SPACE, or with --view DISPLAY VIEW; what it said."""
        done = subprocess.run(["ocioconvert", "--string-attribute", "compression=none", *options, str(picture), source,
                               str(out), *target],
                              capture_output=True, text=True, check=False, env=self.environment)
        said = done.stdout + done.stderr
        if done.returncode:
            raise RuntimeError(f"exit {done.returncode}: ocioconvert {' '.join(options)}: {said.strip()}")
        return said

    def view(self, picture, display, view, *options):
        out = self.scratch / f"{display}.{view}.{'gpu' if '--gpu' in options else 'cpu'}.exr"
        self.run([*options, "--view"], picture, "Linear Rec.709", out, display, view)
        return stack(read_exr(out))

    def space(self, picture, source, target, *options):
        out = self.scratch / f"{source}.to.{target}.exr"
        self.run(options, picture, source, out, target)
        return stack(read_exr(out))


def through_apply(command, picture, view, display, scratch, *options):
    operator = OPERATORS[view.split(" - HDR ")[0]]
    out = scratch / f"{display}.{view}.apply.exr"
    run(command, "apply", picture, out, "--operator", *operator, "--statistics", "defaults", "--display", display,
        "-d", "float", *options)
    return read_rgb(out, scratch)


def gpu_bound(config, view):
    bound = bound_of(config, view)
    return bound + (GPU_CURVES if bound < CURVES else GPU_OTHERS)


def finds_gpu(report, convert, picture):
    """Whether there is GL, which is no fault of ours; and that the picture itself arrives there as it is."""
    out = convert.scratch / "raw.gpu.exr"
    try:
        said = convert.run(["-v", "--gpu", "--view"], picture, "Linear Rec.709", out, "sRGB", "Raw")
    except RuntimeError as error:
        print(f"skipped: the GPU path ({error})")
        return False
    print(*[line for line in said.splitlines() if line.startswith(("GL Renderer", "GL Version"))], sep="\n")
    report.compare("Raw on the GPU is the picture", stack(read_exr(out)), stack(read_exr(picture)), 0)
    return True


def check_views(report, command, convert, config, picture, has_gpu):
    """All of JOBS; as many at a time as there are cores."""
    inside = (stack(read_exr(picture)) >= 0).all(axis=-1)

    def pictures_of(job):
        view, display, option, on_gpu = job
        gpu = convert.view(picture, display, view, "--gpu") if on_gpu and has_gpu else None
        return (convert.view(picture, display, view), gpu,
                through_apply(command, picture, view, option, convert.scratch))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for (view, display, option, _), (cpu, gpu, applied) in zip(JOBS, pool.map(pictures_of, JOBS)):
            where, light = inside if view in CUBES else ..., LIGHT.get(option)
            report.compare(f"CPU {display}, {view}", cpu[where], applied[where], bound_of(config, view), light)
            if gpu is not None:
                report.compare(f"GPU {display}, {view}", gpu[where], applied[where], gpu_bound(config, view), light)


def check_spaces(report, command, convert, config, picture, has_gpu):
    """Output spaces, by name and by alias, from other spaces than Linear Rec.709, and back."""
    for view, space in (("AgX", "Output - AgX - sRGB"), ("Reinhard Extended", "out_reinhard_extended_srgb")):
        report.compare(f"to {space}", convert.space(picture, "Linear Rec.709", space),
                       convert.view(picture, "sRGB", view), 0)
    for gpu in ([], ["--gpu"])[:1 + has_gpu]:
        shown = convert.space(picture, "ACEScg", "Output - Hable - Display P3", *gpu)
        applied = through_apply(command, picture, "Hable", "display_p3", convert.scratch, "--input", "lin_ap1")
        report.compare(f"{'GPU' if gpu else 'CPU'} ACEScg to Output - Hable - Display P3", shown, applied,
                       FROM_ANOTHER_GAMUT + (gpu_bound if gpu else bound_of)(config, "Hable"))
    shown = convert.space(picture, "Linear Rec.709", "out_hable_srgb")
    convert.space(convert.scratch / "Linear Rec.709.to.out_hable_srgb.exr", "out_hable_srgb", "lin_rec709")
    again = convert.space(convert.scratch / "out_hable_srgb.to.lin_rec709.exr", "lin_rec709", "Output - Hable - sRGB")
    report.compare("out_hable_srgb and back, and there again", again, shown, EXACT)


def check_bytes(report, command, convert, config, picture):
    """Its output for a screen: a PNG with the nearest 8-bit codes."""
    out = convert.scratch / "screen.png"
    convert.run(["--view"], picture, "Linear Rec.709", out, "sRGB", "AgX")
    applied = through_apply(command, picture, "AgX", "srgb", convert.scratch)
    report.compare("a PNG of sRGB, AgX", nearest_of_bytes(read_rgb(out, convert.scratch), applied), applied,
                   bound_of(config, "AgX"))


def test_views_and_spaces(report, command, scratch):
    need_program("ocioconvert", "opencolorio-tools")
    need_program("oiiotool", "openimageio-tools")
    config = PROJECT / "ocio_config/config.ocio"
    with screen() as display:
        convert = Ocioconvert(config, scratch)
        picture = make_picture(scratch)
        if display:
            convert.environment["DISPLAY"] = display
            has_gpu = finds_gpu(report, convert, picture)
        else:
            print("skipped: the GPU path (no X server without a screen: Xvfb; Debian: xvfb)")
            has_gpu = False
        check_views(report, command, convert, config, picture, has_gpu)
        check_spaces(report, command, convert, config, picture, has_gpu)
        check_bytes(report, command, convert, config, picture)
