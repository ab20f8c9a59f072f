# SPDX-License-Identifier: Apache-2.0
"""Tests the package operators: its doctests, every published row of tests/data/operators.csv, and inner parts.

    [TONEWRIGHT_SHARED=<folder>] python3 -m pytest tests/python_check/test_operators.py

With the folder, reference/check_values.json in it is compared too.
"""

import colorsys
import doctest
import importlib
import json
import pkgutil
import re
import warnings
from unittest import mock

import check_operators
import check_values
import make_operator_rows
import numpy as np
import operators
from operators import aces, aces_13, aces_20, hable, reinhard, spaces
from pictures import PROJECT

FLOOR = 1e-3  # errors are relative to max(|expected|, FLOOR), as in operators.csv


def relative_error(actual, expected):
    actual, expected = np.asarray(actual, float), np.asarray(expected, float)
    return np.max(np.abs(actual - expected) / np.maximum(np.abs(expected), FLOOR))


def test_doctests(report):
    families = [importlib.import_module(f"operators.{m.name}") for m in pkgutil.iter_modules(operators.__path__)]
    for module in (operators, *families, check_values, make_operator_rows):
        result = doctest.testmod(module)
        report.bound(f"{module.__name__}: {result.attempted} examples, failures", result.failed, 0.5)


def test_rows(report):
    """Each group of rows with one operator, settings, look, output and origin."""
    groups = {}
    for row in make_operator_rows.read_rows():
        if row["operator"] in operators.OPERATORS:
            key = [row.get(c, "") for c in ("operator", "settings", "look", "output", "input", "origin", "tolerance")]
            groups.setdefault(tuple(key), []).append(row)
    for (operator, settings, look, output, space, origin, tolerance), rows in groups.items():
        rgb = [[float(row[c]) for c in ("in_r", "in_g", "in_b")] for row in rows]
        expected = [[float(row[c]) for c in ("out_r", "out_g", "out_b")] for row in rows]
        actual = operators.view(operator, rgb, make_operator_rows.parse_settings(settings), look,
                                input=space or "lin_rec709", display=output)
        shown = settings if len(settings) < 40 else settings[:36] + "..."
        name = " ".join(filter(None, (operator, shown, look, output, f"({len(rows)})", origin.split(":")[0])))
        report.bound(name, relative_error(actual, expected), float(tolerance), f"is {actual.tolist()}, expected {expected}")


