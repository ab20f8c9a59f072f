# SPDX-License-Identifier: Apache-2.0
"""Writes the rows of tests/data/operators.csv that belong to the operators of the package operators.

    TONEWRIGHT_SHARED=<folder> python3 make_operator_rows.py

Published figures come from reference/check_values.json in that folder, through check_values.py. The operators add
what they lack: other settings, negatives, near-black, colors beyond the half-float range. Rows of other operators, and
those whose origin is an executed engine ("executed: ..."), are kept as they are.
"""

import csv
import os

import check_values
import operators
from check_values import CSV_FOLDER, EXACT, SHARED, parse_settings

CSV = CSV_FOLDER / "operators.csv"
COLUMNS = "operator settings look output input in_r in_g in_b out_r out_g out_b tolerance origin".split()
# Names of check_values.json whose source says nothing outside of it.
SOURCES = {"aces_narkowicz": "formula of Narkowicz 2016", "exposure_ev": "rgb * 2^EV"}

GRAY, SATURATED, BRIGHT = (0.18, 0.18, 0.18), (0.8, 0.1, 0.05), (4, 2, 0.5)
BLACK, NEAR_BLACK = (0, 0, 0), (0.0003, 0.0002, 0.0001)
MIXED, NEGATIVE = (-0.1, 0.2, 0.5), (-3, -2, -1)
# Above 65504, the largest half float, every value counts as 65504.
LARGE, BEYOND = (60000, 20000, 500), (1e6, 65504, 70000)
EVERYWHERE = (NEAR_BLACK, MIXED, NEGATIVE, LARGE, BEYOND)
COLORS = (BLACK, GRAY, SATURATED, BRIGHT, *EVERYWHERE)
FEW = (GRAY, SATURATED, BRIGHT, MIXED, BEYOND)
BLUE, RED, DARK_RED = (0.05, 0.1, 2), (6, 0.4, 0.3), (0.06, 0.004, 0.003)  # where glow and red modifier act
HUES = (*COLORS, BLUE, RED, DARK_RED)
# Colors that picture formations change: saturated ones of every brightness, at their limits.
FORMED = (BLACK, GRAY, BLUE, RED, (0.02, 0.4, 0.05), (3, 0.2, 2.5), MIXED, BEYOND)
STOPS = tuple((0.18 * 2.0**s,) * 3
              for s in (-8, -6.52, -5.48, -3, -2.5, -1.46, -0.4, 0.5, 1.53, 2.49, 4, 5.51, 6.55, 9))

CORRECTIONS = [f"apply=luminance;color_correction={correction};saturation={saturation}" + source
               for correction in ("nonlinear", "luminance_preserving")
               for saturation, source in ((0.6, ""), (1.2, ""), (0.9, ";saturation_from=contrast"))]
