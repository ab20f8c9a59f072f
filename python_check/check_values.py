# SPDX-License-Identifier: Apache-2.0
"""Which operator and settings every figure of reference/check_values.json belongs to, or why there is none.

    TONEWRIGHT_SHARED=<folder> python3 check_values.py            the table; exits 1 when an entry has neither
    TONEWRIGHT_SHARED=<folder> python3 check_values.py --compare  operators/ against every mapped figure

The figures are computed from the authors' own code, or from independent transcriptions of it, in double precision;
they have 12 digits.
"""

import json
import os
import re
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Optional

import numpy as np

import operators

CSV_FOLDER = Path(__file__).parent.parent / "tests" / "data"
SHARED = "$TONEWRIGHT_SHARED"  # how a setting names a file in that folder

EXACT = 1e-9  # 12 digits, and double arithmetic in another order
FLOOR = 1e-3  # relative errors are of max(|expected|, FLOOR), as in operators.csv
SELF_FLOOR = 1e-9  # absolute error that --compare always allows


@dataclass(frozen=True)
class Mapping:
    """An operator and how its values correspond to a figure.

    figure = limit(output_scale * operator(input_scale * 2^exposure * input)); `limit` is applied to the figure alone,
    where the operator limits what the source leaves unlimited, or where the figure is in another space.
    """

    operator: str
    settings: str = ""  # as in operators.csv: what differs from the defaults
    look: str = ""
    input: str = "lin_rec709"
    output: str = "native"  # or "linear"
    tolerance: float = EXACT  # relative
    absolute: float = 0.0  # absolute precision of the figures, where they have fewer digits
    reason: str = ""  # of a tolerance other than EXACT, and of a limit
    input_scale: float = 1.0
    output_scale: float = 1.0
    exposure: float = 0.0  # stops
    limit: Optional[Callable] = None

    def scene(self, entry):
        """The scene-linear values that the entry's input stands for, exposure included."""
        return np.array(entry["input"], float) * self.input_scale * 2.0**self.exposure

    def expected(self, entry):
        """The operator's output that the entry's figure stands for."""
        figure = np.array(entry["output"], float)
        return (self.limit(figure) if self.limit else figure) / self.output_scale

    def row_tolerance(self, entry):
        """Relative tolerance of the row, with the figures' absolute precision in it."""
        smallest = max(np.abs(self.expected(entry)).min(), FLOOR)
        return max(self.tolerance, self.absolute / self.output_scale / smallest)


# The figures read Sobotka's LUT: 4096 entries of seven decimals, interpolated linearly, up to 1.4e-7 of the value
# off the curve after the looks. With such a table operators/ gives the figures to 12 digits (test_operators.py).
SOBOTKA = {"tolerance": 2e-7, "reason": "the figures read a LUT of 4096 seven-decimal entries"}
# The published matrices and their published inverses are no exact pair, and their luminance row is not ours.
XYY_4DIGIT = {"tolerance": 1e-3,
              "reason": "the 4-digit matrix and inverse: 5.5e-5 of the largest channel, 9.2e-4 of a small one"}
XYY_LINDBLOOM = {"tolerance": 5e-5, "reason": "the 7-digit luminance row (0.2126729 0.7151522 0.0721750) and inverse"}
GODOT = ("shoulder_strength=0.88;linear_strength=0.6;linear_angle=0.1;toe_strength=0.2;toe_numerator=0.01;"
         "toe_denominator=0.3;white=1;exposure_bias=1")
