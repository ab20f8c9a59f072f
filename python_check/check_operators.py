# SPDX-License-Identifier: Apache-2.0
"""Compares `tonewright eval` with the package operators: every operator, settings, presets, looks, views.

    python3 check_operators.py build/release/bin/tonewright [OPERATOR ...]

Compares 600 colors a run, or 2,000 with TONEWRIGHT_TEST_ALL=1.
Prints one line per run; exits 1 when a color is outside the tolerance. The last line is `N passed, M failed`.
"""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import operators
from operators.pq import pq_decode

# Both sides compute in double and `eval --digits 17` prints a double without loss. What differs is the order of the
# arithmetic: 1e-16 a step, times the condition of the curves (powers of up to 80 in PQ, logarithms near 1).
RELATIVE = 1e-9
# Where the result is a difference (Hable's E/F, saturation, matrices, S(0)), 1e-16 of the terms is left beside 0; the
# terms are of the size of the color's largest channel, or of 1. The looks' power of 0.8 raises that to 2e-13.
ABSOLUTE = 1e-12
# Operators whose clamp hides that their terms are larger than the result: the color times its own luminance. The matrix to
# the signal of the rods and its inverse cancel, and sRGB's slope of 12.92 at black enlarges the rest.
HIDDEN_TERMS = {"reinhard2": 100, "ferwerda": 20, "durand_dorsey_rods": 20}
# Displays with an infinite slope at black, where 1e-16 of light is 2e-7 in code, are compared as light. HLG: its root.
DISPLAY_LIGHT = {"rec1886": lambda code: code**2.4, "g22": lambda code: code**2.2, "rec2020": lambda code: code**2.4,
                 "rec2100_pq": lambda code: pq_decode(code) / 100, "p3d65_pq": lambda code: pq_decode(code) / 100,
                 "rec2100_hlg": lambda code: code**2}

LUMINANCE, MAX, HUE = {"apply": "luminance"}, {"apply": "max"}, {"apply": "hue_preserving"}
NONLINEAR = {**LUMINANCE, "color_correction": "nonlinear"}
PRESERVING = {**LUMINANCE, "color_correction": "luminance_preserving"}
# Settings that every curve runs with.
APPLY = [{"apply": "channels"}, LUMINANCE, MAX, HUE,
         {**NONLINEAR, "saturation": 0.6}, {**NONLINEAR, "saturation": 1.3, "saturation_from": "contrast"},
         {**PRESERVING, "saturation": 1.4}, {**PRESERVING, "saturation": 0.8, "saturation_from": "contrast"}]
CURVES = ("linear exponential logarithmic log_tonemap exponentiation reinhard reinhard_extended nebula hable hable_gdc "
          "hable_piecewise hejl_burgess_dawson hejl_2015 aldridge lottes filament_generic ue3 day schlick toe uchimura "
          "drago opencv_drago ward tumblin_rushmeier mobius aces_narkowicz aces_cesium bt2390 bt2446a spline").split()

HABLE_GDC = {"shoulder_strength": 0.22, "linear_strength": 0.3, "toe_numerator": 0.01}
HABLE_GODOT = {"shoulder_strength": 0.88, "linear_strength": 0.6, "toe_numerator": 0.01, "white": 1, "exposure_bias": 1}
HABLE_ALL = {"shoulder_strength": 0.3, "linear_strength": 0.4, "linear_angle": 0.2, "toe_strength": 0.25,
             "toe_numerator": 0.015, "toe_denominator": 0.4, "white": 6, "exposure_bias": 1.5}
FILM = {"toe_strength": 0.5, "toe_length": 0.5, "shoulder_strength": 2, "shoulder_length": 0.5, "shoulder_angle": 1}
SOFT = {"toe_strength": 0.2, "toe_length": 0.3, "shoulder_strength": 4, "shoulder_length": 0.7, "shoulder_angle": 0.4}
UCHIMURA_ALL = {"max_brightness": 4, "contrast": 1.2, "linear_start": 0.3, "linear_length": 0.5,
                "black_tightness": 2, "pedestal": 0.02}
