# SPDX-License-Identifier: Apache-2.0
"""Known defects: `tonewright verify --lut` recognizes each of them, and nothing else shows them.

    python3 -m pytest tests/parity/test_defects.py --tonewright build/release/bin/tonewright

The LUTs come from the NumPy formulas of python_check, not from the program.
"""

import json
import subprocess

import numpy as np
import operators
from pictures import PROJECT, log2_decode, run, share_of

# Each defect and the operator that it should have been, with the settings of that operator.
MEANT = {
    "aces_hill_misplaced_bracket": ("aces_hill:threejs", {"prescale": 1 / 0.6}),
    "aces_hill_misprinted_product": ("aces_hill", {}),
    "agx_matrix_and_power": ("agx_blender", {}),
    "agx_minimal_clamped": ("agx_minimal", {}),
    "hable_bias_on_result": ("hable", {}),
    "nebula_as_printed": ("nebula", {}),
    "uchimura_misprinted": ("uchimura", {}),
}
# The misplaced bracket changes 0.0007 of the code in the mean. A grid of 33 is off by more than that from either.
SIZES = {"aces_hill_misplaced_bracket": 65}


def write_cube(path, size, operator, settings):
    """From log2 codes of Rec.709 light, 10 stops below to 6.5 above mid-gray, to sRGB."""
    axis = np.arange(size) / (size - 1)
    b, g, r = np.meshgrid(axis, axis, axis, indexing="ij")
    light = log2_decode(np.stack([r, g, b], axis=-1).reshape(-1, 3))
    np.savetxt(path, operators.view(operator, light, settings), fmt="%.7g", header=f"LUT_3D_SIZE {size}", comments="")


def test_recognized(report, command, scratch):
    report.check("every defect has a LUT here", set(MEANT) == set(operators.DEFECTS), set(operators.DEFECTS) ^ set(MEANT))
    how = "log2:-10:6.5 input (lin_rec709) and srgb output, max error "
    for defect, (meant, settings) in share_of(list(MEANT.items()), 2):
        path = scratch / f"{defect}.cube"
        write_cube(path, SIZES.get(defect, 33), defect, {})
        line = run(command, "verify", "--lut", path).splitlines()[0]
        report.check(f"{defect}: verify --lut says so in one line",
                     line.startswith(f"{path} is {meant} as ") and " has it, a defect: " in line
                     and f". It has {how}" in line, line)
        write_cube(path, SIZES.get(defect, 33), meant.split(":")[0], settings)
        line = run(command, "verify", "--lut", path).splitlines()[0]
        report.check(f"{defect}: not said of {meant}", line.startswith(f"{path} is {meant} with {how}"), line)
    write_cube(path, 33, "hable_bias_on_result", {})
    best = json.loads(run(command, "verify", "--json", "--lut", path))[0]
    report.check("JSON", (best["operator"], best["meant"]) == ("hable_bias_on_result", "hable")
                 and "exposure bias" in best["defect"], best)
    line = run(command, "verify", "--lut", path, "hable").splitlines()[0]
    report.check("where operators are named, only those count", line == f"{path} is none of these; the nearest:", line)


def test_hidden(report, command, scratch):
    """What the program lists and writes of all operators, and what it suggests. The committed files are golden."""
    texts = {" ".join(arguments): run(command, *arguments) for arguments in (
        ["--help-all"], ["list"], ["list", "--json"], ["list", "--markdown"], ["shader", "--list"], ["list", "agx_minimal"],
        *([name, "--help"] for name in ("apply", "bake", "compare", "config", "eval", "plot", "shader", "verify")))}
    for path in (PROJECT / "docs" / "operators.md", *PROJECT.glob("docs/operators/*.md"), PROJECT / "luts" / "MANIFEST.csv", *PROJECT.glob("ocio_config/*.ocio")):
        texts[path.name] = path.read_text()
    report.check("the texts name operators", all("agx_minimal" in texts[t] for t in ("list", "list --json", "operators.md")))
    for what, text in texts.items():
        shown = [defect for defect in MEANT if defect in text]
        report.check(f"in {what}: none", not shown, shown)
    for defect in MEANT:
        for arguments in (["eval", defect], ["apply", "in.exr", "out.png", "--operator", defect], ["list", defect],
                          ["bake", defect, "-o", scratch / "out.cube"], ["eval", defect + "x"]):
            done = subprocess.run([command, *arguments], input="", capture_output=True, text=True, check=False)
            answer = done.stderr.partition("; expected")[2]
            report.check(f"{arguments[0]} {defect}", done.returncode == 2 and done.stderr.count("\n") == 1 and answer
                         and not any(other in answer for other in MEANT), done.stderr)
