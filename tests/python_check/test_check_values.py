# SPDX-License-Identifier: Apache-2.0
"""Tests check_values.py, and what the sources state about the families that few figures reach.

    [TONEWRIGHT_SHARED=<folder>] python3 -m pytest tests/python_check/test_check_values.py

With the folder: every entry of its reference/check_values.json has an operator or a reason, and the operators give
the figures.
"""

import importlib
import itertools
import warnings

import check_values
import numpy as np
import operators
import pytest
from operators import agx, camera_response, eetf, false_color, gt7, pq, spaces, unreal

# Operators without a published figure: inventions of this project, variants without a program to run, diagnostics.
# Operators of engines have rows of the executed engines in operators.csv instead.
NO_FIGURES = {"reinhard_constant_luminance", "hable_gdc", "toe", "khronos_neutral_filament", "false_color", "ffmpeg",
              "mobius", "babylon_contrast", "nanogl_tb", "luma_gl", "aces_cesium", "aces_galacean", "reinhard2",
              "opencv_reinhard", "opencv_drago", "agx_needle", "khronos_neutral_needle", *operators.DEFECTS}
MODULES = ("aces aces_13 aces_20 unreal agx agx_blender khronos_neutral gt7 frostbite somewhat_boring eetf "
           "camera_response false_color defects").split()
FOLDER = check_values.CSV_FOLDER


@pytest.fixture(scope="module")
def entries(shared):
    return check_values.read_entries(shared)


def test_mapping(report, entries):
    """Every entry has a mapping or a reason, and every operator a figure or a place in NO_FIGURES."""
    unknown = [entry["operator"] for entry in entries if not check_values.classify(entry)]
    report.bound(f"entries among {len(entries)} with neither mapping nor reason {sorted(set(unknown))}", len(unknown), 0.5)
    mapped = {check_values.classify(entry).operator for entry in entries
              if isinstance(check_values.classify(entry), check_values.Mapping)}
    missing = set(operators.OPERATORS) - mapped - NO_FIGURES
    report.bound(f"operators without a figure {sorted(missing)}", len(missing), 0.5)
    names = {entry["operator"] for entry in entries}
    stray = [name for name in check_values.MAPPINGS if name not in names]
    stray += [start for start in check_values.REASONS if not any(name.startswith(start) for name in names)]
    report.bound(f"names that check_values.json lacks {stray}", len(stray), 0.5)


def test_figures(report, entries, shared):
    for name, f in (("srgb_encode", operators.srgb_encode), ("pq_encode_nits", pq.pq_encode),
                    ("hlg_oetf", spaces.hlg_oetf), ("display_rec2100_pq", spaces.pq_display),
                    ("display_rec2100_hlg_1000nit", spaces.hlg_display)):
        figures = [(np.array(e["input"]), e["output"]) for e in entries if e["operator"] == name]
        errors = [np.abs(f(light) - code).max() for light, code in figures if light.min() >= 0]  # views limit before
        report.bound(f"{name} ({len(errors)})", np.max(errors), 1e-12)
    for name, mapping, members in check_values.group(entries):
        if isinstance(mapping, check_values.Mapping):
            error, ratio = check_values.compare(mapping, members, shared)
            report.bound(f"{name} ({len(members)}): {check_values.describe(mapping)[:40]}: {error:.1e},", ratio, 1)