DEVLIN_MEANS = {"mean_red": 0.6, "mean_green": 0.5, "mean_blue": 0.4, "mean_luminance": 0.45}
OPENCV = {"minimum": 0.1, "maximum": 4, "color_adaptation": 0.3, "light_adaptation": 0.7, "mean_gray": 0.45,
          "mean_red": 0.6, "mean_green": 0.5, "mean_blue": 0.4}
FFMPEG = ("none", "linear", "gamma", "clip", "reinhard", "hable", "mobius")
RAMP = {"form": "ramp", "width": 0.25, "strength": 0.5}
RODS = {"display_max": 200, "photopic_adaptation": 0.05, "scotopic_adaptation": 0.01}
P3D60 = "0.68 0.32 0.265 0.69 0.15 0.06 0.32168 0.33767"
AGX_LOOKS = ("punchy greyscale very_high_contrast high_contrast medium_high_contrast base_contrast "
             "medium_low_contrast low_contrast very_low_contrast").split()
UNREAL_LEGACY = {"slope": 0.98, "toe": 0.3, "shoulder": 0.22, "white_clip": 0.025}
EETF = [{"source_peak": 4000, "target_peak": 250, "source_black": 0.01, "target_black": 0.05},
        {"source_peak": 100, "target_peak": 400}, {"output": "hdr", "target_peak": 600, "source_peak": 4000},
        {"output": "hdr", "target_peak": 20, "target_black": 0.1}, {"reference_white": 203, "source_peak": 10000}]
