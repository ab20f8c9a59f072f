# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of programs that read lookup tables: LUTs, a picture of their codes, what is to come out.

Each program's output is compared twice: with what the numbers in the file give by the interpolation that the program
has (its bound is the program's arithmetic), and with the operator itself (its bound is the error that `bake` stated).
"""

import functools
import os
import re
import subprocess
from typing import NamedTuple

import numpy as np
from lut_tables import hald_cube, read_cube
from pictures import evaluate, log2_decode, need_program, read_rgb, run, skip, unstack, write_exr

# AgX as Sobotka has it, of log2 light: every channel of its picture depends on all three in another way, so no channel
# or axis can be taken for another; and its cube of 33 is 1.4e-3 from it, so little that the operator is seen.
OPERATOR = "agx_sobotka"
ENCODING = "log2"
# Codes of 16 bits are rounded twice at most, going in as well as coming out: half a unit each, and the program's sum.
BITS16 = 2.5e-5
# A sum of four or eight products of floats up to 1, and the index's own rounding times the table's steps.
FLOAT32 = 1e-6


def bake(command, path, *arguments):
    """A LUT file; returns the largest error that the command says it has."""
    done = subprocess.run([str(command), "bake", *map(str, arguments), "-o", str(path)], capture_output=True, text=True,
                          check=False)
    if done.returncode:
        raise RuntimeError(f"bake {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return float(re.search(r"error max ([^,]+),", done.stderr)[1])


# --------------------------------------------------------------------------------------------------
# The picture

WIDTH, HEIGHT = 256, 128


def codes():
    """Codes of 16 bits as floats: ramps of white, primaries and their complements, two crossed ramps, random ones."""
    ramp = np.linspace(0, 1, WIDTH)
    rgb = np.random.default_rng(5).uniform(0, 1, (HEIGHT, WIDTH, 3))
    for row, color in enumerate(((1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0))):
        rgb[4 * row:4 * row + 4] = ramp[:, None] * np.array(color)
    rgb[28:60, :, 0] = ramp
    rgb[28:60, :, 1] = np.linspace(0, 1, 32)[:, None]
    rgb[28:60, :, 2] = 0.25
    return (np.round(rgb * 65535) / 65535).astype(np.float32)


@functools.cache
def truth(command):
    """The operator's colors for all codes."""
    return evaluate(command, log2_decode(codes().reshape(-1, 3).astype(float)), OPERATOR)


def write_picture(path, rgb, depth="uint16"):
    """A picture of codes, through oiiotool, which is told that they are sRGB: or a PNG would say that they are linear."""
    plain = path.with_name(path.name + ".exr")
    write_exr(plain, unstack(rgb))
    if path.suffix != ".exr":
        run("oiiotool", plain, "--iscolorspace", "sRGB", "-d", depth, "-o", path)
        plain.unlink()
    else:
        plain.rename(path)


class LutTest:
    """A program's output for the codes, against a file's numbers and against the operator."""

    def __init__(self, report, command, scratch, client):
        runner = client.runner()
        self.command, self.scratch, self.client, self.version = command, scratch, client, version_of(client, runner)
        self.program = [*runner, client.program]
        self.report, self.codes, self.rows = report, codes(), []
        self.flat, self.truth = self.codes.reshape(-1, 3).astype(float), truth(command)
        print(self.version)

    def bake(self, host, name, *arguments):
        """(path, stated error) of the operator's LUT for an application, of log2 codes: as `list --hosts` has it for
        the rest, with the error of the application's own interpolation."""
        path = self.scratch / name
        return path, bake(self.command, path, OPERATOR, "--for", host, "--input-encoding", ENCODING,
                          "--display", "srgb", "--nodes", "sampled", *arguments)

    def cube(self, host, size=33):
        """(path, table, stated error) of a .cube."""
        path, stated = self.bake(host, f"{host}{size}.cube", "--size", size)
        return path, read_cube(path)[0], stated

    def hald(self, host):
        """(path, table, stated error) of a Hald CLUT."""
        path, stated = self.bake(host, f"{host}.png", "--size", 36)
        return path, hald_cube(read_rgb(path, self.scratch)), stated

    def picture(self, name, depth="uint16"):
        path = self.scratch / name
        write_picture(path, self.codes, depth)
        return path

    def compare(self, what, shown, predicted, stated, bound, clips=True):
        """shown: (height, width, 3) or (n, 3). stated: the largest error of the file, by bake."""
        shown = np.asarray(shown, float).reshape(-1, 3)
        if clips:
            predicted = np.clip(predicted, 0, 1)
        self.report.compare(f"{what}, against the file", shown, predicted, bound)
        self.report.compare(f"{what}, against the operator", shown, self.truth, stated + bound)
        if shown.shape == predicted.shape:
            self.row(what, shown - predicted, bound, shown - self.truth, stated + bound)

    def row(self, what, near, near_bound, far, far_bound):
        """A row of the table in docs/clients.md: differences from the file's numbers and from the operator."""
        self.rows.append(f"| {self.version} | {what} | {np.abs(near).max():.1e} | {near_bound:.1e} "
                         f"| {np.abs(far).max():.1e} | {far_bound:.1e} |")


class Client(NamedTuple):
    """A program; where it is newer, the one that `$TONEWRIGHT_NEWER_PROGRAMS PROGRAM ...` runs."""
    title: str
    program: str
    package: str
    version: str
    newer: bool = False

    def __str__(self):
        return f"newer_{self.program}" if self.newer else self.program

    def runner(self):
        """The words before the name of the program. Skips the test where it is missing."""
        words = [os.environ.get("TONEWRIGHT_NEWER_PROGRAMS", "")] if self.newer else []
        if words == [""]:
            skip("TONEWRIGHT_NEWER_PROGRAMS is not set")
        for program, package in [(self.program, self.package), ("oiiotool", "openimageio-tools")][self.newer:]:
            need_program(program, package)
        return words


def version_of(client, runner=()):
    """`G'MIC 2.9.4`, by what the program says of itself."""
    try:
        done = subprocess.run([*runner, *client.version.split()], capture_output=True, text=True, check=False)
        number = re.search(r"\d+(\.\d+)+", done.stdout + done.stderr)
    except FileNotFoundError:
        number = None
    return f"{client.title} {number[0] if number else '(unknown version)'}"
