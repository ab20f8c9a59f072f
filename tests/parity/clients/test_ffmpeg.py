# SPDX-License-Identifier: Apache-2.0
"""ffmpeg's lut3d and lut1d with LUTs of `tonewright bake`, against the file itself and against the operator.

    python3 tests/parity/clients/test_ffmpeg.py build/release/bin/tonewright

ffmpeg reads float EXR, whose pixels are the codes that the LUT takes, and writes float EXR: no 8-bit step, no swscale.
Real pictures join the test chart where they are found, see pictures.shared_picture. The last line is
`N passed, M failed`.
"""

import argparse
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

from pictures import (PROJECT, Report, acescct_decode, acescct_encode, evaluate, log2_decode, log2_encode, need_program,
                      read_exr, read_rgb, run, shared_picture, skip, stack, unstack, write_exr)

sys.path.insert(0, str(PROJECT / "python_check"))
import operators  # noqa: E402  (matrices from the chromaticities, a second opinion on the program's)

# ffmpeg interpolates in float32: a sum of four products of numbers up to 1.
FLOAT32 = 1e-6
# Colours compared with the operator; `eval` reads text, a million lines would take longer than they tell.
SAMPLES = 20000

# --------------------------------------------------------------------------------------------------
# The .cube file, read and interpolated in float64


def read_cube(path):
    """(table, error): (n, 3) for a 1D file, (blue, green, red, 3) for a cube; error is what its comments state."""
    lines = path.read_text().splitlines()
    keys = {line.split()[0]: line.split()[1:] for line in lines if re.match("[A-Z]", line)}
    for key, expected in (("DOMAIN_MIN", 0), ("DOMAIN_MAX", 1)):
        if any(float(v) != expected for v in keys.get(key, [])):
            raise ValueError(f"{path.name}: {key} is {keys[key]}; ffmpeg reads no other domain than 0..1")
    table = np.array([line.split() for line in lines if re.match("[-0-9.]", line)], float)
    if "LUT_3D_SIZE" in keys:
        n = int(keys["LUT_3D_SIZE"][0])
        table = table.reshape(n, n, n, 3)
    error = float(re.search(r"^# Error .* max ([^,]+),", "\n".join(lines), re.M).group(1))
    return table, error


def tetrahedral(table, code):
    """A cube at (n, 3) codes: the six tetrahedra are the six orders of the fractions, largest first."""
    n = len(table)
    at = np.clip(code, 0, 1) * (n - 1)
    corner = np.minimum(at.astype(int), n - 2)
    fraction = at - corner
    order = np.argsort(-fraction, axis=1, kind="stable")
    sorted_fraction = np.take_along_axis(fraction, order, axis=1)
    weights = -np.diff(sorted_fraction, axis=1, prepend=1, append=0)
    out = np.zeros((len(code), 3))
    for step in range(4):
        if step:
            corner[np.arange(len(code)), order[:, step - 1]] += 1
        out += weights[:, step, None] * table[corner[:, 2], corner[:, 1], corner[:, 0]]
    return out


def linear(table, code):
    n = len(table)
    return np.stack([np.interp(code[:, c], np.arange(n) / (n - 1), table[:, c]) for c in range(3)], axis=1)


# --------------------------------------------------------------------------------------------------


def through_ffmpeg(codes, filter_, scratch):
    """Codes (height, width, 3) through a filter. ffmpeg runs in the folder: its filter syntax cannot quote any path."""
    write_exr(scratch / "codes.exr", unstack(codes))
    run("ffmpeg", "-v", "error", "-nostdin", "-y", "-i", "codes.exr", "-vf", filter_, "-pix_fmt", "gbrpf32le",
        "-update", 1, "-frames:v", 1, "graded.exr", folder=scratch)
    return stack(read_exr(scratch / "graded.exr"))


def compare(report, command, what, codes, graded, table, stated, interpolate, decode, arguments):
    """Graded codes against the file's numbers, and those inside the LUT's domain against the operator."""
    codes, graded = codes.reshape(-1, 3), graded.reshape(-1, 3)
    report.compare(f"{what}, against the file", graded, interpolate(table, codes.astype(float)), FLOAT32)
    inside = np.flatnonzero(((codes >= 0) & (codes <= 1)).all(axis=1))
    chosen = np.random.default_rng(3).permutation(inside)[:SAMPLES]
    truth = evaluate(command, decode(codes[chosen].astype(float)), *arguments)
    report.compare(f"{what}, against the operator ({len(chosen)})", graded[chosen], truth, stated + FLOAT32)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    command = parser.parse_args().command.resolve()
    need_program("ffmpeg", "ffmpeg")
    need_program("oiiotool", "openimageio-tools")
    if " exr " not in run("ffmpeg", "-v", "error", "-encoders"):
        skip("ffmpeg has no EXR encoder (older than 5.0)")
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as folder:
        scratch = Path(folder)
        run(command, "chart", "-o", scratch / "chart.exr", "--width", 768, "--height", 432)
        memorial = shared_picture("memorial.hdr")
        pictures = [scratch / "chart.exr"] + ([memorial] if memorial else [])
        to_ap1 = operators.rgb_to_rgb("rec709", "ap1").T

        run(command, "bake", "agx_sobotka", "--format", "cube", "--size", 33, "--input-encoding", "acescct",
            "-o", scratch / "agx.cube")
        cube, stated = read_cube(scratch / "agx.cube")
        report.bound("agx.cube: entries, as 33^3", abs(cube.size - 3 * 33**3), 0.5)
        # Uniform random codes reach every cell of the cube, and -0.1 and 1.1 what is outside.
        random = np.random.default_rng(1).uniform(-0.1, 1.1, (128, 128, 3))
        run(command, "bake", "hable", "--format", "cube", "--input-encoding", "log2", "-o", scratch / "hable.cube")
        curve, curve_stated = read_cube(scratch / "hable.cube")
        for name, rgb in [(p.name, read_rgb(p, scratch).astype(float)) for p in pictures] + [("random", None)]:
            codes = (random if rgb is None else acescct_encode(rgb @ to_ap1)).astype(np.float32)
            graded = through_ffmpeg(codes, "lut3d=agx.cube:interp=tetrahedral", scratch)
            compare(report, command, f"{name}, lut3d agx_sobotka", codes, graded, cube, stated, tetrahedral,
                    acescct_decode, ("agx_sobotka", "--input", "lin_ap1"))
            codes = (random if rgb is None else log2_encode(rgb)).astype(np.float32)
            graded = through_ffmpeg(codes, "lut1d=hable.cube:interp=linear", scratch)
            compare(report, command, f"{name}, lut1d hable", codes, graded, curve, curve_stated, linear,
                    log2_decode, ("hable",))
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