# Operator -> sets of settings beside the defaults; "look" among them is the look.
SETTINGS = {
    "clamp": [MAX],
    "linear": [{"divisor": 1e-6}, {"divisor": 65504}, {"divisor": 0.18}],
    "exponential": [{"average": 1e-6}, {"average": 0.18}, {"average": 65504}],
    "logarithmic": [{"p": 0.001, "maximum": 1e-6}, {"p": 1000, "maximum": 65504}, {"p": 30, "maximum": 4}],
    "log_tonemap": [{"limit": 0.001}, {"limit": 65504, "contrast": 1}, {"contrast": 0.5},
                    {"contrast": 0.5, "apply": "channels"}],
    "exponentiation": [{"p": 0.01}, {"p": 1, "maximum": 1e-6}, {"p": 0.4, "maximum": 65504}],
    "reinhard": [{**LUMINANCE, "weights": w} for w in ("babylon", "lygia")],
    "reinhard2": [{"clamp": "no", "white": 16}, {"middle_grey": 0.18, "average": 0.01, "white": 65504}],
    "reinhard_extended": [{"white": w, **a} for w in (0.5, 1.5, 16) for a in ({}, LUMINANCE, MAX)],
    "reinhard_jodie": [{"weights": "lygia"}],
    "reinhard_constant_luminance": [],
    "nebula": [{"middle_grey": 0.01, "maximum": 0.01, "average": 65504}, {"middle_grey": 1, "maximum": 65504},
               {"average": 0.001}, {"maximum": 2, "average": 0.2, "apply": "channels"}],
    "reinhard_devlin": [{"intensity": -8}, {"intensity": 8}, {"contrast": 0.3}, {"contrast": 1},
                        {"chromatic_adaptation": 1}, {"light_adaptation": 0}, DEVLIN_MEANS,
                        {"intensity": -1, "contrast": 0.5, "chromatic_adaptation": 0.3, "light_adaptation": 0.7,
                         **DEVLIN_MEANS},
                        {"light_adaptation": 0, "mean_luminance": 0.001}],
    "hable": [HABLE_GDC, HABLE_GODOT, HABLE_ALL, {"white": 4}, {"exposure_bias": 1}, {"exposure_bias": 100},
              {**HABLE_ALL, **MAX}],
    "opencv_reinhard": [{"light_adaptation": 0}, OPENCV, {**OPENCV, "light_adaptation": 0},
                        {"intensity": 8, "contrast": 1}, {**OPENCV, "output_minimum": 0.1, "output_maximum": 0.9}],
    "hable_gdc": [{"white": 4}, {"black": 0.05}, {"exposure_bias": 0.01}, {"exposure_bias": 2, "white": 65504}],
    "hable_piecewise": [FILM, {**FILM, "gamma": 1 / 2.2}, SOFT, {"toe_length": 0}, {"toe_strength": 1},
                        {"toe_strength": 1, "gamma": 0.5}, {"toe_length": 1, "toe_strength": 0.3},
                        {"shoulder_length": 1}, {"shoulder_length": 1e-5, "shoulder_strength": 1},
                        {"shoulder_strength": 16, "shoulder_angle": 0.3}, {"gamma": 4}, {"max_brightness": 100},
                        {"max_brightness": 10, **SOFT}, {"max_brightness": 4, **FILM, **LUMINANCE},
                        {"gamma": 0.1, **SOFT},
                        {**FILM, **LUMINANCE}, {**FILM, **HUE}],
    "hejl_burgess_dawson": [{"output": "squared"}, {"output": "squared", **LUMINANCE}],
    "hejl_2015": [{"white": 0.1}, {"white": 4}, {"white": 65504}],
    "aldridge": [{"cutoff": 0.001}, {"cutoff": 0.2}, {"cutoff": 0.5}, {"cutoff": 1}],
    "lottes": [{"contrast": 1, "shoulder": 1.2}, {"contrast": 2}, {"hdr_max": 100, "mid_out": 0.18}, {"shoulder": 2},
               {"hdr_max": 65504, "shoulder": 0.99, "mid_in": 0.1, "mid_out": 0.1}],
    "filament_generic": [{"contrast": 1}, {"contrast": 3}, {"mid_in": 0.1, "mid_out": 0.5}, {"hdr_max": 65504},
                         {"hdr_max": 1, "mid_out": 0.15}],
    "ue3": [],
    "day": [{"white": 65504}, {"black": 0}, {"toe": 0}, {"toe": 0.99, "shoulder": 0.99}, {"shoulder": 0},
            {"crossover": 0.5, "white": 1, "black": 0.2}, {"average": 0.18}, {"average": 65504}],
    "schlick": [{"p": 1}, {"p": 1000}, {"p": 300, "maximum": 65504}, {"maximum": 1e-6}, {"maximum": 4}],
    "toe": [RAMP, {**RAMP, **LUMINANCE}, {"strength": 0.4, "width": 1}, {"width": 0.001}, {"strength": 0},
            {"contrast": 1.4, "brightness": -0.1}, {"contrast": 0.01, "brightness": 1},
            {**RAMP, "strength": 1, "white": 0.5, "contrast": 4, "brightness": -1}, {**RAMP, "white": 65504}],
    "uchimura": [{"max_brightness": 10}, {"contrast": 0.8}, {"black_tightness": 1}, {"pedestal": 0.05}, UCHIMURA_ALL,
                 {"linear_start": 0.01, "black_tightness": 3}, {"linear_start": 0.99, "linear_length": 0.99},
                 {"max_brightness": 100, "contrast": 5}, {"max_brightness": 10, **LUMINANCE}],
    "opencv_drago": [{"bias": 0.5}, {"minimum": 0.1, "maximum": 20, "log_average": 0.3, "maximum_gray": 15},
                     {"output_minimum": 0.1, "output_maximum": 2}],
    "drago": [{"bias": 0.5}, {"bias": 0.7, "bias_scales_average": "no"}, {"bias": 1}, {"display_max": 10000}, {"log_average": 1e-6}, {"log_average": 65504},
              {"maximum": 1e-6}, {"log_average": 0.3, "maximum": 65504, "bias": 0.75}],
    "ward": [{"display_max": 1}, {"display_max": 10000}, {"log_average": 1e-6}, {"log_average": 65504}],
    "tumblin_rushmeier": [{"display_max": 1}, {"display_max": 10000, "contrast_max": 2}, {"contrast_max": 10000},
                          {"log_average": 1e-6}, {"log_average": 65504}],
    "ferwerda": [{"rod_weight_from": "fixed"}, {"rod_weight_from": "fixed", "rod_weight": 1}, RODS,
                 {"photopic_adaptation": 65504}, {"scotopic_adaptation": 1e-6, "photopic_adaptation": 1e-6},
                 {"photopic_adaptation": 10}],
    "durand_dorsey_rods": [{"rod_weight_from": "fixed"}, {"rod_weight_from": "fixed", "rod_weight": 0}, RODS,
                           {"scotopic_adaptation": 65504}, {"scotopic_adaptation": 1e-6},
                           {"blue_shift_red": 0, "blue_shift_green": 2, "blue_shift_blue": 0.5}],
    "ffmpeg": [*({"tonemap": curve, **more} for curve in FFMPEG for more in ({"desat": 0}, {"param": 0.7, "peak": 100})),
               {"desat": 65504}, {"desat": 1e-7}, {"tonemap": "gamma", "param": 4}, {"peak": 1.01}],
    "mobius": [{"knee": 0.001}, {"knee": 0.99}, {"peak": 1.01}, {"peak": 65504}],
    "babylon_contrast": [{"contrast": c} for c in (0, 0.5, 1, 2, 4)],
    "nanogl_tb": [],
    "luma_gl": [{"maximum_luminance": 4}, {"maximum_luminance": 100}],
    "aces_cesium": [],
    "aces_galacean": [],
    "aces_narkowicz": [{"clamp": "no"}, {"clamp": "no", **LUMINANCE}, {"prescale": 0.6}, {"prescale": 1.8}, {"prescale": 0.6, **LUMINANCE}],
    "aces_hill": [{"prescale": 0.5}, {"gain": 1.8}, {"prescale": 1.8, "white": 1, "clamp": "no"}, {"clamp": "no"},
                  {"prescale": 1 / 0.6}, {"white": 4}, {"gain": 100, "white": 65504}],
    "aces_filament": [{"brightness": 1 / 0.6}, {"brightness": 0.01}, {"brightness": 100}],
    "aces_13": [{"limit": "none"}, {"limit": "p3d65"}, {"limit": "rec2020"}, {"gamut_compression": "yes"},
                {"spline": "ctl"}, {"spline": "ctl", "gamut_compression": "yes", "limit": "p3d65"},
                *({"output": "sdr_cinema", "limit": limit, "spline": spline}
                  for limit, spline in (("rec709", "ocio"), ("none", "ctl"), ("p3d65", "ctl"))),
                *({"output": f"hdr_{peak}", "limit": limit, "spline": spline} for spline in ("ocio", "ctl")
                  for peak, limit in (("1000", "rec709"), ("1000", "p3d65"), ("2000", "rec2020"), ("4000", "p3d65"),
                                      ("cinema", "p3d65"))),
                {"output": "hdr_1000", "limit": "rec2020", "gamut_compression": "yes"}],
    "aces_20": [{"limit": "p3d65"}, {"limit": "rec2020"}, {"peak": 203.5}, {"peak": 500, "limit": "p3d65"},
                {"peak": 1000, "limit": "rec2020"}, {"peak": 2000}, {"peak": 4000, "limit": "p3d65"},
                {"peak": 10000, "limit": "rec2020"}, {"primaries": P3D60},
                {"peak": 300, "primaries": "0.73 0.27 0.1 0.8 0.15 0.02 0.3127 0.329"}],
    "unreal": [{"glow_and_red": "off"}, UNREAL_LEGACY, {"toe": 0.9}, {"toe": 0.95, "shoulder": 1},
               {"black_clip": 0.05, "white_clip": 0.2}, {**UNREAL_LEGACY, "glow_and_red": "off"}],
    "agx_sobotka": [{"look": "golden"}, {"look": "punchy"}],
    "agx_minimal": [{"order": 7}],
    "agx_threejs": [{"clamp": "yes"}, {"matrices": "exact"}],
    "agx_needle": [],
    "agx_filament": [{"look": "golden"}, {"look": "punchy"}],
    "agx_godot44": [],
    "agx_godot": [{"contrast": 0.1}, {"contrast": 4}, {"white": 2}, {"white": 65504}, {"output_max": 0.2},
                  {"output_max": 100, "white": 100}],
    "agx_blender": [{"limit": "p3d65"}, {"limit": "rec2020"}, {"range": "hdr"}, {"method": "formula"},
                    {"method": "formula", "limit": "p3d65"}, {"method": "formula", "limit": "rec2020"},
                    {"method": "formula", "range": "hdr"}, *({"look": look} for look in AGX_LOOKS),
                    *({"look": look, "method": "formula"} for look in AGX_LOOKS),
                    {"look": "high_contrast", "range": "hdr", "method": "formula"},
                    {"look": "punchy", "range": "hdr"}, {"look": "low_contrast", "limit": "p3d65"}],
    "khronos_neutral": [{"start_compression": 0.1}, {"start_compression": 0.99}, {"desaturation": 0},
                        {"desaturation": 1, "start_compression": 0.5}],
    "khronos_neutral_filament": [{"start_compression": 0.1}, {"start_compression": 0.99}, {"desaturation": 0},
                                 {"desaturation": 1, "start_compression": 0.5}],
    "khronos_neutral_needle": [],
    "gt7": [{"output": "hdr"}, {"output": "hdr", "peak": 250}, {"output": "hdr", "peak": 10000}],
    "frostbite": [{"linear_end": 0.01}, {"linear_end": 0.5}, {"linear_end": 0.99}],
    "somewhat_boring": [],
    "bt2390": [*EETF, {"knee_offset": 1, "black_lift": "libplacebo"}, {"knee_offset": 2},
               *({**e, "knee_offset": 1, "black_lift": "libplacebo"} for e in EETF)],
    "bt2446a": EETF,
    "spline": [*({"apply": "channels", **e} for e in EETF), EETF[2], {"contrast": 0}, {"contrast": 1.5}, {"average": 5}, {"average": 10000, "contrast": 1}],
    "camera_response": [{"iso": 1e-5}, {"iso": 0.5}, {"iso": 65504}],
    "false_color": [{"palette": "lygia"}],
}
# Operator -> preset -> what it sets.
PRESETS = {
    "clamp": {"max": MAX},
    "exponential": {"channels": {"apply": "channels"}, "babylon": {"apply": "channels", "average": 0.9070250776},
                    "babylon_photographic": {"apply": "channels", "average": 1.442695041}},
    "reinhard": {"luminance": LUMINANCE, "max": MAX, "babylon": {**LUMINANCE, "weights": "babylon"},
                 "lygia": {**LUMINANCE, "weights": "lygia"}},
    "reinhard_extended": {"luminance": LUMINANCE, "max": MAX, "cesium": {"white": 1}},
    "reinhard2": {"three_stdlib": {"white": 16, "clamp": "no"}},
    "reinhard_jodie": {"lygia": {"weights": "lygia"}},
    "hable": {"gdc": {**HABLE_GDC, "exposure_bias": 1}, "godot": HABLE_GODOT, "no_bias": {"exposure_bias": 1},
              "postprocessing": {"exposure_bias": 1, "white": 4}, "ray_tracing_renderer": {"exposure_bias": 1, "white": 5},
              "mapbox": {"exposure_bias": 1, "white": 1000},
              "unity_neutral": {"shoulder_strength": 0.2, "linear_strength": 0.29, "linear_angle": 0.24,
                                "toe_strength": 0.272, "white": 5.3, "exposure_bias": 1.31338}},
    "hable_gdc": {"playcanvas": {"white": 6.2107773060570395, "black": 0.004}},
    "hejl_burgess_dawson": {"babylon": {"output": "squared"}},
    "lottes": {"vtk": {"contrast": 1.6773, "shoulder": 0.9714, "hdr_max": 11.0785, "mid_out": 0.18},
               "vtk_uncharted2": {"contrast": 1.1759, "shoulder": 0.9746, "hdr_max": 6.3704, "mid_out": 0.18}},
    "drago": {"pfstmo": {"bias_scales_average": "no"}},
    "ffmpeg": {curve: {"tonemap": curve} for curve in FFMPEG},
    "luma_gl": {"hdr": {"maximum_luminance": 4}},
    "agx_threejs": {"r161": {"clamp": "yes"}, "hdrify": {"matrices": "exact"}},
    "false_color": {"lygia": {"palette": "lygia"}},
    "hable_piecewise": {"film": FILM, "soft": SOFT},
    "toe": {"ramp": RAMP},
    "uchimura": {"hdr": {"max_brightness": 10}},
    "aces_narkowicz": {"matched": {"prescale": 0.6}, "unclamped": {"clamp": "no"}},
    "aces_hill": {"bakinglab": {"gain": 1.8}, "godot": {"prescale": 1.8, "white": 1, "clamp": "no"},
                  "threejs": {"prescale": 1 / 0.6}, "unclamped": {"clamp": "no"}},
    "aces_13": {"sdr_cinema": {"output": "sdr_cinema"}, "hdr_1000": {"output": "hdr_1000"}, "ctl": {"spline": "ctl"},
                "gamut_compressed": {"gamut_compression": "yes"}},
    "agx_blender": {"formula": {"method": "formula"}, "hdr": {"range": "hdr"}},
    "aces_filament": {"legacy": {"brightness": 1 / 0.6}},
    "unreal": {"legacy": UNREAL_LEGACY},
    "agx_minimal": {"order7": {"order": 7}},
    "gt7": {"hdr": {"output": "hdr"}},
    "bt2390": {"libplacebo": {"knee_offset": 1, "black_lift": "libplacebo", "apply": "luminance"}},
}
# Settings that contradict each other: both sides refuse them.
REFUSED = [
    ("reinhard", {**MAX, "color_correction": "nonlinear"}),
    ("reinhard", {**LUMINANCE, "saturation": 0.5}),
    ("reinhard", {**LUMINANCE, "saturation_from": "contrast"}),
    ("uchimura", {"pedestal": 0.05, **LUMINANCE}),
    ("toe", {"brightness": 0.1, **MAX}),
    ("lottes", {"shoulder": 0.01, "contrast": 2}),
    ("filament_generic", {"mid_out": 0.01, "hdr_max": 1, "mid_in": 0.9}),
    ("day", {"crossover": 20}),
    ("ffmpeg", {"tonemap": "mobius", "param": 1}),
    ("spline", {"target_black": 0.05}),
    ("opencv_reinhard", {"minimum": 2, "maximum": 1}),
    ("opencv_drago", {"minimum": 0.6}),
    ("aces_13", {"output": "hdr_1000", "limit": "none"}),
    ("aces_20", {"primaries": "0.64 0.33 0.3 0.6 0.15 0.06"}),
]
# Operators whose views are run with every display and input: each kind of working primaries and output.
FULL_VIEWS = ("clamp", "agx_sobotka", "unreal", "gt7")
# Views in which settings and display want different things, and reference whites at their ends.
VIEWS = [
    {"operator": "aces_13", "settings": {"output": "hdr_4000"}, "display": "srgb"},
    {"operator": "aces_13", "settings": {"output": "hdr_4000", "limit": "rec2020"}, "display": "p3d65_pq"},
    {"operator": "aces_13", "settings": {"limit": "none"}, "display": "rec2020"},
    {"operator": "aces_13", "display": "rec2100_pq", "reference_white": 50},
    {"operator": "aces_20", "settings": {"peak": 500, "limit": "p3d65"}, "display": "rec2100_pq"},
    {"operator": "aces_20", "settings": {"primaries": P3D60}, "display": "display_p3"},
    {"operator": "aces_20", "settings": {"primaries": P3D60}, "display": "linear"},
    {"operator": "aces_20", "display": "p3d65_pq", "reference_white": 1000},
    {"operator": "agx_blender", "settings": {"range": "sdr"}, "display": "rec2100_hlg"},
    {"operator": "agx_blender", "preset": "hdr", "settings": {"range": "hdr"}, "display": "srgb"},
    {"operator": "agx_blender", "look": "punchy", "display": "p3d65_pq", "reference_white": 203},
    {"operator": "gt7", "settings": {"output": "hdr"}, "display": "display_p3"},
    {"operator": "gt7", "display": "rec2100_pq", "reference_white": 1000},
    {"operator": "uchimura", "settings": {"max_brightness": 2}, "display": "rec2100_hlg", "reference_white": 203},
    {"operator": "uchimura", "preset": "hdr", "settings": {"max_brightness": 10}, "display": "rec1886"},
    {"operator": "hable_piecewise", "preset": "soft", "settings": SOFT, "display": "rec2100_pq"},
    {"operator": "bt2390", "settings": {"target_peak": 400}, "display": "rec2100_pq", "reference_white": 203},
    {"operator": "spline", "settings": {"output": "sdr"}, "display": "rec2100_hlg"},
]