MANTIUK = "white=4;apply=luminance;color_correction={};saturation=0.6"
PIECEWISE = {"tolerance": EXACT, "absolute": 6e-10, "reason": "figures of 10 digits, good to 5e-10 absolute"}
PIECEWISE_SETS = {
    "default(0,.5,0,.5,0,1)": "",
    "A(.5,.5,2,.5,1,1)": "toe_strength=0.5;shoulder_strength=2;shoulder_angle=1",
    "A-gamma1/2.2(.5,.5,2,.5,1,1/2.2)":
        f"toe_strength=0.5;shoulder_strength=2;shoulder_angle=1;gamma={1 / 2.2!r}",
    "B(.2,.3,4,.7,.4,1)": "toe_strength=0.2;toe_length=0.3;shoulder_strength=4;shoulder_length=0.7;shoulder_angle=0.4",
}
RODS = "photopic_adaptation=2;scotopic_adaptation=1.5;rod_weight_from=fixed;rod_weight=0.5"
DEVLIN = ("intensity=-1;contrast=0.5;chromatic_adaptation=0.3;light_adaptation=0.7;mean_red=0.6;mean_green=0.5;"
          "mean_blue=0.4;mean_luminance=0.5")
REC2020 = {"input": "lin_rec2020"}
# Scene-linear 1 stands for 100 cd/m2 and output 1 for the target's peak; the figures are in cd/m2.
NITS = {**REC2020, "input_scale": 1 / 100, "output_scale": 100.0}
RESPONSE = f"file={SHARED}/data/camera_response/"


def from_xyz(primaries):
    """CIE XYZ under D65 to light of `primaries`, for Mapping.limit."""
    to_xyz = operators.rgb_to_xyz("rec709") @ operators.rgb_to_rgb(primaries, "rec709")
    return lambda figure: np.linalg.solve(to_xyz, figure)


ACES_SDR_XYZ = {"limit": from_xyz("ap1"), "absolute": 5e-12, "reason": "the figures are XYZ of 12 digits"}
ACES_HDR_XYZ = {"limit": from_xyz("rec2020"), "absolute": 2e-10, "reason": "the figures are XYZ of 12 digits"}
ACES_HDR_CTL = {**ACES_HDR_XYZ, "tolerance": 2e-8, "reason": "XYZ figures, of curves through knots of 9 digits"}
ACES_HDR_PQ = {"limit": lambda code: operators.pq.pq_decode(code) / 100, "reason": "the figures are Rec.2100-PQ codes"}


def aces_13_hdr(name, peak, limit, spline):
    """Mapping of aces13_hdr_xyz and aces13_hdr_pq."""
    settings = ("output=hdr_cinema" if peak == 108 else f"output=hdr_{peak}") + f";limit={limit}"
    if spline == "ctl":
        return Mapping("aces_13", settings + ";spline=ctl", **ACES_HDR_CTL)
    return Mapping("aces_13", settings, **(ACES_HDR_PQ if name == "aces13_hdr_pq" else ACES_HDR_XYZ))


# OpenColorIO starts its search for a cusp from the one before: M differs by 1e-5, a small channel by 3e-7.
ACES_20_OCIO = {"tolerance": 4e-7, "reason": "OpenColorIO's searches for cusps end elsewhere in their tolerance"}
ACES_20_XYZ = {limit: {"limit": from_xyz(limit), **ACES_20_OCIO} for limit in ("rec709", "rec2020")}
ACES_20_LIMITS = {"REC709": "rec709", "P3-D65": "p3d65", "REC2020": "rec2020"}


def aces_20(entry):
    """Mapping of aces2_<SDR or HDR>-<peak>nit-<limiting primaries>, or None.

    >>> aces_20({"operator": "aces2_HDR-500nit-REC2020", "params": {"peak": 500}, "space": "ACES2065-1 -> "}).settings
    'peak=500;limit=rec2020'
    """
    name = re.fullmatch(r"aces2_.DR-(\d+)nit-(REC709|P3-D65|REC2020)(_xyz)?", entry["operator"])
    if not name:
        return None
    limit = ACES_20_LIMITS[name[2]]
    peak = entry["params"].get("peak", int(name[1]))  # of the 108 cd/m2 of cinemas: 225, before a factor of 0.48
    settings = [f"peak={peak}"] * (peak != 100) + [f"limit={limit}"] * (limit != "rec709")
    accuracy = ACES_20_XYZ[limit] if name[3] else {} if "peak" in entry["params"] else ACES_20_OCIO
    space = "lin_rec709" if entry["space"].startswith("rec709") else "lin_ap0"
    return Mapping("aces_20", ";".join(settings), input=space, **accuracy)


