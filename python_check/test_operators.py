# SPDX-License-Identifier: Apache-2.0
"""Tests operators.py: its doctests, every published row of tests/data/operators.csv, and inner parts.

    [TONEWRIGHT_SHARED=<folder>] python3 test_operators.py

With the folder, reference/check_values.json in it is compared too. The last line is `N passed, M failed`.
"""

import doctest
import json
import os
import sys
from pathlib import Path

import numpy as np

import make_operator_rows
import operators

FLOOR = 1e-3  # errors are relative to max(|expected|, FLOOR), as in operators.csv
counts = {True: 0, False: 0}


def report(what, error, tolerance, detail=""):
    """Print and count one check; NaN fails."""
    ok = bool(error <= tolerance)
    counts[ok] += 1
    print(f"{'ok  ' if ok else 'FAIL'} {what:80s} {error:8.1e} {error / tolerance:8.2g} x tolerance")
    if not ok and detail:
        print(f"  {detail}")


def relative_error(actual, expected):
    actual, expected = np.asarray(actual, float), np.asarray(expected, float)
    return np.max(np.abs(actual - expected) / np.maximum(np.abs(expected), FLOOR))


def check_doctests():
    for module in (operators, make_operator_rows):
        result = doctest.testmod(module)
        report(f"{module.__name__}: {result.attempted} examples, failures", result.failed, 0.5)


def check_rows():
    """Each group of rows with one operator, settings, look, output and origin."""
    groups = {}
    for row in make_operator_rows.read_rows():
        if row["operator"] in operators.OPERATORS:
            key = [row[c] for c in ("operator", "settings", "look", "output", "origin", "tolerance")]
            groups.setdefault(tuple(key), []).append(row)
    for (operator, settings, look, output, origin, tolerance), rows in groups.items():
        rgb = [[float(row[c]) for c in ("in_r", "in_g", "in_b")] for row in rows]
        expected = [[float(row[c]) for c in ("out_r", "out_g", "out_b")] for row in rows]
        actual = operators.view(operator, rgb, make_operator_rows.parse_settings(settings), look, display=output)
        shown = settings if len(settings) < 40 else settings[:36] + "..."
        name = " ".join(filter(None, (operator, shown, look, output, f"({len(rows)})", origin.split(":")[0])))
        report(name, relative_error(actual, expected), float(tolerance), f"is {actual.tolist()}, expected {expected}")


def check_parts():
    """What the sources state about their own constants."""
    to_ap1 = operators.rgb_to_rgb("rec709", "ap1")

    def saturation(s):  # ACES: lerp from AP1 luminance
        return s * np.eye(3) + (1 - s) * operators.rgb_to_xyz("ap1")[1]

    # Hill prints five decimals; ours from the chromaticities, with RRT_SAT 0.96 and ODT_SAT 0.93.
    report("Hill's input matrix", np.abs(saturation(0.96) @ to_ap1 - operators.HILL_IN).max(), 6e-6)
    report("Hill's output matrix", np.abs(np.linalg.solve(to_ap1, saturation(0.93)) - operators.HILL_OUT).max(), 6e-6)
    # Wrensch and three.js print the inverse inset instead of inverting.
    printed = [[1.19687900512017, -0.0980208811401368, -0.0990297440797205],
               [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
               [-0.0529716355144438, -0.0980434501171241, 1.15107367264116]]
    report("inverse AgX inset as printed", np.abs(np.linalg.inv(operators.AGX_INSET) - printed).max(), 1e-14)
    # ITU-R BT.2087-0 prints four decimals of Rec.709 -> Rec.2020.
    bt2087 = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
    report("Rec.709 -> Rec.2020 as BT.2087 prints it",
           np.abs(operators.rgb_to_rgb("rec709", "rec2020") - bt2087).max(), 5.1e-5)


def sobotka_table(n):
    """The sigmoid as AgX_Default_Contrast.spi1d stores it: 4096 entries, seven decimals, linear between them."""
    nodes = np.arange(4096) / 4095
    return np.interp(n, nodes, operators.agx_sigmoid(nodes).round(7))


def check_sobotka_table():
    """With the table his figures come out to 12 digits: so the wider tolerance of those rows is due to it alone."""
    errors = []
    for row in make_operator_rows.read_rows():
        if row["origin"].startswith("agx_sobotka_"):
            rgb = operators.limit_scene([float(row[c]) for c in ("in_r", "in_g", "in_b")])
            code = sobotka_table(operators.agx_shape(rgb @ operators.AGX_INSET.T))
            if row["look"]:
                code = operators.cdl(code, **operators.AGX_LOOKS[row["look"]])
            errors.append(relative_error(code, [float(row[c]) for c in ("out_r", "out_g", "out_b")]))
    report(f"agx_sobotka through a table like the LUT ({len(errors)})", max(errors), 1e-9)


def check_shared(shared):
    """Figures of check_values.json: the committed rows are theirs, and the parts that have no row."""
    published = list(make_operator_rows.published_rows(shared))
    committed = [row for row in make_operator_rows.read_rows()
                 if row["operator"] in operators.OPERATORS and row["origin"] != "python_check/operators.py"]
    missing = [row for row in published if row not in committed]
    report("rows of check_values.json that operators.csv lacks", len(missing), 0.5, missing[:1])
    stray = [row for row in committed if row not in published]
    report("rows of operators.csv that check_values.json lacks", len(stray), 0.5, stray[:1])

    values = json.loads((Path(shared) / "reference" / "check_values.json").read_text())
    sigmoid = {"pivot": (10 / 16.5, 0.18 ** (1 / 2.4)), "slope": 2.4, "powers": (1.5, 1.5)}
    parts = {
        "aces_hill_unclamped": (1e-9, lambda x: operators.hill_curve(x @ operators.HILL_IN.T) @ operators.HILL_OUT.T),
        "agx_sobotka_curve": (1e-9, sobotka_table),
        "agx_sigmoid_SB2383": (1e-9, lambda n: operators.agx_sigmoid(n, **sigmoid)),
    }
    for name, (tolerance, f) in parts.items():
        errors = [relative_error(f(np.array(v["input"])), v["output"]) for v in values if v["operator"] == name]
        report(f"{name} ({len(errors)})", max(errors), tolerance)


def main():
    check_doctests()
    check_rows()
    check_parts()
    check_sobotka_table()
    shared = os.environ.get("TONEWRIGHT_SHARED", "")
    if shared and (Path(shared) / "reference" / "check_values.json").is_file():
        check_shared(shared)
    else:
        print("skip check_values.json: TONEWRIGHT_SHARED names no folder that holds reference/check_values.json")
    print(f"{counts[True]} passed, {counts[False]} failed")
    return 1 if counts[False] else 0


if __name__ == "__main__":
    sys.exit(main())