def test_parts(report):
    """Statements of the sources about their own constants."""
    to_ap1 = operators.rgb_to_rgb("rec709", "ap1")

    def saturation(s):  # ACES: lerp from AP1 luminance
        return s * np.eye(3) + (1 - s) * operators.rgb_to_xyz("ap1")[1]

    # Hill prints five decimals; ours from the chromaticities, with RRT_SAT 0.96 and ODT_SAT 0.93.
    report.bound("Hill's input matrix", np.abs(saturation(0.96) @ to_ap1 - operators.HILL_IN).max(), 6e-6)
    report.bound("Hill's output matrix", np.abs(np.linalg.solve(to_ap1, saturation(0.93)) - operators.HILL_OUT).max(), 6e-6)
    # Wrensch and three.js print the inverse inset instead of inverting.
    printed = [[1.19687900512017, -0.0980208811401368, -0.0990297440797205],
               [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
               [-0.0529716355144438, -0.0980434501171241, 1.15107367264116]]
    report.bound("inverse AgX inset as printed", np.abs(np.linalg.inv(operators.AGX_INSET) - printed).max(), 1e-14)
    # ITU-R BT.2087-0 prints four decimals of Rec.709 -> Rec.2020.
    bt2087 = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
    report.bound("Rec.709 -> Rec.2020 as BT.2087 prints it",
                 np.abs(operators.rgb_to_rgb("rec709", "rec2020") - bt2087).max(), 5.1e-5)


def test_extremes(report):
    """Every run of check_operators.py without a warning of NumPy, an infinity or a NaN; the refused are refused."""
    rgb = check_operators.samples()
    views = [{k: v for k, v in view.items() if k != "preset"} for view in check_operators.runs()]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bad = [view for view in views if not np.isfinite(operators.view(rgb=rgb, **view)).all()]
    report.bound(f"views not finite ({len(views)})", len(bad), 0.5, bad[:1])
    accepted = []
    for operator, settings in check_operators.REFUSED:
        try:
            operators.view(operator, rgb, settings)
            accepted.append((operator, settings))
        except ValueError:
            pass
    report.bound(f"refused settings accepted ({len(check_operators.REFUSED)})", len(accepted), 0.5, accepted[:1])


def lights(operator, rgb, settings):
    """An operator's output as light."""
    out = operators.OPERATORS[operator](rgb, **settings)
    return np.maximum(out, 0) ** operators.CODE_POWER[operator] if operator in operators.CODE_POWER else out


def hue(rgb):
    return np.array([colorsys.rgb_to_hsv(*color)[0] for color in rgb])


def test_apply(report):
    """Properties of each method to apply a curve, for every operator that has it, and for curves of known contrast."""
    rng = np.random.default_rng(7)
    rgb = 0.18 * 2.0 ** rng.uniform(-6, 6, (200, 3))
    scaled, hues = {}, {}
    for operator in check_operators.CURVES:
        for apply in ("luminance", "max"):
            light = lights(operator, rgb, {"apply": apply})
            inside = (np.abs(light) < 1).all(-1)  # some of the sources limit to 1
            cross = light * np.roll(rgb, 1, -1) - rgb * np.roll(light, 1, -1)
            scaled[operator, apply] = np.abs(cross[inside] / rgb[inside].max(-1, keepdims=True) ** 2).max(initial=0)
        out = operators.OPERATORS[operator](rgb, apply="hue_preserving")
        inside = ((out > 0) & (out < 1)).all(-1)
        turn = np.abs(hue(out[inside]) - hue(rgb[inside]))
        hues[operator] = np.minimum(turn, 1 - turn).max(initial=0)
    worst = max(scaled, key=scaled.get)
    report.bound(f"apply=luminance, max: ratios of the channels kept ({len(scaled)})", scaled[worst], 1e-12, worst)
    worst = max(hues, key=hues.get)
    report.bound(f"apply=hue_preserving: HSV hue kept ({len(hues)})", hues[worst], 1e-12, worst)

    def curve(x):
        return operators.apply_curve(lambda v: v / (1 + v), rgb, **x)

    luminance = {"apply": "luminance"}
    wanted = operators.luminance(rgb) / (1 + operators.luminance(rgb))
    report.bound("apply=luminance: luminance is the curve's", relative_error(operators.luminance(curve(luminance)), wanted),
                 1e-12)
    largest = rgb.max(-1, keepdims=True)
    report.bound("apply=max: the largest channel is the curve's",
                 relative_error(curve({"apply": "max"}).max(-1, keepdims=True), largest / (1 + largest)), 1e-12)
    channels = np.abs(hue(curve({})) - hue(rgb))
    report.bound("apply=channels: HSV hue turned by more than 1e-3", 1e-3 / np.minimum(channels, 1 - channels).max(), 1)
    for correction in ("nonlinear", "luminance_preserving"):
        how = {**luminance, "color_correction": correction}
        report.bound(f"{correction}, saturation 1: as ratio", relative_error(curve(how), curve(luminance)), 1e-12)
        gray = np.broadcast_to(wanted, rgb.shape)
        report.bound(f"{correction}, saturation 0: gray", relative_error(curve({**how, "saturation": 0}), gray), 1e-12)
    for saturation in (0.4, 1.7):
        for source in ("fixed", "contrast"):
            out = curve({**luminance, "color_correction": "luminance_preserving", "saturation": saturation,
                         "saturation_from": source})
            report.bound(f"luminance_preserving, saturation {saturation}, {source}: luminance kept",
                         relative_error(operators.luminance(out), wanted), 1e-12)

    # A power has the same contrast everywhere, the identity 1, where the formula leaves the saturation alone.
    for exponent in (0.3, 1, 1.8):
        for correction in ("nonlinear", "luminance_preserving"):
            k1, k2 = operators.MANTIUK[correction]
            saturation = 0.9 * (1 + k1) * exponent**k2 / (1 + k1 * exponent**k2)
            how = {**luminance, "color_correction": correction}
            by_contrast = operators.apply_curve(lambda x, e=exponent: x**e, rgb, **how, saturation=0.9,
                                                saturation_from="contrast")
            fixed = operators.apply_curve(lambda x, e=exponent: x**e, rgb, **how, saturation=saturation)
            report.bound(f"{correction}: saturation from the contrast {exponent}", relative_error(by_contrast, fixed), 1e-12)
    x = 2.0 ** rng.uniform(-20, 15, 1000)
    contrasts = {"x/(1+x)": (lambda v: v / (1 + v), 1 / (1 + x)),
                 "1-exp(-x)": (lambda v: -np.expm1(-v), x * np.exp(-x) / -np.expm1(-x)),
                 "ln(1+x)": (operators.log1p, x / (1 + x) / np.log1p(x))}
    for name, (f, wanted) in contrasts.items():
        report.bound(f"contrast of {name}", relative_error(operators.curve_contrast(f, x), wanted), 1e-12)

    # Code values: the norm forms scale light, f^p.
    for apply in ("luminance", "max"):
        code = operators.apply_curve(np.tanh, rgb, apply, code_power=2.2)
        light = operators.apply_curve(lambda x: np.tanh(x) ** 2.2, rgb, apply)
        report.bound(f"code values, apply={apply}: light scaled", relative_error(code**2.2, light), 1e-12)
        below = operators.apply_curve(lambda x: x - 0.1, np.full((1, 3), 0.05), apply)
        report.bound(f"apply={apply}: a curve below 0 gives black", np.abs(below).max(), 1e-300)


def sobotka_table(n):
    """The sigmoid as AgX_Default_Contrast.spi1d stores it: 4096 entries, seven decimals, linear between them."""
    nodes = np.arange(4096) / 4095
    return np.interp(n, nodes, operators.agx_sigmoid(nodes).round(7))


def test_sobotka_table(report):
    """With the table his figures come out to 12 digits: so the wider tolerance of those rows is due to it alone."""
    errors = []
    for row in make_operator_rows.read_rows():
        if row["origin"].startswith("agx_sobotka_"):
            rgb = operators.limit_scene([float(row[c]) for c in ("in_r", "in_g", "in_b")])
            code = sobotka_table(operators.agx_shape(rgb @ operators.AGX_INSET.T))
            if row["look"]:
                code = operators.cdl(code, **operators.AGX_LOOKS[row["look"]])
            errors.append(relative_error(code, [float(row[c]) for c in ("out_r", "out_g", "out_b")]))
    report.bound(f"agx_sobotka through a table like the LUT ({len(errors)})", max(errors), 1e-9)


def test_filament_bound(report):
    """The bound that aces_filament declares: OpenColorIO's fixed functions have the CTL's hue weight in place of Filament's.

    The largest difference on an sRGB display, of any light: a search from the worst of random colors on.
    """
    def ctl_red_modifier(ap0, _):
        weight = aces_13.hue_weight(ap0) * aces_13.saturation_of(ap0)
        return ap0 + (weight * (0.03 - ap0[..., 0]) * (1 - 0.82))[..., None] * [1, 0, 0]

    def shown(light):
        return spaces.srgb_encode(np.clip(aces.aces_filament(light) @ spaces.rgb_to_rgb("rec2020", "rec709").T, 0, 1))

    def difference(light):
        with mock.patch.object(aces, "red_modifier", ctl_red_modifier):
            other = shown(light)
        return np.abs(shown(light) - other).max(axis=-1)

    random = np.random.default_rng(1)
    light = 2.0 ** random.uniform(-14, 8, (100000, 3)) * (random.random((100000, 3)) > 0.08)
    light = light[np.argsort(difference(light))[-200:]]
    largest = difference(light)
    for step in np.geomspace(0.3, 1e-4, 200):
        moved = light * 2.0 ** random.normal(0, step, light.shape)
        light = np.where((difference(moved) > largest)[:, None], moved, light)
        largest = difference(light)
    source = (PROJECT / "src" / "operators" / "aces_fits.cpp").read_text()
    bound = float(re.search(r"op\.id = \"aces_filament\";.*?\.lut3d = ([0-9.e-]+)", source, re.DOTALL)[1])
    report.bound("aces_filament: what another hue weight makes of any color", largest.max(), bound)
    report.bound("aces_filament: the declared bound is not above it by more than a hundredth", bound / largest.max() - 1, 0.01)


def test_shared(report, shared):
    """Figures of check_values.json: the committed rows are theirs, and the parts that have no row."""
    published = list(make_operator_rows.published_rows(shared))
    committed = [row for row in make_operator_rows.read_rows()
                 if row["operator"] in operators.OPERATORS and not row["origin"].startswith(("python_check/operators", "executed: "))]
    # Their last digits follow the processor: NumPy's pow is another one where there is AVX-512.
    figures = ("out_r", "out_g", "out_b")

    def identity(row):
        return tuple(value for column, value in row.items() if column not in figures)

    def off(row, others):
        """Largest relative difference of a row to the one of the same color, settings and origin, of its tolerance."""
        wanted = np.array([float(row[c]) for c in figures])
        return min((relative_error([float(other[c]) for c in figures], wanted) / float(row["tolerance"])
                    for other in others.get(identity(row), ())), default=np.inf)

    def by_identity(rows):
        found = {}
        for row in rows:
            found.setdefault(identity(row), []).append(row)
        return found

    there, here = by_identity(published), by_identity(committed)
    missing = [row for row in published if off(row, here) > 1]
    report.bound("rows of check_values.json that operators.csv lacks", len(missing), 0.5, missing[:1])
    stray = [row for row in committed if off(row, there) > 1]
    report.bound("rows of operators.csv that check_values.json lacks", len(stray), 0.5, stray[:1])

    values = json.loads((shared / "reference" / "check_values.json").read_text())
    sigmoid = {"pivot": (10 / 16.5, 0.18 ** (1 / 2.4)), "slope": 2.4, "powers": (1.5, 1.5)}
    lindbloom = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                          [0.0193339, 0.1191920, 0.9503041]])
    printed = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                        [0.0556434, -0.2040259, 1.0572252]])

    def by_xyy(rgb, white, gain):  # the route of BruOp's article, with its 7-digit matrices and their printed inverse
        xyz = rgb @ lindbloom.T
        y = xyz[1] * gain
        return xyz * np.divide(reinhard.extended(y, white), xyz[1], where=xyz[1] > 0, out=np.zeros(1)) @ printed.T

    def aces_20_inverse(rgb, *settings):
        return aces_20.aces_20_inverse(rgb, *settings) @ operators.rgb_to_rgb("ap1", "ap0").T

    parts = {
        "hable_uncharted2_partial": (1e-9, hable.hable_curve),
        "reinhard_extended_xyY_lindbloom": (1e-9, lambda x: by_xyy(x, 3.0, 1 / (9.6 * 0.1 + 0.0001))),
        "aces_hill_unclamped": (1e-9, lambda x: operators.hill_curve(x @ operators.HILL_IN.T) @ operators.HILL_OUT.T),
        "agx_sobotka_curve": (1e-9, sobotka_table),
        "aces13_reference_gamut_compression": (1e-9, aces_13.compress_gamut),
        "aces2_inverse_100nit-REC709": (1e-9, aces_20_inverse),
        "aces2_inverse_1000nit-REC2020": (1e-9, lambda x: aces_20_inverse(x, 1000, "rec2020")),
        "aces2_inverse_1000nit-P3-D65": (1e-9, lambda x: aces_20_inverse(x, 1000, "p3d65")),
        "agx_sigmoid_SB2383": (1e-9, lambda n: operators.agx_sigmoid(n, **sigmoid)),
    }
    for name, (tolerance, f) in parts.items():
        errors = [relative_error(f(np.array(v["input"])), v["output"]) for v in values if v["operator"] == name]
        report.bound(f"{name} ({len(errors)})", max(errors), tolerance)