def samples(count=2000):
    """Colors as (count, 3): grays, hues, out of gamut, beyond every limit, random."""
    gray = 0.18 * 2.0 ** np.arange(-12, 12.01, 0.5)
    hues = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1), (0.8, 0.1, 0.05), (0.05, 0.1, 2)]
    limits = [0.0, -0.0, 1e-7, 1e-10,
               -0.1, -5.0, 1.0, 4.0, 11.2, 65504.0, 70000.0, 1e30, np.inf, -np.inf, np.nan]
    special = np.concatenate([
        np.repeat(gray[:, None], 3, axis=1),
        *(np.array(hues) * gain for gain in (0.01, 0.18, 1, 8, 1000)),
        np.repeat(np.array(limits)[:, None], 3, axis=1),
        np.stack([limits, np.roll(limits, 5), np.roll(limits, 7)], axis=1),
    ])
    rng = np.random.default_rng(20240229)
    n = count - len(special)
    scene = 0.18 * 2.0 ** rng.uniform(-12, 12, (n, 3))  # any hue
    near = 0.18 * 2.0 ** (rng.uniform(-10, 10, (n, 1)) + rng.uniform(-1, 1, (n, 3)))  # as pictures have them
    signs = np.where(rng.random((n, 3)) < 0.4, -1, 1)
    signed = signs * 0.18 * 2.0 ** rng.uniform(-6, 6, (n, 3))
    kinds = rng.choice(3, (n, 1), p=[0.5, 0.3, 0.2])
    return np.concatenate([special, np.select([kinds == 0, kinds == 1], [scene, near], signed)])


