# SPDX-License-Identifier: Apache-2.0
"""PNG and JPEG files of `tonewright apply` in programs of other libraries: each opens them and finds the same pixels.

PNG files have several blocks, which the command deflates by themselves and joins to one stream.
"""
import shutil
import subprocess

import numpy as np
import pytest
from pictures import need_program, read_rgb, run

WIDTH, HEIGHT = 1100, 700


@pytest.fixture(scope="module")
def folder(command, folder):
    """With the chart as PNG files of both depths, and as JPEG."""
    run(command, "chart", "-o", folder / "scene.exr", "--width", WIDTH, "--height", HEIGHT, "-q")
    for bits in (8, 16):
        run(command, "apply", folder / "scene.exr", folder / f"{bits}.png", "--operator", "hable", "-d", f"uint{bits}", "-q")
    run(command, "apply", folder / "scene.exr", folder / "8.jpg", "--operator", "hable", "-q")
    return folder


def codes(path, bits, scratch):
    """Code values by OpenImageIO's libpng."""
    return np.round(np.asarray(read_rgb(path, scratch), float) * (2**bits - 1)).astype(int)


def pixels(bits, *arguments):
    """Code values that a program writes to its output."""
    data = subprocess.run(arguments, capture_output=True, check=True).stdout
    return np.frombuffer(data, ">u2" if bits == 16 else np.uint8).astype(int).reshape(HEIGHT, WIDTH, 3)


@pytest.mark.parametrize("bits", [8, 16])
def test_pngcheck(report, folder, bits):
    need_program("pngcheck", "pngcheck")
    done = subprocess.run(["pngcheck", "-v", folder / f"{bits}.png"], capture_output=True, check=False, text=True)
    report.check(f"pngcheck of {bits} bits", done.returncode == 0 and "No errors detected" in done.stdout, done.stdout)


@pytest.mark.parametrize("bits", [8, 16])
def test_png_in_magick(report, folder, scratch, bits):
    program = "magick" if shutil.which("magick") else "convert"
    need_program(program, "imagemagick")
    # A quantum of 16 bits keeps all codes.
    found = pixels(bits, program, folder / f"{bits}.png", "-depth", str(bits), "-endian", "MSB", "rgb:-")
    report.check(f"ImageMagick, {bits} bits", np.array_equal(found, codes(folder / f"{bits}.png", bits, scratch)))


@pytest.mark.parametrize("bits", [8, 16])
def test_png_in_ffmpeg(report, folder, scratch, bits):
    need_program("ffmpeg", "ffmpeg")
    found = pixels(bits, "ffmpeg", "-v", "error", "-i", folder / f"{bits}.png", "-f", "rawvideo", "-pix_fmt",
                   "rgb48be" if bits == 16 else "rgb24", "-")
    report.check(f"ffmpeg, {bits} bits", np.array_equal(found, codes(folder / f"{bits}.png", bits, scratch)))


def test_jpeg_in_ffmpeg(report, folder, scratch):
    need_program("ffmpeg", "ffmpeg")
    found = pixels(8, "ffmpeg", "-v", "error", "-i", folder / "8.jpg", "-f", "rawvideo", "-pix_fmt", "rgb24", "-")
    # Inverse transforms may differ by one code in Y and Cb: B = Y + 1.772 Cb (ITU-T T.871) makes 2.8 of them.
    difference = abs(found - codes(folder / "8.jpg", 8, scratch)).max()
    report.check(f"ffmpeg, JPEG: {difference} codes", difference <= 3)