EXTREMES = (0.0, 1e-310, 1e-30, 1e-6, 0.18, 1.0, 20.0, 65504.0, 1e9, 1e300, -1e-9, -0.5, -70000.0)
CORNERS = {  # settings at the ends of their ranges, where terms vanish or grow
    "aces_hill": ("prescale=100;gain=100", "prescale=0.01;white=65504;clamp=no"),
    "aces_13": ("output=hdr_4000;limit=rec2020", "output=hdr_cinema;spline=ctl;gamut_compression=yes",
                "output=sdr_cinema;limit=none;spline=ctl", "gamut_compression=yes"),
    "aces_20": ("peak=10000;limit=rec2020", "peak=1000;limit=p3d65"),
    "agx_blender": ("method=formula", "method=formula;range=hdr", "range=hdr;look=punchy", "look=greyscale",
                    "method=formula;limit=p3d65;look=very_low_contrast"),
    "unreal": ("toe=1;shoulder=1", "toe=0.9;shoulder=0.1", "slope=0.01;toe=0.01;shoulder=0.01;black_clip=1"),
    "agx_godot": ("contrast=0.1;white=65504;output_max=100", "contrast=4;white=2;output_max=0.2"),
    "khronos_neutral": ("start_compression=0.1;desaturation=1", "start_compression=0.99;desaturation=0"),
    "gt7": ("output=hdr;peak=250", "output=hdr;peak=10000"),
    "frostbite": ("linear_end=0.01", "linear_end=0.99"),
    "bt2390": ("source_black=0.05", "source_peak=10000;target_peak=0.1;knee_offset=2", "source_peak=50",
               "source_black=0.05;black_lift=libplacebo;apply=luminance"),
    "bt2446a": ("source_black=0.05", "source_peak=50", "apply=max"),
    "spline": ("contrast=1.5;average=10000", "contrast=0;average=1e-5", "apply=hue_preserving"),
    "camera_response": ("iso=1e-5", "iso=65504"),
}


def test_finite(report):
    """Finite input gives finite output, without a warning of NumPy."""
    rgb = np.array(list(itertools.product(EXTREMES, repeat=3)))
    names = [name for module in MODULES for name in importlib.import_module(f"operators.{module}").OPERATORS]
    for name in names:
        for settings in ("", *CORNERS.get(name, ())):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                out = operators.OPERATORS[name](rgb, **check_values.parse_settings(settings))
            report.bound(f"{name} {settings}: not finite", np.count_nonzero(~np.isfinite(out)), 0.5)


def test_statements(report):
    """Figures that the descriptions state beside the formulas."""
    inverse = np.linalg.inv([[0.899796955911611, 0.0871996192028351, 0.013003424885555],
                             [0.11142098895748, 0.875575586156966, 0.0130034248855548],
                             [0.11142098895748, 0.0871996192028349, 0.801379391839686]])
    report.bound("AgX Rec.2020 outset: inverse of the printed inverse", np.abs(inverse - agx.OUTSET_2020).max(), 1e-14)
    gray = [operators.OPERATORS["agx_godot"]([g] * 3, 1.25, 8.0, 2.0)[0] for g in (0.18, 8.0)]
    report.bound("agx_godot: 0.18 stays, white becomes output_max", np.abs(np.subtract(gray, (0.18, 2))).max(), 1e-13)
    report.bound("unreal: 0.18 stays, legacy preset",
                 abs(unreal.unreal_curve(np.array(0.18), 0.98, 0.3, 0.22, 0, 0.025) - 0.18), 1e-15)
    # k_A = 1.18533 target; the curve passes the target at (linear + k ln 4) target = 1.47170 target.
    report.bound("gt7: limit of the shoulder", abs(gt7.gt7_curve(np.array(1e4), 10) / 10 - 1.18533), 5e-6)
    report.bound("gt7: where the shoulder passes the target", abs(gt7.gt7_curve(np.array(14.7170), 10) / 10 - 1), 2e-6)
    report.bound("PQ of 0 and 10000 cd/m2", np.abs(pq.pq_encode(np.array([0.0, 1e4])) - [pq.C1**pq.M2, 1]).max(), 1e-15)
    report.bound("eetf: the peak of the source becomes that of the target", max(
        abs(f(np.full(3, 40.0), source_peak=4000, target_peak=300)[0] - 1)
        for f in (eetf.bt2390, eetf.bt2446a, eetf.spline)), 1e-12)
    # Neighboring colors meet half-way at +-0.5 stop, and each holds on its whole stop.
    stops = np.array([-9, -7, -3, 0, 2.37, 2.5, 7, 12])
    shown = operators.OPERATORS["false_color"](np.repeat(0.18 * 2.0 ** stops[:, None], 3, axis=1))
    light = false_color.srgb_decode(np.array([[int(c[k:k + 2], 16) for k in (0, 2, 4)]
                                              for c in false_color.COLORS]) / 255)
    expected = [light[0], light[0], light[4], light[7], light[9], (light[9] + light[10]) / 2, light[14], light[14]]
    report.bound("false_color at whole and half stops", np.abs(shown - expected).max(), 1e-12)