GDC = "shoulder_strength=0.22;linear_strength=0.3;toe_numerator=0.01"
UCHIMURA = "max_brightness=4;contrast=1.2;linear_start=0.3;linear_length=0.5;black_tightness=2;pedestal=0.02"
BLACKS = "source_black=0.01;target_black=0.05"
# Curves with `apply`: settings beside the defaults. Each also gets the other three ways to apply it.
CURVES = {
    "linear": ["divisor=0.5"],
    "exponential": ["average=0.18", *(f"average={a};apply=channels" for a in ("1", "0.9070250776", "1.442695041"))],
    "logarithmic": ["p=30;maximum=4"],
    "log_tonemap": ["limit=4", "contrast=0.5", "contrast=1;apply=channels"],
    "exponentiation": ["p=0.3;maximum=16"],
    "reinhard": ["apply=luminance;weights=babylon", "apply=luminance;weights=lygia"],
    "reinhard_extended": ["white=2.5", "white=0.5;apply=max", *CORRECTIONS],
    "nebula": ["middle_grey=0.18;maximum=4;average=1.5"],
    "hable": [GDC, GDC + ";exposure_bias=1", GDC + ";white=2", "white=4;exposure_bias=1", "white=5;exposure_bias=1",
              "white=1000;exposure_bias=1", "shoulder_strength=0.2;linear_strength=0.29;linear_angle=0.24;toe_strength=0.272;"
              "white=5.3;exposure_bias=1.31338"],
    "hable_gdc": ["white=4;exposure_bias=2", "black=0.004;white=6.2107773060570395"],
    "hable_piecewise": ["toe_strength=0.5;toe_length=0.5;shoulder_strength=2;shoulder_length=0.5;shoulder_angle=1",
                        "toe_length=0",
                        "toe_strength=0.2;toe_length=0.3;shoulder_strength=4;shoulder_length=0.7;shoulder_angle=0.4;"
                        "gamma=0.8", "max_brightness=10;shoulder_strength=2;shoulder_angle=0.5;toe_strength=0.3",
                        "toe_strength=0.6;shoulder_length=1;shoulder_strength=1;apply=luminance"],
    "hejl_burgess_dawson": [*CORRECTIONS, "output=squared"],
    "hejl_2015": ["white=4"],
    "aldridge": ["cutoff=0.2"],
    "lottes": ["contrast=1.2;shoulder=0.9;hdr_max=16;mid_out=0.18",
               "contrast=1.6773;shoulder=0.9714;hdr_max=11.0785;mid_out=0.18",
               "contrast=1.1759;shoulder=0.9746;hdr_max=6.3704;mid_out=0.18"],
    "filament_generic": ["contrast=1.2;mid_in=0.2;mid_out=0.18;hdr_max=100"],
    "ue3": [],
    "day": ["white=8;black=0.01;toe=0.5;shoulder=0.6;crossover=1;average=0.5"],
    "schlick": ["p=300;maximum=20"],
    "toe": ["form=ramp;width=0.25;strength=0.5", "width=0.2;strength=0.5;brightness=0.05;contrast=1.2",
            "form=ramp;width=0.3;strength=0.4;white=10;apply=luminance"],
    "uchimura": [UCHIMURA, "max_brightness=10;apply=luminance"],
    "drago": ["bias=0.7;display_max=300;log_average=0.3;maximum=20", "bias=0.7;bias_scales_average=no",
              *CORRECTIONS[2:6:3]],
    "opencv_drago": ["bias=0.7;minimum=0.1;maximum=20;log_average=0.3;maximum_gray=15;output_minimum=0.1"],
    "mobius": ["knee=0.5;peak=4"],
    "ward": ["display_max=200;log_average=3"],
    "tumblin_rushmeier": ["display_max=200;contrast_max=100;log_average=3"],
    "aces_narkowicz": ["prescale=0.6", "clamp=no", CORRECTIONS[2]],
    "aces_cesium": [],
    "bt2390": ["knee_offset=1;black_lift=libplacebo;apply=luminance", BLACKS, BLACKS + ";knee_offset=1;black_lift=libplacebo", "source_peak=4000;knee_offset=2",
               BLACKS + ";output=hdr;target_peak=600;source_peak=4000",
               "source_peak=100;target_peak=400", "source_peak=10000;reference_white=203", CORRECTIONS[2]],
    "bt2446a": [BLACKS, "source_peak=4000;target_peak=250;reference_white=203", "source_peak=400;target_peak=400"],
    "spline": [BLACKS + ";apply=channels", "contrast=0.2;average=50", "source_peak=4000;target_peak=250;contrast=1.5;reference_white=203"],
}
LUMINANCE_FIRST = ("exponential logarithmic log_tonemap exponentiation nebula schlick drago ward "
                   "opencv_drago tumblin_rushmeier spline").split()  # default apply=luminance