def unique(sets):
    """Sets of settings without repetitions, in order."""
    return list({tuple(s.items()): s for s in sets}.values())


def runs():
    """Keyword arguments of operators.view for every run; "preset" is for this program."""
    inputs, displays = list(operators.INPUTS), list(operators.DISPLAYS)
    for number, (operator, sets) in enumerate(SETTINGS.items()):
        for settings in unique([{}, *sets, *(APPLY if operator in CURVES else [])]):
            yield {"operator": operator, "settings": {k: v for k, v in settings.items() if k != "look"},
                   "look": settings.get("look", ""), "display": "native"}
        for preset, settings in PRESETS.get(operator, {}).items():
            yield {"operator": operator, "preset": preset, "settings": settings, "display": "native"}
        # A view is the same code for every operator, but for its working primaries and kind of output: so only
        # some of the displays and inputs, others for the next operator. (A process takes 0.2 s for any number of colors.)
        full = operator in FULL_VIEWS
        for space in inputs if full else [inputs[number % len(inputs)]]:
            yield {"operator": operator, "input": space, "display": "linear", "exposure": 2}
        full = full or operator in operators.FROM_DISPLAY
        for k in range(len(displays) if full else 2):
            display = displays[(number + k) % len(displays)]
            white = {"reference_white": 203} if operators.DISPLAYS[display].is_hdr and (number + k) % 2 else {}
            yield {"operator": operator, "display": display, "exposure": -1.5, **white}
    yield from VIEWS


