# SPDX-License-Identifier: Apache-2.0
"""Writes the rows of tests/data/operators.csv that belong to the operators of operators.py.

    TONEWRIGHT_SHARED=<folder> python3 make_operator_rows.py

Most expected values come from reference/check_values.json in that folder: figures computed from the authors'
own code, or from independent transcriptions of it. operators.py adds what they lack. Rows of other operators
are kept as they are.
"""

import csv
import json
import os
from pathlib import Path

import operators

CSV = Path(__file__).parent.parent / "tests" / "data" / "operators.csv"
COLUMNS = "operator settings look output in_r in_g in_b out_r out_g out_b tolerance origin".split()

EXACT = 1e-9  # the figures have 12 digits; the rest is double arithmetic in another order
# The figures read Sobotka's LUT: 4096 entries of seven decimals, interpolated linearly, up to 1.4e-7 of the value
# off the curve behind the looks. With such a table operators.py gives the figures to 12 digits (test_operators.py).
SOBOTKA_LUT = 2e-7

GODOT = ("shoulder_strength=0.88;linear_strength=0.6;linear_angle=0.1;toe_strength=0.2;toe_numerator=0.01;"
         "toe_denominator=0.3;white=1;exposure_bias=1")
# Name in check_values.json -> operator, settings, look, output, tolerance.
PUBLISHED = {
    "linear_clamp": ("clamp", "", "", "native", EXACT),
    "reinhard_rgb": ("reinhard", "", "", "native", EXACT),
    "reinhard_luminance": ("reinhard", "apply=luminance", "", "native", EXACT),
    "reinhard_extended_rgb": ("reinhard_extended", "white=4", "", "native", EXACT),
    "reinhard_extended_luminance": ("reinhard_extended", "white=4;apply=luminance", "", "native", EXACT),
    "reinhard_jodie": ("reinhard_jodie", "", "", "native", EXACT),
    "hable_uncharted2": ("hable", "", "", "native", EXACT),
    "hable_godot_filmic": ("hable", GODOT, "", "native", EXACT),
    "uchimura_gt": ("uchimura", "", "", "native", EXACT),
    "uchimura_gt_hdr": ("uchimura", "max_brightness=10", "", "native", EXACT),
    "aces_narkowicz": ("aces_narkowicz", "", "", "native", EXACT),
    "aces_narkowicz_0.6": ("aces_narkowicz", "prescale=0.6", "", "native", EXACT),
    "aces_hill": ("aces_hill", "", "", "native", EXACT),
    "agx_sobotka_lut": ("agx_sobotka", "", "", "native", SOBOTKA_LUT),
    "agx_sobotka_punchy": ("agx_sobotka", "", "punchy", "native", SOBOTKA_LUT),
    "agx_sobotka_golden": ("agx_sobotka", "", "golden", "native", SOBOTKA_LUT),
    "agx_minimal_encoded": ("agx_minimal", "", "", "native", EXACT),
    "agx_minimal_linear": ("agx_minimal", "", "", "linear", EXACT),
}

GREY, SATURATED, BRIGHT = (0.18, 0.18, 0.18), (0.8, 0.1, 0.05), (4, 2, 0.5)
BLACK, NEAR_BLACK = (0, 0, 0), (0.0003, 0.0002, 0.0001)
MIXED, NEGATIVE = (-0.1, 0.2, 0.5), (-3, -2, -1)
# Above 65504, the largest half float, every value counts as 65504.
LARGE, BEYOND = (60000, 20000, 500), (1e6, 65504, 70000)
EVERYWHERE = (NEAR_BLACK, MIXED, NEGATIVE, LARGE, BEYOND)
COLOURS = (BLACK, GREY, SATURATED, BRIGHT, *EVERYWHERE)