AGX_CODE = {"limit": lambda code: code**2.4, "reason": "the figures are codes of a 2.4 power"}
AGX_FILE = {**AGX_CODE, "tolerance": 4e-7, "reason": "codes of a 2.4 power, from a file of seven decimals"}
AGX_HLG = {"limit": operators.agx_blender.hlg_decode, "tolerance": 4e-9,
           "reason": "the figures are HLG codes, with the constant c of eight printed digits"}


def agx_blender(entry):
    """Mapping of agx_blender_lut_encoded and agx_blender_look_*, a reason, or None.

    >>> agx_blender({"operator": "agx_blender_look_punchy_lut", "params": {"look": "punchy"}}).look
    'punchy'
    """
    name, params = entry["operator"], entry["params"]
    if name == "agx_blender_lut_encoded":
        return Mapping("agx_blender", **(AGX_CODE if params["lut"].startswith("rebuilt") else AGX_FILE))
    if name.startswith("agx_blender_look_"):
        return Mapping("agx_blender", "" if name.endswith("_lut") else "method=formula", params["look"], **AGX_CODE)
    if name in ("agx_blender_exact_p3_encoded", "agx_blender_exact_rec2020_encoded") and entry["input"] == [0, 32, 32]:
        return "a figure with the log limited to 1; Blender's cubes of P3 and Rec.2020 are without that limit"
    return None