def command(binary, view):
    """`tonewright eval` for a run; also the text that names the run."""
    preset = view.get("preset")
    options = [] if preset else [f"--set={name}={value}" for name, value in view.get("settings", {}).items()]
    options += [f"--{name.replace('_', '-')}={view[name]}"
                for name in ("look", "exposure", "input", "display", "reference_white") if view.get(name)]
    name = view["operator"] + (f":{preset}" if preset else "")
    label = " ".join([name, *options]).replace("--set=", "").replace("--", "")
    return [binary, "eval", name, "--engine=reference", "--digits=17", *options], label


def evaluate(arguments, rgb):
    """Colors through the program; raises ValueError when it does not answer with as many."""
    text = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in rgb.tolist())
    result = subprocess.run(arguments, input=text, capture_output=True, text=True, check=False)
    if result.returncode:
        raise ValueError(f"exit {result.returncode}: {result.stderr.strip()}")
    out = np.array([line.split() for line in result.stdout.splitlines()], float)
    if out.shape != rgb.shape:
        raise ValueError(f"printed {out.shape}, expected {rgb.shape}")
    return out


def compare(binary, view, rgb):
    """One line of the table and whether the run passed."""
    arguments, label = command(binary, view)
    line = f"{label[:110]:110s} {len(rgb):5d}"
    expected = operators.view(rgb=rgb, **{k: v for k, v in view.items() if k != "preset"})
    try:
        actual = evaluate(arguments, rgb)
    except ValueError as error:
        return f"{line}  FAIL {error}", False
    light, wanted = actual, expected
    if view["display"] in DISPLAY_LIGHT:
        light, wanted = (DISPLAY_LIGHT[view["display"]](np.maximum(code, 0)) for code in (actual, expected))
    error = np.abs(light - wanted)
    size = np.maximum(np.abs(wanted).max(-1, keepdims=True), HIDDEN_TERMS.get(view["operator"], 1))
    ratio = error / (RELATIVE * np.abs(wanted) + ABSOLUTE * size)
    ok = bool((ratio <= 1).all())  # NaN fails
    line += f" {error.max():9.2e} {ratio.max():9.3g}  {'ok' if ok else 'FAIL'}"
    if not ok:
        i = np.unravel_index(np.argmax(np.where(np.isnan(ratio), np.inf, ratio)), ratio.shape)[0]
        line += f"\n  in {rgb[i].tolist()}: is {actual[i].tolist()}, expected {expected[i].tolist()}"
    return line, ok