# The others: settings beside the defaults.
OTHERS = {
    "clamp": ["apply=max"],
    "reinhard2": ["white=16;clamp=no"],
    "reinhard_jodie": ["weights=lygia"],
    "opencv_reinhard": ["light_adaptation=0;maximum=4;output_minimum=0.1",
                        "intensity=-1;contrast=0.5;color_adaptation=0.3;light_adaptation=0.7;minimum=0.1;maximum=4;"
                        "mean_red=0.6;mean_green=0.5;mean_blue=0.4"],
    "ffmpeg": [*(f"tonemap={curve}" + more for curve in ("none", "linear", "gamma", "clip", "reinhard", "hable", "mobius")
                 for more in (";desat=0", ";param=0.7;peak=100"))],
    "babylon_contrast": ["contrast=0.5", "contrast=3"],
    "nanogl_tb": [],
    "luma_gl": ["maximum_luminance=4"],
    "aces_galacean": [],
    "reinhard_constant_luminance": [],
    "reinhard_devlin": ["intensity=-1;contrast=0.5;chromatic_adaptation=0.3;light_adaptation=0.7;mean_red=0.6;"
                        "mean_green=0.5;mean_blue=0.4", "intensity=2;light_adaptation=0;mean_luminance=0"],
    "ferwerda": ["display_max=200;photopic_adaptation=0.05;scotopic_adaptation=0.01",
                 "rod_weight_from=fixed;rod_weight=0.8"],
    "durand_dorsey_rods": ["display_max=200;photopic_adaptation=0.05;scotopic_adaptation=0.01",
                           "rod_weight_from=fixed;rod_weight=0.8;blue_shift_red=0.9;blue_shift_green=1;"
                           "blue_shift_blue=1.4"],
    "aces_hill": ["gain=1.8", "prescale=0.6;white=4;clamp=no", "prescale=1.8;white=2;gain=0.5"],
    "aces_filament": ["brightness=1.6666666666666667"],
    "aces_13": ["limit=none", "gamut_compression=yes", "spline=ctl", "output=sdr_cinema;limit=p3d65",
                "output=hdr_1000;limit=rec2020", "output=hdr_4000;limit=p3d65;spline=ctl",
                "output=hdr_cinema;limit=p3d65;gamut_compression=yes"],
    "aces_20": ["peak=1000;limit=rec2020", "peak=500;limit=p3d65", "peak=10000;limit=rec2020",
                "primaries=0.68 0.32 0.265 0.69 0.15 0.06 0.32168 0.33767"],
    "agx_blender": ["limit=p3d65", "limit=rec2020", "range=hdr", "method=formula", "method=formula;limit=p3d65",
                    "method=formula;limit=rec2020", "method=formula;range=hdr"],
    "unreal": ["glow_and_red=off", "slope=0.98;toe=0.3;shoulder=0.22;black_clip=0;white_clip=0.025",
               "toe=0.85;shoulder=0.4;black_clip=0.02"],
    "agx_sobotka": [],
    "agx_minimal": ["order=7"],
    "agx_threejs": ["clamp=yes", "matrices=exact"],
    "agx_needle": [],
    "agx_filament": [],
    "agx_godot44": [],
    "agx_godot": ["contrast=1;white=8", "contrast=1.5;white=50;output_max=5"],
    "khronos_neutral": ["start_compression=0.5;desaturation=0.6"],
    "khronos_neutral_filament": ["start_compression=0.5;desaturation=0.6"],
    "khronos_neutral_needle": [],
    "gt7": ["output=hdr", "output=hdr;peak=4000"],
    "frostbite": ["linear_end=0.6"],
    "somewhat_boring": [],
    "camera_response": ["iso=0.5", "file=two_column_response.rf;iso=1", "file=two_column_response.rf;iso=2",
                        "file=synthetic_response.rf", "file=synthetic_response.rf;curve=green;iso=2",
                        "file=synthetic_response_uneven.csv;iso=2", "file=synthetic_dorf.txt;curve=Synthetic-1;iso=2",
                        "file=synthetic_dorf.txt;curve=Synthetic-1Blue;iso=2",
                        "file=synthetic_dorf.txt;curve=SyntheticMono;iso=2"],
    "false_color": ["palette=lygia"],
    **{defect: [] for defect in operators.DEFECTS},
}
LOOKS = {"agx_sobotka": ("golden", "punchy"), "agx_filament": ("golden", "punchy"),
         "agx_blender": ("punchy", "greyscale", *operators.agx_blender.CONTRASTS)}
FORMATIONS = ("aces_13", "aces_20", "agx_blender")


