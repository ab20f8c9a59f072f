# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of programs that read lookup tables: LUTs, a picture of their codes, what is to come out.

Each program's output is compared twice: with what the numbers in the file give by the interpolation that the program
has (its bound is the program's arithmetic), and with the operator itself (its bound is the error that `bake` stated).
"""

import argparse
import collections
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from pictures import Report, evaluate, log2_decode, need_program, read_rgb, run, unstack, write_exr

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
# Files, and what is between their nodes, in float64


def read_cube(path):
    """(table, error): (n, 3) for a 1D file, (blue, green, red, 3) for a cube; error is what its comments state."""
    lines = path.read_text().splitlines()
    keys = {line.split()[0]: line.split()[1:] for line in lines if re.match("[A-Z]", line)}
    for key, expected in (("DOMAIN_MIN", 0), ("DOMAIN_MAX", 1)):
        if any(float(v) != expected for v in keys.get(key, [])):
            raise ValueError(f"{path.name}: {key} is {keys[key]}; programs agree about no other domain than 0..1")
    table = np.array([line.split() for line in lines if re.match("[-0-9.]", line)], float)
    if "LUT_3D_SIZE" in keys:
        n = int(keys["LUT_3D_SIZE"][0])
        table = table.reshape(n, n, n, 3)
    error = float(re.search(r"^# Error .* max ([^,]+),", "\n".join(lines), re.M).group(1))
    return table, error


def read_hald(path, scratch):
    """The nodes of a Hald CLUT as (blue, green, red, 3)."""
    nodes = read_rgb(path, scratch).astype(float).reshape(-1, 3)
    n = round(len(nodes) ** (1 / 3))
    return nodes.reshape(n, n, n, 3)


def cell_of(table, code):
    """(the node below, the place in its cell in 0..1) of (n, 3) codes, red first."""
    at = np.clip(code, 0, 1) * (len(table) - 1)
    corner = np.minimum(at.astype(int), len(table) - 2)
    return corner, at - corner


def tetrahedral(table, code):
    """A cube at (n, 3) codes: the six tetrahedra are the six orders of the fractions, largest first."""
    corner, fraction = cell_of(table, code)
    order = np.argsort(-fraction, axis=1, kind="stable")
    sorted_fraction = np.take_along_axis(fraction, order, axis=1)
    weights = -np.diff(sorted_fraction, axis=1, prepend=1, append=0)
    out = np.zeros((len(code), 3))
    for step in range(4):
        if step:
            corner[np.arange(len(code)), order[:, step - 1]] += 1
        out += weights[:, step, None] * table[corner[:, 2], corner[:, 1], corner[:, 0]]
    return out


def trilinear(table, code):
    corner, fraction = cell_of(table, code)
    out = np.zeros((len(code), 3))
    for step in np.ndindex(2, 2, 2):
        weight = np.where(step, fraction, 1 - fraction).prod(axis=1)
        r, g, b = (corner + step).T
        out += weight[:, None] * table[b, g, r]
    return out


def linear(table, code):
    n = len(table)
    return np.stack([np.interp(code[:, c], np.arange(n) / (n - 1), table[:, c]) for c in range(3)], axis=1)


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


def write_picture(path, rgb, depth="uint16"):
    """A picture of codes, through oiiotool: which is told that they are sRGB, or a PNG would say that they are linear."""
    plain = path.with_name(path.name + ".exr")
    write_exr(plain, unstack(rgb))
    if path.suffix != ".exr":
        run("oiiotool", plain, "--iscolorspace", "sRGB", "-d", depth, "-o", path)
        plain.unlink()
    else:
        plain.rename(path)


class LutTest:
    """What a program makes of the codes, against a file's numbers and against the operator."""

    def __init__(self, command, scratch, client):
        self.command, self.scratch, self.client, self.version = command, scratch, client, version_of(client)
        self.report, self.codes, self.rows = Report(), codes(), []
        flat = self.codes.reshape(-1, 3).astype(float)
        self.flat = flat
        self.truth = evaluate(command, log2_decode(flat), OPERATOR)
        print(self.version)

    def bake(self, host, name, *arguments):
        """(path, stated error) of the operator's LUT for an application, of log2 codes: as `list --hosts` has it for
        the rest, with the error of the application's own interpolation."""
        path = self.scratch / name
        return path, bake(self.command, path, OPERATOR, "--for", host, "--input-encoding", ENCODING, "--display", "srgb",
                          "--nodes", "sampled", *arguments)

    def cube(self, host, size=33):
        """(path, table, stated error) of a .cube."""
        path, stated = self.bake(host, f"{host}{size}.cube", "--size", size)
        return path, read_cube(path)[0], stated

    def hald(self, host):
        """(path, table, stated error) of a Hald CLUT."""
        path, stated = self.bake(host, f"{host}.png", "--size", 36)
        return path, read_hald(path, self.scratch), stated

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

    def finish(self):
        """Rows as docs/clients.md has them, then the exit status."""
        print(*self.rows, sep="\n")
        return self.report.finish()


Client = collections.namedtuple("Client", "title program package version")


def version_of(client):
    """`G'MIC 2.9.4`, by what the program says of itself."""
    done = subprocess.run(client.version.split(), capture_output=True, text=True, check=False)
    number = re.search(r"\d+(\.\d+)+(-\d+)?", done.stdout + done.stderr)
    return f"{client.title} {number[0] if number else '(unknown version)'}"


def lut_test(doc, main, *clients, needs=()):
    """Runs main(LutTest) for the command of the arguments, and for one of several clients by its program's name.

    needs: further programs, as (name, Debian package).
    """
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("command", type=Path)
    if len(clients) > 1:
        parser.add_argument("program", choices=[client.program for client in clients])
    arguments = parser.parse_args()
    client = next(c for c in clients if len(clients) == 1 or c.program == arguments.program)
    for program, package in [(client.program, client.package), ("oiiotool", "openimageio-tools"), *needs]:
        need_program(program, package)
    with tempfile.TemporaryDirectory(prefix="tonewright-") as folder:
        test = LutTest(arguments.command.resolve(), Path(folder), client)
        main(test)
        return test.finish()
