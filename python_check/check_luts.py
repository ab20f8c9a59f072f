# SPDX-License-Identifier: Apache-2.0
"""The shipped LUTs: the errors in their headers and in MANIFEST.csv, found once more without the program.

    python3 python_check/check_luts.py build/release/bin/tonewright luts

Light, its encoding, the interpolation and the operator are NumPy's: lut_encodings.py, lut_tables.py, operators/. The
light is the sample set as src/measure/sample_set.h describes it, drawn anew. Some of it goes through `tonewright eval` as well.
Pictures are read by OpenImageIO. Each run takes half of the files, which the commit picks; `./run test --all` takes all.
The last line is `N passed, M failed`.
"""

import argparse
import csv
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import operators
from lut_encodings import ENCODINGS, srgb_decode
from lut_tables import hald_cube, linear, read_cube, stated_errors, strip_cube, tetrahedral, trilinear
from operators.pq import pq_encode
from operators.spaces import PRIMARIES, rgb_to_rgb

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "parity" / "clients"))
from pictures import LIGHT, Report, evaluate, need_program, read_rgb, share_of  # noqa: E402

# Printed numbers are rounded up to three digits: 1 % at most. The rest is for colors that another order of arithmetic
# puts on the other side of an end of the encoding, or another compiler's order of near-black channels.
REPRODUCED = 0.02
# Errors that are less are of the numbers' own decimals.
NOTHING = 1e-7
# Two ways of computing the same in double: powers, and matrices of twelve digits.
SAME = 1e-9

INTERPOLATIONS = {"tetrahedral": tetrahedral, "trilinear": trilinear}