# Name -> Mapping, for the names with one set of parameters.
MAPPINGS = {
    "linear_clamp": Mapping("clamp"),
    # With white = 1 the curve is the identity and nothing is limited: what is left is the exposure.
    "exposure_ev": Mapping("reinhard_extended", "white=1", exposure=1.0),
    "divide_constant_clamp": Mapping("linear", "divisor=4"),
    "reinhard_rgb": Mapping("reinhard"),
    "reinhard_luminance": Mapping("reinhard", "apply=luminance"),
    "reinhard_extended_rgb": Mapping("reinhard_extended", "white=4"),
    "reinhard_extended_luminance": Mapping("reinhard_extended", "white=4;apply=luminance"),
    "reinhard_extended_xyY_4digit": Mapping("reinhard_extended", "white=4;apply=luminance", **XYY_4DIGIT),
    "reinhard_extended_xyY_lindbloom": Mapping("reinhard_extended", "white=3;apply=luminance",
                                               input_scale=1 / (9.6 * 0.1 + 0.0001), **XYY_LINDBLOOM),
    "reinhard_jodie": Mapping("reinhard_jodie"),
    "mantiuk_nonlinear": Mapping("reinhard_extended", MANTIUK.format("nonlinear")),
    "mantiuk_luminance_preserving": Mapping("reinhard_extended", MANTIUK.format("luminance_preserving")),
    "hable_uncharted2": Mapping("hable"),
    # The curve before it is divided by its value at 11.2 (the dossier, section 3.1).
    "hable_uncharted2_partial": Mapping("hable", "exposure_bias=1", output_scale=0.725129378439),
    "hable_godot_filmic": Mapping("hable", GODOT),
    "aces_narkowicz": Mapping("aces_narkowicz"),
    "aces_narkowicz_0.6": Mapping("aces_narkowicz", "prescale=0.6"),
    "aces_hill_unclamped": Mapping("aces_hill", "clamp=no"),
    "aces_hill": Mapping("aces_hill"),
    "aces_hill_three": Mapping("aces_hill", "prescale=1.6666666666666667"),
    "aces_hill_godot": Mapping("aces_hill", "prescale=1.8;white=1;clamp=no"),
    "aces1_sdr_video_rec709": Mapping("aces_13", "spline=ctl"),
    "aces1_sdr_srgb_encoded": Mapping("aces_13", "spline=ctl", limit=operators.false_color.srgb_decode,
                                      reason="the figures are sRGB codes"),
    "aces1_sdr_video_rec709_AP0in": Mapping("aces_13", "spline=ctl", input="lin_ap0"),
    "aces1_sdr_video_xyz": Mapping("aces_13", "limit=none;spline=ctl", input="lin_ap0", **ACES_SDR_XYZ),
    "aces13_sdr_video_xyz": Mapping("aces_13", "limit=none", **ACES_SDR_XYZ),
    "aces13_sdr_video_rec709lim": Mapping("aces_13"),
    "aces13_sdr_video_p3lim": Mapping("aces_13", "limit=p3d65"),
    "aces13_sdr_cinema_xyz": Mapping("aces_13", "output=sdr_cinema;limit=none", **ACES_SDR_XYZ),
    "unreal_film_default": Mapping("unreal", output="linear"),
    "unreal_film_default_ap1": Mapping("unreal", input="lin_ap1"),
    "unreal3_simple": Mapping("ue3"),
    "uchimura_gt": Mapping("uchimura"),
    "uchimura_gt_hdr": Mapping("uchimura", "max_brightness=10"),
    "lottes": Mapping("lottes"),
    "filament_generic": Mapping("filament_generic"),
    "agx_sobotka_lut": Mapping("agx_sobotka", **SOBOTKA),
    "agx_sobotka_punchy": Mapping("agx_sobotka", look="punchy", **SOBOTKA),
    "agx_sobotka_golden": Mapping("agx_sobotka", look="golden", **SOBOTKA),
    "agx_minimal_encoded": Mapping("agx_minimal"),
    "agx_minimal_linear": Mapping("agx_minimal", output="linear"),
    "agx_three_rec2020": Mapping("agx_threejs"),
    "agx_filament_rec2020": Mapping("agx_filament", **REC2020),
    "agx_godot_4.4": Mapping("agx_godot44"),
    "agx_godot_4.6": Mapping("agx_godot"),
    "agx_blender_exact_encoded": Mapping("agx_blender", "method=formula", **AGX_CODE),
    "agx_blender_exact_p3_encoded": Mapping("agx_blender", "method=formula;limit=p3d65", **AGX_CODE),
    "agx_blender_exact_rec2020_encoded": Mapping("agx_blender", "method=formula;limit=rec2020", **AGX_CODE),
    "agx_blender_exact_linear": Mapping("agx_blender", "method=formula"),
    "agx_blender_hdr1000_linear": Mapping("agx_blender", "method=formula;range=hdr"),
    "agx_blender_hdr1000_hlg_lut": Mapping("agx_blender", "range=hdr", **AGX_HLG),
    "camera_response_dorf": Mapping("camera_response", RESPONSE + "Portra-400NCCD.rf"),
    "camera_response_dscs315_1": Mapping("camera_response", RESPONSE + "dscs315-1.rf;curve=red"),
    "log_tonemap": Mapping("log_tonemap", "limit=16"),
    "log_tonemap_hacky_contrast": Mapping(
        "log_tonemap", "limit=16;contrast=0.5", limit=lambda figure: np.where(figure < 0, 1, figure),
        reason="far above 1 the contrast's cubic is negative; the operator limits to [0, 1] before it: 1"),
    "nebula_fixed": Mapping("nebula"),
    "nebula_as_printed": Mapping("nebula_as_printed"),
    "hejl_burgess_dawson": Mapping("hejl_burgess_dawson"),
    "hejl_2015": Mapping("hejl_2015", "white=11.2"),
    "aldridge": Mapping("aldridge"),
    "day_insomniac": Mapping("day"),
    "exponential_luminance": Mapping("exponential"),
    "exponential_rgb": Mapping("exponential", "apply=channels"),
    "logarithmic_luminance": Mapping("logarithmic"),
    "exponentiation_luminance": Mapping("exponentiation"),
    "schlick_corrected": Mapping("schlick"),
    "drago": Mapping("drago"),
    "ward": Mapping("ward", "log_average=0.5"),
    "tumblin_rushmeier": Mapping("tumblin_rushmeier", "log_average=0.5"),
    "ferwerda": Mapping("ferwerda", RODS),
    "durand_dorsey_rods": Mapping("durand_dorsey_rods", RODS),
    "khronos_pbr_neutral": Mapping("khronos_neutral"),
    "gt7_sdr": Mapping("gt7", **REC2020),
    "gt7_hdr1000": Mapping("gt7", "output=hdr", **REC2020),
    "somewhat_boring": Mapping("somewhat_boring"),
    "frostbite_hue_preserving": Mapping("frostbite"),
    "bt2390_eetf": Mapping("bt2390", "knee_offset=1;black_lift=libplacebo", **NITS),
    "bt2390_eetf_spec": Mapping("bt2390", **NITS),
    "bt2390_eetf_black": Mapping(
        "bt2390", "source_black=0.005;target_black=0.05;knee_offset=1;black_lift=libplacebo", **NITS),
    "bt2390_eetf_black_spec": Mapping("bt2390", "source_black=0.005;target_black=0.05", **NITS),
    "bt2446a": Mapping("bt2446a", **NITS),
}