def test_contrast(report):
    """The complex step through the curves against a difference of fifth order, whose own error is about 1e-9."""
    x, h = np.array([0.05, 0.3, 2.0, 7.0]), 1e-3
    curves = {name: lambda v, f=f: f(v[..., None].repeat(3, -1))[..., 0]
              for name, f in operators.OPERATORS.items() if name in ("aces_narkowicz", "bt2390", "bt2446a", "spline")}
    for name, f in curves.items():
        color = np.stack([x, x, x], -1) * (1, 0.5, 2)
        weights = operators.REC709_WEIGHTS if name == "aces_narkowicz" else operators.REC2020_WEIGHTS
        norm = operators.luminance(color, weights)
        how = {"apply": "luminance", "color_correction": "nonlinear"}
        from_contrast = operators.OPERATORS[name](color, **how, saturation_from="contrast")
        at = [np.log(f(norm[..., 0] * np.exp(k * h))) for k in (-2, -1, 1, 2)]
        slope = (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)
        power = np.maximum(slope, 0) ** 0.9925
        saturation = ((1 + 1.6774) * power / (1 + 1.6774 * power))[..., None]
        expected = (color / norm) ** saturation * f(norm[..., 0])[..., None]
        expected = np.clip(expected, 0, 1) if name == "aces_narkowicz" else expected
        report.bound(f"{name}: saturation from contrast", np.abs(from_contrast / expected - 1).max(), 1e-8)


def raises(call, *arguments, **settings):
    try:
        call(*arguments, **settings)
    except ValueError:
        return True
    return False


def test_files(report, scratch):
    """Layouts of response curves: the same numbers in another layout are the same curves; what is wrong is named."""
    def same(a, b):
        return max(np.abs(np.subtract(p, q)).max() for p, q in zip(a, b))

    read = camera_response.read_curves
    four = read(FOLDER / "synthetic_response.rf")
    lines = ["r,g,b,x"] + [",".join(f"{v!r}" for v in row)
                           for row in np.stack([four[0][0], *(c[1] for c in four)], -1).tolist()]
    path = scratch / "a.csv"
    path.write_text("\n".join(lines))
    report.bound("camera_response: CSV as .rf", same(read(path), four), 0.1e-15)
    text = "".join(f"film{name}\ngraph\nI =\n{' '.join(map(repr, b.tolist()))}\nB =\n"
                   f"{' '.join(map(repr, i.tolist()))}\n" for name, (b, i) in zip(("Red", "Green", "Blue"), four))
    path.write_text(text)
    report.bound("camera_response: DoRF's text as .rf", same(read(path), four), 0.1e-15)
    report.bound("camera_response: DoRF's text by name", same(read(path, "filmBlue"), [four[2]] * 3), 0.1e-15)
    path.write_text(text.replace("Red", "R").replace("Green", "G").replace("Blue", "B"))
    report.bound("camera_response: DoRF's text with R, G, B", same(read(path, "film"), four), 0.1e-15)
    path.write_text("0 0\n1 1\n0.5 1\n")
    errors = [raises(read, path), raises(read, FOLDER / "synthetic_dorf.txt"),
              raises(read, FOLDER / "synthetic_dorf.txt", "Red"),
              raises(read, FOLDER / "two_column_response.rf", "red"),
              raises(read, FOLDER / "synthetic_response.rf", "alpha")]
    report.bound("camera_response: errors that are not found", errors.count(False), 0.5)
    operator = operators.OPERATORS["camera_response"]
    out = operator(np.array([0.0, 0.5, 0.375]), file=FOLDER / "two_column_response.rf", iso=1)
    report.bound("camera_response: first sample above 0, the last of two counts", np.abs(out - [0.01, 0.6, 0.5]).max(), 1e-9)
    wrong = [raises(operators.OPERATORS[name], np.ones(3), **settings) for name, settings in (
        ("bt2390", {"source_black": 0.005, "target_black": 0.05, "apply": "luminance"}),
        ("spline", {"target_black": 100.0}), ("aces_hill", {"white": 1e-3}))]
    report.bound("settings that contradict: errors that are not found", wrong.count(False), 0.5)