class SplitMix64:
    """Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014."""

    def __init__(self, seed):
        self.state = np.uint64(seed)

    def uniform(self, lo, hi, count):
        with np.errstate(over="ignore"):
            steps = self.state + np.arange(1, count + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
            self.state = steps[-1]
            z = (steps ^ (steps >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
            z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            z = z ^ (z >> np.uint64(31))
        return lo + (hi - lo) * ((z >> np.uint64(11)).astype(float) * 2.0**-53)


def primaries_of(row, encoding):
    """Primaries of the input light: the encoding's own, or others that the row names."""
    return PRIMARIES.get(row["input_space"].removeprefix("lin_"), encoding.primaries)


def samples(encoding, primaries, count=50000, edge=17):
    """Scene-linear light in these primaries that the encoding holds, as float32: (n, 3)."""
    parts = [[[0, 0, 0]], np.repeat(0.18 * 2.0 ** (np.arange(-768, 769) / 64)[:, None], 3, axis=1)]
    lattice = np.stack(np.meshgrid(*3 * [np.arange(edge)], indexing="ij"), axis=-1).reshape(-1, 3) / (edge - 1)
    for gamut in ("rec709", "rec2020", "ap1"):
        to_input = rgb_to_rgb(PRIMARIES[gamut], primaries)
        parts += [lattice * 2.0**stops @ to_input.T for stops in (-6, -2, 0, 3, 6)]
    random = SplitMix64(20021)
    colors = 2 ** random.uniform(-16, 12, 3 * count).reshape(-1, 3)
    tenth = np.arange(0, count, 10)
    colors[tenth, tenth // 10 % 3] = 0
    # Drawn as arguments of a function, which GCC evaluates from the last on.
    near_black = 2 ** random.uniform(-148, -10, 3 * (count // 20)).reshape(-1, 3)[:, ::-1]
    parts += [colors, near_black]
    signed = 2 ** random.uniform(-12, 12, 3 * (count // 5)).reshape(-1, 3)
    at = np.arange(len(signed))
    signed[at, at % 3] *= -1
    signed[at[1::2], (at[1::2] % 3 + 1) % 3] *= -1
    parts += [signed, encoding.decode(SplitMix64(7).uniform(0, 1, 3 * count).reshape(3, -1).T)]
    light = np.concatenate(parts).astype(np.float32).astype(float)
    lo, hi = encoding.decode(np.array([0.0, 1.0]))
    return light[((light >= lo) & (light <= hi)).all(axis=1)]


# ITU-R BT.2100-2: linear Rec.2020 to LMS, its PQ to ICtCp.
REC2020_TO_LMS = np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096
LMS_TO_ICTCP = np.array([[2048, 2048, 0], [6610, -13613, 7003], [17933, -17390, -543]]) / 4096
# Codes of a display to light, 1 at 100 cd/m2.
LIGHT_OF = {"srgb": srgb_decode, "rec1886": lambda code: np.maximum(code, 0) ** 2.4}


def itp(codes, display):
    """I, T and P of ITU-R BT.2124, times 720, of Rec.709 codes."""
    light = LIGHT_OF[display](codes) @ rgb_to_rgb(PRIMARIES["rec709"], PRIMARIES["rec2020"]).T
    return 720 * (pq_encode(100 * (light @ REC2020_TO_LMS.T)) @ LMS_TO_ICTCP.T * [1, 0.5, 1])


def read_table(path, form, scratch):
    """(table, {interpolation: errors} of its text)."""
    if form == "cube":
        table, lines = read_cube(path)
        return table, stated_errors(lines)
    return (hald_cube if form == "hald" else strip_cube)(read_rgb(path, scratch)), {}


def figures(errors):
    """max, 99.9 %, mean."""
    errors = np.sort(errors)
    return errors[-1], errors[int(0.999 * (len(errors) - 1))], errors.mean()


def check_figures(report, what, stated, found):
    """The largest error is that of all colors: of the sample set it may be less, never more."""
    report.check(f"{what}: max {found[0]:.3g} of {stated[0]:.3g}", found[0] <= stated[0] * (1 + REPRODUCED) + NOTHING)
    check_relative(report, what, stated[1:], found[1:])


def check_relative(report, what, stated, found):
    relative = [abs(s - f) / f if f > NOTHING else abs(s - f) for s, f in zip(stated, found)]
    report.bound(f"{what}: {', '.join(f'{f:.3g}' for f in found)}", max(relative), REPRODUCED,
                 f"stated {stated}, found {found}")


def check_luts(report, command, folder, rows, scratch):
    """All LUTs of one operator, encoding and output: of the same light."""
    first = rows[0]
    encoding, name = ENCODINGS[first["input_encoding"].split(":")[0]], first["operator"]
    primaries = primaries_of(first, encoding)
    light = samples(encoding, primaries)
    to_rec709 = rgb_to_rgb(primaries, PRIMARIES["rec709"])
    truth = operators.view(name, light @ to_rec709.T, display=first["output"])
    some = np.random.default_rng(2).choice(len(light), 200, replace=False)
    said = evaluate(command, light[some], name, "--input", first["input_space"], "--display", first["output"],
                    "--digits", 17)
    report.compare(f"{name}, {first['input_space']} to {first['output']}, by eval and by NumPy", said, truth[some],
                   SAME, LIGHT.get(first["output"]))
    codes, seen = encoding.encode(light), itp(truth, first["output"]) if first["output"] in LIGHT_OF else None
    for row in rows:
        table, stated = read_table(folder / row["path"], row["format"], scratch)
        found = {}
        for how, interpolate in INTERPOLATIONS.items():
            shown = (interpolate if table.ndim == 4 else linear)(table, codes)
            found[how] = figures(np.abs(shown - truth).max(axis=1))
            in_manifest = [float(row[f"{how}_{figure}"]) for figure in ("max", "p999", "mean")]
            check_figures(report, f"{row['path']}, {how}, MANIFEST", in_manifest, found[how])
            if seen is not None:
                colors = figures(np.sqrt(((itp(shown, first["output"]) - seen) ** 2).sum(axis=1)))
                in_manifest = [float(row[f"{how}_{figure}_dE_ITP"]) for figure in ("max", "p999", "mean")]
                check_relative(report, f"{row['path']}, {how}, MANIFEST, dE ITP", in_manifest, colors)
        found["linear"] = found["tetrahedral"]  # of a 1D table
        for how, three in stated.items():
            check_figures(report, f"{row['path']}, {how}, header", three, found[how])
        if row["format"] == "cube":
            report.check(f"{row['path']}: its header has the error of the host's interpolation",
                         row["host_interpolation"] in stated, stated)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    parser.add_argument("luts", type=Path)
    arguments = parser.parse_args()
    need_program("oiiotool", "openimageio-tools")
    report, groups = Report(), {}
    with open(arguments.luts / "MANIFEST.csv", newline="") as manifest:
        for row in csv.DictReader(manifest):
            key = (row["operator"], row["input_encoding"], row["input_space"], row["output"])
            groups.setdefault(key, []).append(row)
    listed = {row["path"] for rows in groups.values() for row in rows}
    there = {str(p.relative_to(arguments.luts)) for p in arguments.luts.rglob("*")
             if p.is_file() and p.parent.name != "thumbnails" and p.parent != arguments.luts}
    report.check(f"MANIFEST.csv lists the {len(there)} files that are there", listed == there,
                 sorted(listed ^ there)[:5])
    with tempfile.TemporaryDirectory(prefix="tonewright-") as folder, ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda rows: check_luts(report, arguments.command.resolve(), arguments.luts, rows, Path(folder)),
                      share_of(groups.values(), 2)))
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