# Beginning of a name -> why none of its entries has an operator.
REASONS = {
    "aces13_sdr_cinema_p3dci": "the XYZ of aces13_sdr_cinema_xyz on a projector with the DCI white, which is no "
                               "display here",
    "aces13_sdr_video_d60sim": "left out: a simulation of the ACES white on a display of D65",
    "aces13_sdr_cinema_d60sim": "left out: a simulation of the ACES white on a projector",
    "aces13_sdr_cinema_d65sim": "left out: a simulation of D65 on a projector with the DCI white",
    "aces13_reference_gamut_compression": "a step of aces_13; test_operators.py holds aces_13.compress_gamut to it",
    "aces2_inverse_": "the inverse of aces_20; test_operators.py holds aces_20.aces_20_inverse to it",
    "agx_sigmoid_SB2383": "the inner curve of agx_blender; test_operators.py holds agx_sigmoid to it",
    "agx_sobotka_curve": "the inner curve of agx_sobotka: behind the inset these values need negative colors, which "
                         "the operator limits; sobotka_table is held to it in test_operators.py",
    "reinhard_local": "a local operator, which reads its neighbors; the _64_repo_ figures also have a kernel bug",
    "exposure_fusion": "a local operator, which reads a pyramid of the picture",
    "auto_exposure": "a statistic of a picture, not of a color",
    "display_rec2100": "a display encoding, tested in tests/unit/color and test_check_values.py",
    "srgb_encode": "a display encoding, tested in tests/unit/color and test_check_values.py",
    "pq_encode_nits": "a display encoding, tested in tests/unit/color and test_check_values.py",
    "hlg_oetf": "a display encoding, tested in tests/unit/color and test_check_values.py",
    "tony_mc_mapface": "left out: the operator is a LUT of 48^3 texels without a formula",
    "opendrt": "left out: its code is GPL-3.0, and the description in the dossier covers a part of its 60 parameters",
    "filmic_blender": "left out: two LUTs without a formula, whose license is unclear",
}


def classify(entry):
    """Mapping of an entry of check_values.json, or a sentence why there is none, or '' when nothing is known of it.

    >>> classify({"operator": "reinhard_luminance", "params": {}}).settings
    'apply=luminance'
    >>> classify({"operator": "hlg_oetf", "params": {}})
    'a display encoding, tested in tests/unit/color and test_check_values.py'
    """
    name, params = entry["operator"], entry["params"]
    if mapping := agx_blender(entry):
        return mapping
    if name in MAPPINGS:
        return MAPPINGS[name]
    if name == "aces_filament":
        brightness = {1.0: "", "1/0.6": f"brightness={1 / 0.6!r}"}[params["brightness"]]
        return Mapping("aces_filament", brightness, **REC2020)
    if mapping := aces_20(entry):
        return mapping
    if name in ("aces13_hdr_xyz", "aces13_hdr_pq"):
        return aces_13_hdr(name, params["peak"], params["limit"], params["spline"])
    if name == "hable_piecewise_power":
        return Mapping("hable_piecewise", PIECEWISE_SETS[next(iter(params.values()))], **PIECEWISE)
    if name == "libplacebo_spline":
        if params["avg"] == 0:
            return Mapping("spline", "apply=channels", **NITS)
        return replace(Mapping("spline", "source_peak=4000;target_peak=600;average=26;apply=channels", **NITS),
                       output_scale=600.0)
    if name == "reinhard_devlin":
        return Mapping("reinhard_devlin", DEVLIN if params["f"] else "")
    return next((reason for start, reason in REASONS.items() if name.startswith(start)), "")