def refuse(binary, operator, settings):
    """As compare, of settings that both sides have to refuse."""
    arguments, label = command(binary, {"operator": operator, "settings": settings, "display": "native"})
    accepted = []
    for side, attempt in (("the package", lambda: operators.view(operator, [0.18] * 3, settings)),
                          ("the program", lambda: evaluate(arguments, np.full((1, 3), 0.18)))):
        try:
            attempt()
            accepted.append(side)
        except ValueError:
            pass
    line = f"{label[:110]:110s} refused"
    return (f"{line}  FAIL {' and '.join(accepted)} took it", False) if accepted else (f"{line}  ok", True)


def main(arguments):
    if not arguments:
        print("usage: check_operators.py TONEWRIGHT [OPERATOR ...]", file=sys.stderr)
        return 2
    binary, *chosen = arguments
    rgb = samples(2000 if os.environ.get("TONEWRIGHT_TEST_ALL") == "1" else 600)
    jobs = [lambda view=view: compare(binary, view, rgb) for view in runs() if not chosen or view["operator"] in chosen]
    jobs += [lambda case=case: refuse(binary, *case) for case in REFUSED if not chosen or case[0] in chosen]
    print(f"{'operator settings':110s} {'N':>5s} {'max error':>9s} {'x toler.':>9s}")
    results = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for line, ok in pool.map(lambda job: job(), jobs):
            print(line)
            results.append(ok)
    missing = [name for name in operators.OPERATORS if name not in (*SETTINGS, *operators.DEFECTS)]
    for name in missing:
        print(f"{name}: not in SETTINGS  FAIL")
    results += [False] * len(missing)
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