def read_rows():
    """The committed table, as a list of dicts of texts; empty when there is none.

    Rows that read a file of $TONEWRIGHT_SHARED are left out while that is unset.
    """
    if not CSV.exists():
        return []
    with CSV.open(newline="") as f:
        rows = list(csv.DictReader(f))
    return [row for row in rows if SHARED not in row["settings"] or os.environ.get(SHARED[1:])]


def row_of(operator, settings, look, output, space, rgb, expected, tolerance, origin):
    """One row of the table, as texts.

    >>> row_of("clamp", "", "", "native", "lin_rec709", (2, 0, -1), (1, 0, -0.0), 1e-9, "me")["out_b"]
    '0'
    """
    numbers = [f"{v + 0.0:.15g}" for v in (*rgb, *expected)]  # + 0.0: no "-0"
    return dict(zip(COLUMNS, [operator, settings, look, output, space, *numbers, f"{tolerance:.3g}", origin]))


def published_rows(shared):
    """Rows whose expected values stand in reference/check_values.json of the folder `shared`."""
    for entry in check_values.read_entries(shared):
        mapping = check_values.classify(entry)
        if isinstance(mapping, str):
            continue
        name = entry["operator"]
        source = SOURCES.get(name, entry["source"]).replace(",", ";")
        yield row_of(mapping.operator, mapping.settings, mapping.look, mapping.output, mapping.input,
                     mapping.scene(entry), mapping.expected(entry), mapping.row_tolerance(entry), f"{name}: {source}")


def derived_cases():
    """(operator, settings, look, output, input, colors) of every row that the operators compute."""
    for operator in (*CURVES, *OTHERS):
        working = "lin_" + operators.WORKING[operator]
        forms = []
        if operator in CURVES:
            first = "luminance" if operator in LUMINANCE_FIRST else "max" if operator == "mobius" else "channels"
            forms = [f"apply={a}" for a in ("channels", "luminance", "max", "hue_preserving") if a != first]
        code = operator in operators.CODE_POWER
        hues = HUES if operator in ("aces_filament", "unreal", "gt7", "frostbite", "agx_threejs",
                                     "aces_galacean", "agx_needle") else COLORS
        hues = (*COLORS, *STOPS) if operator == "false_color" else hues
        colors = COLORS
        if operator in FORMATIONS:
            hues, colors = HUES, FORMED
        yield operator, "", "", "native", working, hues
        for settings in (*CURVES.get(operator, ()), *OTHERS.get(operator, ())):
            yield operator, settings, "", "native", working, colors
        for settings in forms:
            yield operator, settings, "", "native", working, FEW
            if code and settings == "apply=luminance":
                yield operator, settings, "", "linear", working, FEW
        for look in LOOKS.get(operator, ()):
            yield operator, "", look, "native", working, colors
        if code or working != "lin_rec709":
            yield operator, "", "", "linear", "lin_rec709", COLORS
    for space in operators.INPUTS:
        yield "reinhard", "", "", "native", space, FEW


def derived_rows():
    """Rows that the operators compute."""
    for operator, settings, look, output, space, colors in derived_cases():
        for rgb in colors:
            out = operators.view(operator, rgb, parse_settings(settings), look, input=space, display=output)
            yield row_of(operator, settings, look, output, space, rgb, out, EXACT, "python_check/operators")


def main():
    shared = os.environ.get("TONEWRIGHT_SHARED")
    if not shared:
        raise SystemExit("make_operator_rows: TONEWRIGHT_SHARED is unset; expected the folder that holds "
                         "reference/check_values.json")
    kept = [row for row in read_rows()
            if row["operator"] not in operators.OPERATORS or row["origin"].startswith("executed: ")]
    rows = [*kept, *published_rows(shared), *derived_rows()]
    rows = list({tuple(row[c] for c in COLUMNS[:8]) + (row["origin"],): row for row in rows}.values())  # each once
    rows.sort(key=lambda row: row["operator"])  # stable: published rows stay first
    if any("," in field or '"' in field for row in rows for field in row.values()):
        raise SystemExit("operators.csv: a field holds a comma or quote; expected none, so that splitting reads it")
    with CSV.open("w", newline="") as f:
        writer = csv.DictWriter(f, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