def parse_settings(text, shared=None):
    """'white=4;apply=max' -> keyword arguments of an operator; files are found beside operators.csv or in `shared`.

    >>> parse_settings("white=4;apply=max")
    {'white': 4.0, 'apply': 'max'}
    """
    settings = {}
    for item in filter(None, text.split(";")):
        name, value = item.split("=", 1)
        try:
            settings[name] = float(value)
        except ValueError:
            settings[name] = value
        if name == "file":
            folder = shared or os.environ.get(SHARED[1:], SHARED)
            settings[name] = str(CSV_FOLDER / value.replace(SHARED, str(folder)))
    return settings


def read_entries(shared):
    """Entries of reference/check_values.json in the folder `shared`."""
    return json.loads((Path(shared) / "reference" / "check_values.json").read_text(encoding="utf-8"))


def group(entries):
    """[(name, mapping or reason, entries)] in the order of the file."""
    groups = {}
    for entry in entries:
        groups.setdefault((entry["operator"], classify(entry)), []).append(entry)
    return [(name, mapping, members) for (name, mapping), members in groups.items()]


def compare(mapping, entries, shared):
    """Largest error of the NumPy operator, and the largest error in units of what is allowed."""
    errors, ratios = [], []
    for entry in entries:
        actual = operators.view(mapping.operator, mapping.scene(entry), parse_settings(mapping.settings, shared),
                                mapping.look, input=mapping.input, display=mapping.output)
        expected = mapping.expected(entry)
        error = np.abs(actual - expected)
        allowed = np.maximum(mapping.tolerance * np.abs(expected), max(mapping.absolute / mapping.output_scale,
                                                                       SELF_FLOOR))
        errors.append(error.max())
        ratios.append((error / allowed).max())
    return max(errors), max(ratios)


def describe(mapping):
    """'operator settings ...' of a mapping."""
    parts = [mapping.operator, mapping.settings, mapping.look and f"look={mapping.look}"]
    parts += [mapping.input != "lin_rec709" and mapping.input, mapping.output != "native" and mapping.output]
    parts += [mapping.exposure and f"exposure={mapping.exposure:g}"]
    parts += [scale != 1 and f"{name} x {scale:.12g}"
              for name, scale in (("in", mapping.input_scale), ("out", mapping.output_scale))]
    parts += [mapping.tolerance != EXACT and f"tolerance={mapping.tolerance:g}"]
    return " ".join(filter(None, parts)) + (f"  ({mapping.reason})" if mapping.reason else "")


def main(arguments):
    if arguments not in ([], ["--compare"]):
        print("usage: check_values.py [--compare]", file=sys.stderr)
        return 2
    shared = os.environ.get("TONEWRIGHT_SHARED")
    if not shared:
        print("skipped: TONEWRIGHT_SHARED unset; expected the folder that holds reference/check_values.json")
        return 0
    failed = mapped = total = 0
    for name, mapping, entries in group(read_entries(shared)):
        total += len(entries)
        line = f"{name:36s} {len(entries):3d}  "
        if not mapping:
            line += "NEITHER MAPPING NOR REASON"
            failed += 1
        elif isinstance(mapping, str):
            line += "" if arguments else f"- {mapping}"
        else:
            mapped += len(entries)
            if arguments:
                error, ratio = compare(mapping, entries, shared)
                ok = bool(ratio <= 1)  # NaN fails
                failed += not ok
                line += f"{error:8.1e}  {ratio:8.2g} x tolerance  {'ok' if ok else 'FAIL'}  "
            line += describe(mapping)
        if not (arguments and isinstance(mapping, str) and mapping):
            print(line)
    print(f"{total} entries, {mapped} mapped, {total - mapped} not; {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