GDC = "shoulder_strength=0.22;linear_strength=0.3;toe_numerator=0.01"
UCHIMURA = "max_brightness=4;contrast=1.2;linear_start=0.3;linear_length=0.5;black_tightness=2;pedestal=0.02"
# Operator, settings, look, output, colours.
DERIVED = [
    ("clamp", "", "", "native", EVERYWHERE),
    ("reinhard", "", "", "native", EVERYWHERE),
    ("reinhard", "apply=luminance", "", "native", EVERYWHERE),
    ("reinhard", "apply=max", "", "native", COLOURS),
    ("reinhard_extended", "", "", "native", EVERYWHERE),
    ("reinhard_extended", "white=2.5;apply=luminance", "", "native", COLOURS),
    ("reinhard_extended", "white=4;apply=max", "", "native", COLOURS),
    ("reinhard_jodie", "", "", "native", EVERYWHERE),
    ("hable", "", "", "native", EVERYWHERE),
    ("hable", GDC, "", "native", COLOURS),
    ("uchimura", "", "", "native", EVERYWHERE),
    ("uchimura", UCHIMURA, "", "native", COLOURS),
    ("aces_narkowicz", "", "", "native", EVERYWHERE),
    ("aces_hill", "", "", "native", EVERYWHERE),
    ("agx_sobotka", "", "", "native", COLOURS),
    ("agx_sobotka", "", "punchy", "native", COLOURS),
    ("agx_sobotka", "", "golden", "native", COLOURS),
    ("agx_sobotka", "", "", "linear", COLOURS),
    ("agx_minimal", "", "", "native", EVERYWHERE),
    ("agx_minimal", "", "", "linear", EVERYWHERE),
    ("agx_minimal", "order=7", "", "native", COLOURS),
    ("agx_minimal", "order=7", "", "linear", COLOURS),
]


def read_rows():
    """The committed table, as a list of dicts of texts; empty when there is none."""
    if not CSV.exists():
        return []
    with CSV.open(newline="") as f:
        return list(csv.DictReader(f))


def parse_settings(text):
    """'white=4;apply=max' -> keyword arguments of an operator.

    >>> parse_settings("white=4;apply=max")
    {'white': 4.0, 'apply': 'max'}
    """
    pairs = (item.split("=") for item in text.split(";") if item)
    return {name: value if value.isalpha() else float(value) for name, value in pairs}


def row_of(operator, settings, look, output, rgb, expected, tolerance, origin):
    """One row of the table, as texts.

    >>> row_of("clamp", "", "", "native", (2, 0, -1), (1, 0, -0.0), 1e-9, "me")["out_b"]
    '0'
    """
    numbers = [f"{v + 0.0:.15g}" for v in (*rgb, *expected)]  # + 0.0: no "-0"
    return dict(zip(COLUMNS, [operator, settings, look, output, *numbers, f"{tolerance:g}", origin]))


def published_rows(shared):
    """Rows whose expected values stand in reference/check_values.json of the folder `shared`."""
    for value in json.loads((Path(shared) / "reference" / "check_values.json").read_text()):
        if value["operator"] in PUBLISHED:
            *form, tolerance = PUBLISHED[value["operator"]]
            source = value["source"].replace("concept note", "formula of Narkowicz 2016").replace(",", ";")
            yield row_of(*form, value["input"], value["output"], tolerance, f"{value['operator']}: {source}")


def derived_rows():
    """Rows that operators.py computes."""
    for operator, settings, look, output, colours in DERIVED:
        for rgb in colours:
            out = operators.view(operator, rgb, parse_settings(settings), look, display=output)
            yield row_of(operator, settings, look, output, rgb, out, EXACT, "python_check/operators.py")


def main():
    shared = os.environ.get("TONEWRIGHT_SHARED")
    if not shared:
        raise SystemExit("make_operator_rows: TONEWRIGHT_SHARED is unset; expected the folder that holds "
                         "reference/check_values.json")
    kept = [row for row in read_rows() if row["operator"] not in operators.OPERATORS]
    rows = [*kept, *published_rows(shared), *derived_rows()]
    rows.sort(key=lambda row: row["operator"])  # stable: published rows stay first
    if any("," in field or '"' in field for row in rows for field in row.values()):
        raise SystemExit("operators.csv: a field holds a comma or quote; expected none, so that splitting reads it")
    with CSV.open("w", newline="") as f:
        writer = csv.DictWriter(f, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
