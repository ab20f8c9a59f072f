# SPDX-License-Identifier: Apache-2.0
"""ffmpeg's lut3d, lut1d and haldclut with LUTs of `tonewright bake`, against the file itself and against the operator.

    python3 tests/parity/clients/test_ffmpeg.py build/release/bin/tonewright

ffmpeg reads float EXR, whose pixels are the codes that the LUT takes, and writes float EXR: no 8-bit step, no swscale.
Real pictures join the test chart where they are found, see pictures.shared_picture. The last line is
`N passed, M failed`.
"""

import numpy as np

from lut_client import BITS16, FLOAT32, HEIGHT, WIDTH, Client, lut_test
from lut_encodings import acescct_decode, acescct_encode
from lut_tables import hald_cube, linear, read_cube, stated_errors, tetrahedral, trilinear
from operators import rgb_to_rgb  # from the chromaticities, a second opinion on the program's
from pictures import (evaluate, log2_decode, log2_encode, read_exr, read_rgb, run, shared_picture, skip, stack, unstack,
                      write_exr)

# Colours compared with the operator; `eval` reads text, a million lines would take longer than they tell.
SAMPLES = 20000


def through_ffmpeg(codes, filter_, scratch):
    """Codes (height, width, 3) through a filter. ffmpeg runs in the folder: its filter syntax cannot quote any path."""
    write_exr(scratch / "codes.exr", unstack(codes))
    run("ffmpeg", "-v", "error", "-nostdin", "-y", "-i", "codes.exr", "-vf", filter_, "-pix_fmt", "gbrpf32le",
        "-update", 1, "-frames:v", 1, "graded.exr", folder=scratch)
    return stack(read_exr(scratch / "graded.exr"))


def compare(test, what, codes, graded, table, stated, interpolate, decode, arguments):
    """Graded codes against the file's numbers, and those inside the LUT's domain against the operator."""
    codes, graded = codes.reshape(-1, 3), graded.reshape(-1, 3)
    predicted = interpolate(table, codes.astype(float))
    test.report.compare(f"{what}, against the file", graded, predicted, FLOAT32)
    inside = np.flatnonzero(((codes >= 0) & (codes <= 1)).all(axis=1))
    chosen = np.random.default_rng(3).permutation(inside)[:SAMPLES]
    truth = evaluate(test.command, decode(codes[chosen].astype(float)), *arguments)
    test.report.compare(f"{what}, against the operator ({len(chosen)})", graded[chosen], truth, stated + FLOAT32)
    test.row(what, graded - predicted, FLOAT32, graded[chosen] - truth, stated + FLOAT32)


def through_haldclut(test, codes, hald, interpolation, form):
    """form: of the pixels of both pictures, rgb48le or gbrpf32le. ffmpeg itself would choose 8 bits, and it takes the
    channels of planar integers for each other."""
    graph = f"[0]format={form}[a];[1]format={form}[b];[a][b]haldclut=interp={interpolation}"
    arguments = ["ffmpeg", "-v", "error", "-nostdin", "-y", "-i", codes.name, "-i", hald.name, "-lavfi", graph,
                 "-pix_fmt", form, "-update", 1, "-frames:v", 1]
    if form == "gbrpf32le":
        run(*arguments, "graded.exr", folder=test.scratch)
        return stack(read_exr(test.scratch / "graded.exr"))
    run(*arguments, "-f", "rawvideo", "graded.raw", folder=test.scratch)
    return np.fromfile(test.scratch / "graded.raw", "<u2").reshape(HEIGHT, WIDTH, 3) / 65535


def check_modes(test):
    """Both interpolations of lut3d and haldclut, with numbers of 32 and of 16 bits."""
    for name, interpolate, host in (("tetrahedral", tetrahedral, "ffmpeg"), ("trilinear", trilinear, "gmic")):
        cube, table, stated = test.cube(host)
        shown = through_ffmpeg(test.codes, f"lut3d={cube.name}:interp={name}", test.scratch)
        test.compare(f"lut3d, .cube 33, {name}, float", shown, interpolate(table, test.flat), stated, FLOAT32, False)
        path, stated = test.bake(host, "hald.exr", "--format", "hald", "--size", 36, "--depth", 32)
        table = hald_cube(read_rgb(path, test.scratch))
        shown = through_haldclut(test, test.picture("codes.exr"), path, name, "gbrpf32le")
        test.compare(f"haldclut of 36, {name}, float", shown, interpolate(table, test.flat), stated, FLOAT32, False)
        path, stated = test.bake(host, "hald.png", "--format", "hald", "--size", 36, "--depth", 16)
        table = hald_cube(read_rgb(path, test.scratch))
        shown = through_haldclut(test, test.picture("codes.png"), path, name, "rgb48le")
        test.compare(f"haldclut of 36, {name}, 16 bits", shown, interpolate(table, test.flat), stated, BITS16)


def main(test):
    command, scratch = test.command, test.scratch
    if " exr " not in run("ffmpeg", "-v", "error", "-encoders"):
        skip("ffmpeg has no EXR encoder (older than 5.0)")
    run(command, "chart", "-o", scratch / "chart.exr", "--width", 768, "--height", 432)
    memorial = shared_picture("memorial.hdr")
    pictures = [scratch / "chart.exr"] + ([memorial] if memorial else [])
    to_ap1 = rgb_to_rgb("rec709", "ap1").T

    run(command, "bake", "agx_sobotka", "--format", "cube", "--size", 33, "--input-encoding", "acescct",
        "-o", scratch / "agx.cube")
    cube, lines = read_cube(scratch / "agx.cube")
    stated = stated_errors(lines)["tetrahedral"][0]
    test.report.bound("agx.cube: entries, as 33^3", abs(cube.size - 3 * 33**3), 0.5)
    # Uniform random codes reach every cell of the cube, and -0.1 and 1.1 what is outside.
    random = np.random.default_rng(1).uniform(-0.1, 1.1, (128, 128, 3))
    run(command, "bake", "hable", "--format", "cube", "--input-encoding", "log2", "-o", scratch / "hable.cube")
    curve, lines = read_cube(scratch / "hable.cube")
    curve_stated = stated_errors(lines)["linear"][0]
    for name, rgb in [(p.name, read_rgb(p, scratch).astype(float)) for p in pictures] + [("random", None)]:
        codes = (random if rgb is None else acescct_encode(rgb @ to_ap1)).astype(np.float32)
        graded = through_ffmpeg(codes, "lut3d=agx.cube:interp=tetrahedral", scratch)
        compare(test, f"lut3d, .cube 33 of ACEScct, {name}", codes, graded, cube, stated, tetrahedral,
                acescct_decode, ("agx_sobotka", "--input", "lin_ap1"))
        codes = (random if rgb is None else log2_encode(rgb)).astype(np.float32)
        graded = through_ffmpeg(codes, "lut1d=hable.cube:interp=linear", scratch)
        compare(test, f"lut1d, .cube 4096 of Hable, {name}", codes, graded, curve, curve_stated, linear,
                log2_decode, ("hable",))
    check_modes(test)


if __name__ == "__main__":
    raise SystemExit(lut_test(__doc__, main, Client("ffmpeg", "ffmpeg", "ffmpeg", "ffmpeg -version")))
