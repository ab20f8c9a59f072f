# SPDX-License-Identifier: Apache-2.0
"""Every name of --input: `tonewright eval` against formulas of the standards and the makers, and against OpenColorIO.

    python3 python_check/check_input_spaces.py build/release/bin/tonewright [ocio_config/config.ocio]

An operator that changes nothing maps code values to linear Rec.709. Needs NumPy; without PyOpenColorIO, the comparison with
the config is skipped, and one line says so. The last line is `N passed, M failed`.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from lut_encodings import ENCODINGS, acescct_decode, davinci_decode, logc3_decode, srgb_decode
from operators.pq import pq_decode
from operators.spaces import BRADFORD, CAMERAS, CAT02, D65, HLG_A, HLG_B, HLG_C, HLG_FLOOR, PRIMARIES, rgb_to_rgb, rgb_to_xyz

HALF_MAX = 65504.0
IDENTITY = """tonewright = 1
id = "unchanged"
title = "Unchanged"

[[stage]]
curve = "x"
"""

# --------------------------------------------------------------------------------------------------
# Code values: black, grays, saturated colors, negatives, above 1.
CODES = np.array([[0.0, 0.0, 0.0], [0.05, 0.05, 0.05], [0.18, 0.18, 0.18], [0.4135884, 0.4135884, 0.4135884],
                  [0.7, 0.7, 0.7], [1.0, 1.0, 1.0],
                  [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.9, 0.2, 0.05], [0.1, 0.6, 0.35], [0.3, 0.25, 0.8],
                  [-0.05, 0.2, 0.4], [-0.3, -0.1, -0.02], [1.1, 0.9, 0.5], [0.5, 1.2, 1.3]])
INSIDE = CODES[(CODES >= 0).all(axis=1) & (CODES <= 1).all(axis=1)]

# --------------------------------------------------------------------------------------------------
# Curves, code value -> light


def power(exponent, unit=1.0):
    return lambda code: unit * np.maximum(code, 0) ** exponent


def srgb(code):
    """IEC 61966-2-1; negatives follow the straight part."""
    return srgb_decode(np.asarray(code, float).clip(0)) + np.minimum(code, 0) / 12.92


def mirrored(curve):
    return lambda code: np.sign(code) * curve(np.abs(code))


def pq(code):
    return mirrored(lambda c: pq_decode(np.minimum(c, 1)) / 100)(code)


def smpte_240m(code):
    """H.273, value 7: V = 4 L below L = 0.0228, else 1.1115 L^0.45 - 0.1115."""
    return np.where(code < 4 * 0.0228, code / 4, ((np.maximum(code, 0) + 0.1115) / 1.1115) ** (1 / 0.45))


def bt709_camera(code):
    """ITU-R BT.709-6, item 1.2."""
    return np.where(code < 0.081, code / 4.5, ((np.maximum(code, 0) + 0.099) / 1.099) ** (1 / 0.45))


def log_range(decades):
    """H.273, values 9 and 10: V = 1 + log10(L)/decades, 0 below."""
    return lambda code: 10.0 ** (decades * (np.maximum(code, 0) - 1))


def bt1361(code):
    """H.273, value 12: a quarter of the mirrored curve at four times the value."""
    return np.where(code < 0, -(np.maximum(-4 * code, 0) ** 2.4) / 4, np.maximum(code, 0) ** 2.4)


def hlg_scene(code):
    """ITU-R BT.2100-2, table 5, inverse OETF."""
    c = np.abs(code)
    return np.sign(code) * np.where(c <= 0.5, c * c / 3, (np.exp((c - HLG_C) / HLG_A) + HLG_B) / 12)


def hlg_display(weights):
    """The light of a display of 1000 cd/m2, 1 is 100: the OOTF multiplies by the luminance to the 0.2. A color of negative
    luminance is black."""
    floor = HLG_FLOOR ** (1 / 1.2)

    def decode(code):
        scene = hlg_scene(code)
        y = (scene @ np.asarray(weights))[..., None]
        return np.where(y > 0, 10 * scene * np.maximum(y, floor) ** 0.2, 0)

    return decode


def acescc(code):
    """Academy S-2014-003."""
    light = 2.0 ** (code * 17.52 - 9.72)
    return np.where(code < (9.72 - 15) / 17.52, (light - 2.0**-16) * 2, light)


def logc4(code):
    """ARRI, "LogC4 Logarithmic Color Space, Specification", 2022, 4.1."""
    a, b, c = (2.0**18 - 16) / 117.45, (1023 - 95) / 1023, 95 / 1023
    s = 7 * np.log(2) * 2.0 ** (7 - 14 * c / b) / (a * b)
    t = (2.0 ** (14 * (-c / b) + 6) - 64) / a
    return np.where(code < 0, code * s + t, (2.0 ** (14 * ((code - c) / b) + 6) - 64) / a)


def slog3(code):
    """Sony, "Technical Summary for S-Gamut3.Cine/S-Log3 and S-Gamut3/S-Log3"."""
    x = np.asarray(code, float) * 1023
    return np.where(x >= 171.2102946929, 10 ** ((x - 420) / 261.5) * 0.19 - 0.01,
                    (x - 95) * 0.01125 / (171.2102946929 - 95))


def canon_log2(code):
    """Canon, "Canon Log Gamma Curves", 2018; x 0.9, as its light 1 is a reflectance of 90 %."""
    c = np.asarray(code, float) - 0.092864125
    return 0.9 * np.sign(c) * (10 ** (np.abs(c) / 0.24136077) - 1) / 87.099375


def canon_log3(code):
    x = np.asarray(code, float)
    low = -(10 ** ((0.12783901 - x) / 0.36726845) - 1) / 14.98325
    high = (10 ** ((x - 0.12240537) / 0.36726845) - 1) / 14.98325
    return 0.9 * np.where(x < 0.097465473, low, np.where(x <= 0.15277891, (x - 0.12512219) / 1.9754798, high))


def vlog(code):
    """Panasonic, "V-Log/V-Gamut Reference Manual", 2014."""
    return np.where(code < 0.181, (code - 0.125) / 5.6, 10 ** ((code - 0.598206) / 0.241514) - 0.00873)


def log3g10(code):
    """RED, "White Paper on REDWideGamutRGB and Log3G10", 2017."""
    x = np.asarray(code, float)
    return np.where(x < 0, x / 15.1927, (10 ** (x / 0.224282) - 1) / 155.975327) - 0.01


def cineon(code):
    """Kodak 1995: black 95, white 685, 0.002 density a code, gamma 0.6."""
    black = 10 ** ((95 - 685) * 0.002 / 0.6)
    return (10 ** ((np.asarray(code, float) * 1023 - 685) * 0.002 / 0.6) - black) / (1 - black)


# The Academy's ADX_to_ACES: channel-dependent density -> channel-independent -> log exposure -> ACES.
ADX_TABLE = np.array([[-0.19, -6.0], [0.01, -2.721718645], [0.028, -2.521718645], [0.054, -2.321718645],
                      [0.095, -2.121718645], [0.145, -1.921718645], [0.22, -1.721718645], [0.3, -1.521718645],
                      [0.4, -1.321718645], [0.5, -1.121718645], [0.6, -0.926545676714876]])
CDD_TO_CID = np.array([[0.75573, 0.22197, 0.02230], [0.05901, 0.96928, -0.02829], [0.16134, 0.07406, 0.76460]])
EXPOSURE_TO_ACES = np.array([[0.72286, 0.12630, 0.15084], [0.11923, 0.76418, 0.11659], [0.01427, 0.08213, 0.90359]])


def adx(slope, offset):
    def decode(code):
        d = (np.asarray(code, float) * slope + offset) @ CDD_TO_CID.T
        above = (100 / 55) * d - ((7120 - 1520) / 8000 * (100 / 55) - np.log10(0.18))
        below = -6 + (d + 0.19) * (6 - 2.721718645) / 0.2
        log = np.where(d > 0.6, above, np.where(d < -0.19, below, np.interp(d, *ADX_TABLE.T)))
        return (10 ** np.clip(log, -10, np.log10(HALF_MAX))) @ EXPOSURE_TO_ACES.T

    return decode


# --------------------------------------------------------------------------------------------------
# Primaries: matrices to linear Rec.709

# ITU-T H.273 (07/2021), table 2. 10 is CIE XYZ without adaptation: "DCDM ...-XYZ-D65" of the Color Interop Forum.
C_WHITE = (0.310, 0.316)
H273_PRIMARIES = {
    1: PRIMARIES["rec709"], 4: ((0.67, 0.33), (0.21, 0.71), (0.14, 0.08), C_WHITE),
    5: ((0.64, 0.33), (0.29, 0.60), (0.15, 0.06), D65), 6: ((0.630, 0.340), (0.310, 0.595), (0.155, 0.070), D65),
    7: ((0.630, 0.340), (0.310, 0.595), (0.155, 0.070), D65),
    8: ((0.681, 0.319), (0.243, 0.692), (0.145, 0.049), C_WHITE), 9: PRIMARIES["rec2020"], 10: "xyz",
    11: ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), (0.314, 0.351)), 12: PRIMARIES["p3d65"],
    22: ((0.630, 0.340), (0.295, 0.605), (0.155, 0.077), D65)}
EGAMUT = ((0.8, 0.3177), (0.18, 0.9), (0.065, -0.0805), D65)
ADOBE = ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06), D65)  # Adobe RGB (1998), 4.3.1
CINEMA_GAMUT = ((0.7400, 0.2700), (0.1700, 1.1400), (0.0800, -0.1000), D65)
V_GAMUT = ((0.730, 0.280), (0.165, 0.840), (0.100, -0.030), D65)
RED_GAMUT = ((0.780308, 0.304253), (0.121595, 1.493994), (0.095612, -0.084589), D65)
DAVINCI = ENCODINGS["davinci"].primaries
REC709 = PRIMARIES["rec709"]
# Sony, for VENICE: matrices to ACES2065-1.
VENICE = np.array([[0.7933297411, 0.0890786256, 0.1175916333], [0.0155810585, 1.0327123069, -0.0482933654],
                   [-0.0188647478, 0.0127694121, 1.0060953358]])
VENICE_CINE = np.array([[0.6742570921, 0.2205717359, 0.1051711720], [-0.0093136061, 1.1059588614, -0.0966452553],
                        [-0.0382090673, -0.0179383766, 1.0561474439]])
FROM_ACES = rgb_to_rgb(PRIMARIES["ap0"], REC709)


def to_rec709(primaries):
    if isinstance(primaries, np.ndarray):  # to ACES2065-1
        return FROM_ACES @ primaries
    if isinstance(primaries, str):  # CIE XYZ
        return np.linalg.inv(rgb_to_xyz(REC709))
    if primaries == CINEMA_GAMUT:  # Canon states its matrix to ACES2065-1 with CAT02
        return FROM_ACES @ rgb_to_rgb(CINEMA_GAMUT, PRIMARIES["ap0"], CAT02)
    return rgb_to_rgb(primaries, REC709, BRADFORD)


def luminance_of(primaries):
    if primaries == PRIMARIES["rec2020"]:
        return (0.2627, 0.6780, 0.0593)  # as BT.2100-2 prints them
    return (0, 1, 0) if isinstance(primaries, str) else rgb_to_xyz(primaries)[1]


# --------------------------------------------------------------------------------------------------
# Name -> (curve, primaries)

LINEAR = {"lin_rec709": REC709, "lin_ap1": PRIMARIES["ap1"], "lin_ap0": PRIMARIES["ap0"],
          "lin_rec2020": PRIMARIES["rec2020"], "lin_p3d65": PRIMARIES["p3d65"], "lin_egamut": EGAMUT,
          "lin_awg3": CAMERAS["awg3"], "lin_awg4": CAMERAS["awg4"], "lin_sgamut3": CAMERAS["sgamut3"],
          "lin_sgamut3cine": CAMERAS["sgamut3cine"], "lin_davinci_wg": DAVINCI}


def identity(code):
    return np.asarray(code, float)


H273_CURVES = {1: power(2.4), 4: power(2.2), 5: power(2.8), 6: power(2.4), 7: smpte_240m, 8: identity,
               9: log_range(2), 10: log_range(2.5), 11: mirrored(power(2.4)), 12: bt1361, 13: srgb, 14: power(2.4),
               15: power(2.4), 16: pq, 17: power(2.6, 52.37 / 48)}

NAMES = {
    **{name: (identity, primaries) for name, primaries in LINEAR.items()},
    "srgb": (srgb, REC709), "display_p3": (srgb, PRIMARIES["p3d65"]), "rec1886": (power(2.4), REC709),
    "rec2020": (power(2.4), PRIMARIES["rec2020"]), "g22": (power(2.2), REC709),
    "rec2100_pq": (pq, PRIMARIES["rec2020"]), "p3d65_pq": (pq, PRIMARIES["p3d65"]),
    "rec2100_hlg": (hlg_display(luminance_of(PRIMARIES["rec2020"])), PRIMARIES["rec2020"]),
    "ACEScct": (lambda code: acescct_decode(np.asarray(code, float)), PRIMARIES["ap1"]), "ACEScc": (acescc, "acescc"),
    "ADX10": (adx(1023 / 500, -95 / 500), PRIMARIES["ap0"]), "ADX16": (adx(65535 / 8000, -1520 / 8000), PRIMARIES["ap0"]),
    "ARRI LogC3 (EI800)": (lambda code: logc3_decode(np.asarray(code, float)), CAMERAS["awg3"]),
    "CanonLog2 CinemaGamut D55": (canon_log2, CINEMA_GAMUT), "CanonLog3 CinemaGamut D55": (canon_log3, CINEMA_GAMUT),
    "V-Log V-Gamut": (vlog, V_GAMUT), "Log3G10 REDWideGamutRGB": (log3g10, RED_GAMUT),
    "REDLogFilm REDWideGamutRGB": (cineon, RED_GAMUT), "S-Log3 S-Gamut3": (slog3, CAMERAS["sgamut3"]),
    "S-Log3 S-Gamut3.Cine": (slog3, CAMERAS["sgamut3cine"]), "S-Log3 Venice S-Gamut3": (slog3, VENICE),
    "S-Log3 Venice S-Gamut3.Cine": (slog3, VENICE_CINE), "ARRI LogC4": (logc4, CAMERAS["awg4"]),
    "DaVinci Intermediate WideGamut": (lambda code: davinci_decode(np.asarray(code, float)), DAVINCI),
    "Cineon": (cineon, REC709), "sRGB - Texture": (srgb, REC709), "Gamma 2.2 Rec.709 - Texture": (power(2.2), REC709),
    "Gamma 2.4 Rec.709 - Texture": (power(2.4), REC709), "sRGB Encoded AP1 - Texture": (srgb, PRIMARIES["ap1"]),
    "Gamma 2.2 AP1 - Texture": (power(2.2), PRIMARIES["ap1"]),
    "sRGB Encoded P3-D65 - Texture": (srgb, PRIMARIES["p3d65"]), "Non-Color": (identity, REC709),
    "CIE-XYZ-D65": (identity, "xyz"), "unknown": (identity, REC709), "data": (identity, REC709),
    "Rec709": (bt709_camera, REC709), "Gamma1.8": (power(1.8), REC709),
    # The Color Interop Forum's lists, 2026.
    "lin_ap1_scene": (identity, PRIMARIES["ap1"]), "lin_ap0_scene": (identity, PRIMARIES["ap0"]),
    "lin_rec709_scene": (identity, REC709), "lin_p3d65_scene": (identity, PRIMARIES["p3d65"]),
    "lin_rec2020_scene": (identity, PRIMARIES["rec2020"]), "lin_adobergb_scene": (identity, ADOBE),
    "lin_ciexyzd65_scene": (identity, "xyz"), "srgb_rec709_scene": (srgb, REC709),
    "g24_rec709_scene": (power(2.4), REC709), "g22_rec709_scene": (power(2.2), REC709),
    "g18_rec709_scene": (power(1.8), REC709), "srgb_ap1_scene": (srgb, PRIMARIES["ap1"]),
    "g22_ap1_scene": (power(2.2), PRIMARIES["ap1"]), "srgb_p3d65_scene": (srgb, PRIMARIES["p3d65"]),
    "g22_adobergb_scene": (power(563 / 256), ADOBE), "srgb_rec709_display": (srgb, REC709),
    "g24_rec709_display": (power(2.4), REC709), "srgb_p3d65_display": (srgb, PRIMARIES["p3d65"]),
    "srgbe_p3d65_display": (mirrored(srgb), PRIMARIES["p3d65"]), "pq_p3d65_display": (pq, PRIMARIES["p3d65"]),
    "pq_rec2020_display": (pq, PRIMARIES["rec2020"]),
    "hlg_rec2020_display": (hlg_display(luminance_of(PRIMARIES["rec2020"])), PRIMARIES["rec2020"]),
    "g22_rec709_display": (power(2.2), REC709), "g22_adobergb_display": (power(563 / 256), ADOBE),
    "g26_p3d65_display": (power(2.6), PRIMARIES["p3d65"]), "g26_xyzd65_display": (power(2.6, 52.37 / 48), "xyz"),
    "pq_xyzd65_display": (pq, "xyz"), "lin_rec709_display": (identity, REC709),
    "lin_p3d65_display": (identity, PRIMARIES["p3d65"]), "lin_rec2020_display": (identity, PRIMARIES["rec2020"]),
    # A namespace is dropped.
    "my_studio:g22_ap1_scene": (power(2.2), PRIMARIES["ap1"]),
    # Encodings of LUTs that are no space of the config.
    "logc3": (lambda code: logc3_decode(np.asarray(code, float)), CAMERAS["awg3"]), "logc4": (logc4, CAMERAS["awg4"]),
    "slog3": (slog3, CAMERAS["sgamut3"]), "davinci": (lambda code: davinci_decode(np.asarray(code, float)), DAVINCI),
    "unity_logc": (ENCODINGS["unity_logc"].decode, REC709),
    "unreal_log": (lambda code: 0.18 * 2 ** (14 * (code - 444 / 1023)), REC709),
    # Blender 5.2, config.ocio: the allocation of AgX.
    "agx_log": (lambda code: 0.18 * 2 ** (25 * code - 10), EGAMUT),
    "reinhard": (lambda code: code / np.maximum(1 - code, 1 / HALF_MAX), REC709),
    "pq": (pq, PRIMARIES["rec2020"]), "pq:203": (lambda code: pq(code) * 100 / 203, PRIMARIES["rec2020"]),
    "hlg": (lambda code: hlg_scene(code) / 0.1 ** (1 / 1.2), PRIMARIES["rec2020"]),
    "hlg:203": (lambda code: hlg_scene(code) / 0.203 ** (1 / 1.2), PRIMARIES["rec2020"]),
    "log2": (lambda code: 0.18 * 2 ** (16.5 * code - 10), REC709),
    "log2:-8:8": (lambda code: 0.18 * 2 ** (16 * code - 8), REC709),
    "linear": (identity, REC709), "linear:0:16": (lambda code: 16 * code, REC709),
}
for p, primaries in H273_PRIMARIES.items():
    for t, curve in H273_CURVES.items():
        NAMES[f"cicp:{p}/{t}"] = (curve, primaries)
    NAMES[f"cicp:{p}/18"] = (hlg_display(luminance_of(primaries)), primaries)

# Both sides compute in double, and `eval --digits 17` loses nothing. Curves up to 10^10 have a condition of 50 for 1e-16 of
# their exponents; matrices leave 1e-16 of the color's largest channel, also before the matrix.
RELATIVE = 1e-11


def light_of(curve, primaries, codes):
    """Linear Rec.709, and the largest number on the way to it."""
    decoded = np.asarray(curve(codes), float)
    if isinstance(primaries, str) and primaries == "acescc":
        # OpenColorIO's transform limits ACES2065-1 to 0.
        decoded = np.maximum(decoded @ rgb_to_rgb(PRIMARIES["ap1"], PRIMARIES["ap0"]).T, 0)
        primaries = PRIMARIES["ap0"]
    light = decoded @ to_rec709(primaries).T
    return light, np.maximum(np.abs(decoded).max(axis=1), np.abs(light).max(axis=1))


class Report:
    def __init__(self):
        self.passed = self.failed = 0

    def check(self, what, ok, detail=""):
        self.passed += bool(ok)
        self.failed += not ok
        if not ok:
            print(f"FAIL {what}: {detail}")

    def compare(self, what, actual, expected, size, codes, tolerance):
        error = np.abs(actual - expected).max(axis=1) / np.maximum(size, 1e-3)
        i = int(np.nanargmax(error)) if not np.isnan(error).all() else 0
        ok = actual.shape == expected.shape and not np.isnan(error).any() and error.max() <= tolerance
        self.check(what, ok, f"codes {codes[i]}: {actual[i]}, expected {expected[i]}: {error.max():.2g} of {tolerance:.2g}")
        return error.max()


def evaluate(command, operator, name, codes):
    text = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in np.asarray(codes, float).tolist())
    run = subprocess.run([command, "eval", operator, "--display", "linear", "--digits", "17", "--input", name], input=text,
                         capture_output=True, text=True)
    if run.returncode:
        return run.stderr.strip()
    return np.array(run.stdout.split(), float).reshape(-1, 3)


def check_formulas(report, command, operator):
    for name, (curve, primaries) in NAMES.items():
        actual = evaluate(command, operator, name, CODES)
        if isinstance(actual, str):
            report.check(name, False, actual)
            continue
        expected, size = light_of(curve, primaries, CODES)
        kept = size <= HALF_MAX  # other light is limited to that
        report.compare(name, actual[kept], expected[kept], size[kept], CODES[kept], RELATIVE)


def check_completeness(report, command):
    """Every name of `list --inputs` is in the table above, under one of its names; patterns are."""
    names = {name.lower() for name in NAMES}
    listed = json.loads(subprocess.run([command, "list", "--inputs", "--json"], capture_output=True, text=True).stdout)
    for entry in listed:
        if entry["kind"] == "pattern":
            continue
        report.check(f"listed: {entry['id']}", entry["id"].lower() in names, "no formula here")
    report.check("list --inputs", len(listed) > 60, f"{len(listed)} names")


# What OpenColorIO's own transforms differ by, of a color's largest channel. It computes in float: 6e-8 of a code c is
# 6e-8 c f'(c)/f(c) of the light, 1e-6 for the steepest curves (PQ: 2e-6), and its matrices round once more.
OCIO_TOLERANCE = 5e-6
OCIO_TOLERANCES = {
    # A table of 4096 steps over a range of 1.86: h^2/8 (17.52 ln 2)^2 is 3.8e-6.
    "ACEScc": 1e-5,
    # ARRI and Panasonic print their constants with 6 digits, of which OpenColorIO derives some: 2e-6 of ARRI's exponent,
    # which is 2.5 ln 10 at most, and 7e-6 of V-Log's straight part.
    "ARRI LogC3 (EI800)": 2e-5, "V-Log V-Gamut": 2e-5,
}


def check_config(report, command, operator, config_path):
    try:
        import PyOpenColorIO as ocio
    except ImportError:
        print("skipped: the comparison with OpenColorIO; expected PyOpenColorIO (Debian: python3-opencolorio)")
        return
    config = ocio.Config.CreateFromFile(str(config_path))
    for space in config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL):
        name = space.getName()
        if name.startswith("Output - ") or space.getFamily().startswith("Output"):
            continue
        codes = INSIDE if space.getEncoding() != "scene-linear" else CODES
        expected = codes.astype(np.float32).copy()
        if not space.isData():  # which is never converted
            processor = config.getProcessor(name, "Linear Rec.709")
            processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_NONE).applyRGB(expected)
        for spelling in [name, *space.getAliases()]:
            actual = evaluate(command, operator, spelling, codes.astype(np.float32))
            if isinstance(actual, str):
                report.check(f"config: {spelling}", False, actual)
                continue
            size = np.maximum(np.abs(actual).max(axis=1), np.abs(expected).max(axis=1))
            report.compare(f"config: {spelling}", actual, expected.astype(float), size, codes,
                           OCIO_TOLERANCES.get(name, OCIO_TOLERANCE))


def check_refusals(report, command, operator):
    for name, words in [("lin_rec708", "did you mean lin_rec709"), ("cicp:2/2", "input space is cicp:2/2, unspecified / unspecified; expected"),
                        ("cicp:3/1", "cicp:3/1"), ("cicp:9/19", "cicp:9/19"), ("pq:0", "expected pq:WHITE"),
                        ("hlg:2000", "expected hlg:WHITE"), ("LogC5", "is LogC5; expected"),
                        ("no:such:name", "is no:such:name; expected")]:
        run = subprocess.run([command, "eval", operator, "--input", name], input="0 0 0\n", capture_output=True, text=True)
        report.check(f"refused: {name}", run.returncode == 2 and words in run.stderr and run.stderr.count("\n") == 1,
                     f"exit code {run.returncode}, {run.stderr}")


def main():
    command = sys.argv[1]
    config = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).resolve().parents[1] / "ocio_config" / "config.ocio"
    report = Report()
    with tempfile.TemporaryDirectory() as folder:
        operator = Path(folder) / "unchanged.tone"
        operator.write_text(IDENTITY)
        check_formulas(report, command, str(operator))
        check_completeness(report, command)
        check_config(report, command, str(operator), config)
        check_refusals(report, command, str(operator))
    print(f"{report.passed} passed, {report.failed} failed")
    return 1 if report.failed else 0


if __name__ == "__main__":
    sys.exit(main())
