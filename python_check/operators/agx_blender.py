# SPDX-License-Identifier: Apache-2.0
"""AgX as Blender has it: E. Chow's formation as a formula, and as the cubes that Blender shows it through.

A cube is sampled from the formula with the constants of its generator, and interpolated; the two differ visibly where
the guard rails have their kinks. SDR views limit colors to the gamut of a display, the HDR view to P3 at 1000 cd/m2.
"""

import functools

import numpy as np

from .agx import INSET_2020, OUTSET_2020, agx_sigmoid
from .base import REC709_WEIGHTS, REC2020_WEIGHTS, luminance
from .spaces import HLG_A, HLG_B, HLG_C, HLG_FLOOR, HLG_GAMMA, hlg_oetf, rgb_to_rgb, rgb_to_xyz

GRAY = 0.18
# Luminance weights of the rails: those of the SDR cubes, and those of the script of 2025, which made the HDR cube.
RAIL_SDR = np.array([0.2658180370250449, 0.59846986045365, 0.1357121025213052])
RAIL_2025 = np.array([0.2589235355689848, 0.6104985346066525, 0.13057792982436284])

# FilmLight, "T-CAM ... / E-Gamut" white paper: E-Gamut to XYZ under D65.
E_GAMUT_TO_XYZ = np.array([[0.7053968501, 0.1640413283, 0.08101774865], [0.2801307241, 0.8202066415, -0.1003373656],
                           [-0.1037815116, -0.07290725703, 1.265746519]])
# The generator's own conversions: their white is (0.31271, 0.32902), so cubes tint grays by up to 3.5e-5.
XYZ_TO = {
    "rec2020": np.array([[1.7166634277958805, -0.3556733197301399, -0.2533680878902478],
                         [-0.6666738361988869, 1.6164557398246981, 0.0157682970961337],
                         [0.0176424817849772, -0.0427769763827532, 0.9422432810184308]]),
    "rec709": np.array([[3.2410032329763588, -1.5373989694887856, -0.4986158819963629],
                        [-0.9692242522025164, 1.8759299836951759, 0.0415542263400847],
                        [0.0556394198519755, -0.2040112061239099, 1.0571489771875333]]),
    "p3d65": np.array([[2.4935091239346101, -0.9313881794047790, -0.4027127567416516],
                       [-0.8294732139295544, 1.7626305796003032, 0.0236242371055886],
                       [0.0358512644339181, -0.0761839369220759, 0.9570295866943110]]),
}
REC2020_TO_XYZ = np.array([[0.6369535067850740, 0.1446191846692331, 0.1688558539228734],
                           [0.2626983389565560, 0.6780087657728165, 0.0592928952706273],
                           [0, 0.0280731358475570, 1.0608272349505707]])
TINY = 2.0**-126  # OCIO's floor before a logarithm
LG2 = (-12.47393, 12.5260688117)


def lg2_encode(x):
    """log2 over 25 stops, 10 of them below mid gray: 0.18 -> 0.4. Not limited, but for the floor before the logarithm.

    >>> lg2_encode(np.array([0.18, 0])).round(6).tolist()
    [0.4, -4.541043]
    """
    return (np.log2(np.maximum(x, TINY)) - LG2[0]) / (LG2[1] - LG2[0])


def lg2_decode(v):
    """Inverse of lg2_encode.

    >>> lg2_decode(np.array([0.4])).round(6).tolist()
    [0.18]
    """
    return 2 ** (v * (LG2[1] - LG2[0]) + LG2[0])


def highest(v):
    return v.max(-1, keepdims=True)


def rail(c, to_rec2020, weights, fades):
    """Low-side guard rail: what is below 0 is lifted to 0, and the luminance that this adds is scaled away.

    Luminances are compensated by the brightness that a color's complement has above its own; for `fades`, the less
    the brighter the color.

    >>> rail(np.array([-0.1, 0.2, 0.5]), np.eye(3), RAIL_SDR, False).round(6).tolist()
    [0.0, 0.242522, 0.485043]
    """
    def light(v):
        return luminance(v @ to_rec2020.T, weights)

    def compensated(v):
        y = light(v)
        complement = highest(v) - v
        a = highest(complement) - light(complement) + y
        return a + (y - a) * np.clip(np.maximum(y, 0) ** 0.08, 0, 1) if fades else a

    lifted = c + np.maximum(-c.min(-1, keepdims=True), 0)
    old, new = compensated(c), compensated(lifted)
    return lifted * np.where(new > old, old / np.maximum(new, 1e-100), 1)


def rgb_to_hsv(rgb):
    """Hue in [0, 1), saturation, value.

    >>> rgb_to_hsv(np.array([0.5, 0.25, 0.375])).round(6).tolist()
    [0.916667, 0.5, 0.5]
    """
    v, low = rgb.max(-1), rgb.min(-1)
    spread = v - low
    r, g, b = np.moveaxis(rgb, -1, 0)
    safe = np.where(spread > 0, spread, 1)
    hue = np.select([r == v, g == v], [(g - b) / safe, 2 + (b - r) / safe], 4 + (r - g) / safe) / 6
    return np.stack([np.where(spread > 0, hue % 1, 0), np.where(v > 0, spread / np.where(v > 0, v, 1), 0), v], axis=-1)


def hsv_to_rgb(hsv):
    """Inverse of rgb_to_hsv.

    >>> hsv_to_rgb(np.array([11 / 12, 0.5, 0.5])).round(6).tolist()
    [0.5, 0.25, 0.375]
    """
    h, s, v = (hsv[..., i:i + 1] for i in range(3))
    distance = np.abs((h * 6 - np.array([0, 2, 4]) + 3) % 6 - 3)  # from the channel's own hue, in sixths
    return v - v * s * (1 - np.clip(2 - distance, 0, 1))


def turn(hue, towards, share):
    """A share of the shorter way from one hue to another.

    >>> float(np.round(turn(0.9, 0.1, 0.5), 6)) % 1
    0.0
    """
    return (hue + share * ((towards - hue + 0.5) % 1 - 0.5)) % 1


def agx_light(x, shoulder=1.5, ends=False):
    """Log of -10..+6.5 stops, sigmoid through mid gray, decoded with 2.4: mid gray stays.

    >>> agx_light(np.array([0.0, 0.18, 1.0])).round(9).tolist()
    [0.0, 0.18, 0.555999065]
    """
    n = np.maximum(np.log2(np.maximum(x, GRAY * 2.0**-11) / GRAY) + 10, 0) / 16.5
    n = np.minimum(n, 1) if ends else n
    return np.where(n > 0, agx_sigmoid(n, (10 / 16.5, GRAY ** (1 / 2.4)), 2.4, (1.5, shoulder)) ** 2.4, 0)


def hdr_light(x, peak):
    """The HDR view's second curve: mid gray stays, 1 goes down to 1/peak of the display's light.

    >>> hdr_light(np.array([0.0, 0.18, 1.0]), 10).round(9).tolist()
    [0.0, 0.018, 1.0]
    """
    height = 20 + np.log2(1 / GRAY)
    px, py, k = 20 / height, (20 - np.log2(peak)) / height, 1.000001
    e = (np.log2(np.where(x > 0, x, 1) / GRAY) + 20) / height
    toe = -(((k * px) ** -3 * ((k * px / py) ** 3 - 1)) ** (-1 / 3))
    u = k * (np.minimum(e, px) - px) / toe
    shoulder = k * (1 - px) / (k * (1 - px) / (1 - py) - 1)
    w = k * (np.maximum(e, px) - px) / shoulder
    out = np.where(e < px, toe * u / (1 + u**3) ** (1 / 3) + py, shoulder * w / (1 + w) + py)
    return np.where(x > 0, GRAY * 2 ** (height * out - 20), 0)


def formation(c, weights, to_display, display_to_rec2020, peak=0):
    """Linear Rec.2020 -> display light of the gamut that `to_display` leads to; not below 0, may be above 1.

    With a peak, in units of the reference white, the HDR view: 1 is the peak.
    """
    scene = rail(c, np.eye(3), weights, False) @ INSET_2020.T
    scene = np.maximum(scene, 0)  # a rail of a color without light may leave it below: black
    hsv0 = rgb_to_hsv(scene)
    light = agx_light(scene, 1.5 * peak ** np.log10(2), True) if peak else agx_light(scene)
    hsv = rgb_to_hsv(light)
    if peak:
        hsv2 = rgb_to_hsv(hdr_light(light, peak))
        hsv = np.stack([turn(hsv[..., 0], hsv2[..., 0], 0.5), (hsv[..., 1] + hsv2[..., 1]) / 2, hsv2[..., 2]], axis=-1)
    hsv[..., 0] = turn(hsv0[..., 0], hsv[..., 0], 0.4)
    out = hsv_to_rgb(hsv) @ OUTSET_2020.T
    if to_display is not None:
        out = rail(out @ to_display.T, display_to_rec2020, weights, True)
    return np.maximum(out, 0)


HDR_PEAK = 10.0  # 1000 cd/m2 over 100 cd/m2


def sdr_formula(c, limit):
    """The chain, exact conversions: Rec.2020 -> display-linear, in the primaries of the limit."""
    matrices = (None, None) if limit == "rec2020" else (rgb_to_rgb("rec2020", limit), rgb_to_rgb(limit, "rec2020"))
    return np.minimum(formation(c, RAIL_SDR, *matrices), 1)


def hdr_formula(c):
    """The HDR chain: Rec.2020 -> Rec.2020 light, P3 colors only, 1 = 100 cd/m2."""
    to_p3, back = rgb_to_rgb("rec2020", "p3d65"), rgb_to_rgb("p3d65", "rec2020")
    return HDR_PEAK * np.clip(formation(c, RAIL_2025, to_p3, back, HDR_PEAK) @ back.T, 0, 1)


def hlg_encode(light):
    """Rec.2020 light of [0, 1] -> HLG code.

    >>> hlg_encode(np.full(3, 0.018)).round(7).tolist()
    [0.3247812, 0.3247812, 0.3247812]
    """
    y = luminance(light, REC2020_WEIGHTS)
    return hlg_oetf(light * np.where(y > 0, y, 1) ** (1 / HLG_GAMMA - 1))


def hlg_decode(code):
    """HLG code -> Rec.2020 light, 1 = 100 cd/m2: the inverse of OCIO's display "Rec.2100-HLG - 1000 nit".

    >>> hlg_decode(hlg_encode(np.array([0.018, 0.5, 0.01]))).round(9).tolist()
    [0.18, 5.0, 0.1]
    """
    e = np.where(code <= 0.5, code**2 / 3, (np.exp((code - HLG_C) / HLG_A) + HLG_B) / 12)
    y = np.maximum(luminance(e, REC2020_WEIGHTS), HLG_FLOOR ** (1 / HLG_GAMMA))
    return HDR_PEAK * e * y ** (HLG_GAMMA - 1)


def tetrahedral(nodes, q):
    """Nodes (n, n, n, 3) at coordinates q (..., 3) of [0, 1]: along the tetrahedron of the cell, largest step first.

    >>> n = np.moveaxis(np.indices((3, 3, 3)), 0, -1) / 2.0
    >>> tetrahedral(n, np.array([0.3, 0.9, 0.6])).round(12).tolist()
    [0.3, 0.9, 0.6]
    """
    edge = nodes.shape[0]
    position = np.clip(q, 0, 1).reshape(-1, 3) * (edge - 1)
    cell = np.minimum(position.astype(int), edge - 2)
    weight = position - cell
    order = np.argsort(-weight, axis=-1, kind="stable")
    corner = cell.copy()
    out = nodes[tuple(corner.T)].copy()
    rows = np.arange(len(corner))
    for step in range(3):
        axis = order[:, step]
        before = nodes[tuple(corner.T)]
        corner[rows, axis] += 1
        out += weight[rows, axis, None] * (nodes[tuple(corner.T)] - before)
    return out.reshape(np.shape(q))


def lattice_scene(edge):
    """Linear Rec.2020 of the nodes, by the generator's conversion."""
    q = np.arange(edge) / (edge - 1)
    e = GRAY * 2 ** (25 * q - 10)
    nodes = np.stack(np.meshgrid(e, e, e, indexing="ij"), axis=-1)
    return nodes @ E_GAMUT_TO_XYZ.T @ XYZ_TO["rec2020"].T


@functools.lru_cache
def rail_lattice():
    """37^3 nodes: the first rail alone, log code of E-Gamut, floored at 0; the seven decimals of the shipped file."""
    c = rail(lattice_scene(37), np.eye(3), RAIL_SDR, False)
    e_gamut = c @ REC2020_TO_XYZ.T @ np.linalg.inv(E_GAMUT_TO_XYZ).T
    return np.round(np.maximum(np.log2(np.maximum(e_gamut, TINY) / GRAY) + 10, 0) / 25, 7)


@functools.lru_cache
def sdr_lattice(limit):
    """57^3 nodes: codes of a 2.4 power."""
    c = lattice_scene(57)
    matrices = (None, None)
    if limit != "rec2020":
        matrices = XYZ_TO[limit] @ REC2020_TO_XYZ, rgb_to_rgb(limit, "rec2020")
    return np.minimum(formation(c, RAIL_SDR, *matrices) ** (1 / 2.4), 1)


@functools.lru_cache
def hdr_lattice():
    """57^3 nodes: HLG codes of 1000 cd/m2, limited to 1 as in the file."""
    to_p3 = XYZ_TO["p3d65"] @ REC2020_TO_XYZ
    light = formation(lattice_scene(57), RAIL_2025, to_p3, rgb_to_rgb("p3d65", "rec2020"), HDR_PEAK)
    return np.minimum(hlg_encode(np.clip(light @ np.linalg.inv(to_p3).T, 0, 1)), 1)


CONTRASTS = {  # contrast about 0.4 of the log code, saturation
    "very_high_contrast": (1.57, 0.9), "high_contrast": (1.4, 0.95), "medium_high_contrast": (1.2, 1),
    "base_contrast": (1, 1), "medium_low_contrast": (0.9, 1.05), "low_contrast": (0.8, 1.1),
    "very_low_contrast": (0.7, 1.15),
}


def shadow_tone(t, value, start=0.4, pivot=0.1):
    """OCIO's GradingTone shadows below 1: slope `value` up to the pivot, two parabolas from there to `start`.

    >>> shadow_tone(np.array([0.0, 0.1, 0.25, 0.4]), 0.2).round(9).tolist()
    [0.08, 0.1, 0.22, 0.4]
    """
    x0, x2 = pivot, start
    x1 = x0 + (x2 - x0) / 2
    y0, y2, m0, m2 = x0, x2, max(0.01, value), 1
    y1 = 0.5 / (x2 - x0) * ((2 * y0 + m0 * (x1 - x0)) * (x2 - x1) + (2 * y2 - m2 * (x2 - x1)) * (x1 - x0))
    a, b = (t - x0) / (x1 - x0), (t - x1) / (x2 - x1)
    return np.select(
        [t < x0, t < x1, t < x2],
        [y0 + m0 * (t - x0), y0 * (1 - a**2) + y1 * a**2 + m0 * (1 - a) * a * (x1 - x0),
         y1 * (1 - b) ** 2 + y2 * (2 - b) * b + m2 * (b - 1) * b * (x2 - x1)], t)


def apply_look(v, look):
    """A look on lg2 codes of the inset's channels."""
    if look == "punchy":
        v = shadow_tone(shadow_tone(v, 0.2), 0.35)
        return np.where(v > 0, np.maximum(v, 0) ** 1.0912, v)
    if look == "greyscale":
        return np.repeat(lg2_encode(luminance(lg2_decode(v), RAIL_2025)), 3, axis=-1)
    contrast, saturation = CONTRASTS[look]
    v = (v - 0.4) * contrast + 0.4
    luma = luminance(v, REC709_WEIGHTS)
    return luma + saturation * (v - luma)


def agx_blender(rgb, limit="rec709", method="lattice", range="sdr", look=""):
    """Guard rail, inset, log sigmoid with 60 % of the scene's HSV hue, outset, guard rail of the display's gamut.

    Rec.2020 in. Out: display-linear in the limit's primaries, within [0, 1]; ``range="hdr"``: Rec.2020 light within
    P3, 1 = 100 cd/m2, up to 10.

    References
    ----------
    E. Chow, AgX and AgX_LUT_Gen (github.com/EaryChow); Blender 5, datafiles/colormanagement/config.ocio.

    >>> agx_blender([1.0, 1, 1], method="formula").round(9).tolist()
    [0.555999065, 0.555999065, 0.555999065]
    """
    c = np.asarray(rgb, float)
    to_e_gamut = np.linalg.solve(E_GAMUT_TO_XYZ, rgb_to_xyz("rec2020"))
    if look:
        if method == "lattice":
            code = tetrahedral(rail_lattice(), lg2_encode(c @ to_e_gamut.T))
            c = lg2_decode(code) @ np.linalg.inv(to_e_gamut).T
        else:
            c = rail(c, np.eye(3), RAIL_SDR, False)
        c = lg2_decode(apply_look(lg2_encode(c @ INSET_2020.T), look)) @ np.linalg.inv(INSET_2020).T
    if method == "formula":
        return hdr_formula(c) if range == "hdr" else sdr_formula(c, limit)
    q = lg2_encode(c @ to_e_gamut.T)
    if range == "hdr":
        return hlg_decode(tetrahedral(hdr_lattice(), q))
    return tetrahedral(sdr_lattice(limit), q) ** 2.4


OPERATORS = {"agx_blender": agx_blender}
WORKING = {"agx_blender": "rec2020"}
OUTPUT_PRIMARIES = {"agx_blender": lambda limit="rec709", range="sdr", **_: "rec2020" if range == "hdr" else limit}
PEAK = {"agx_blender": lambda range="sdr", **_: HDR_PEAK if range == "hdr" else 1.0}
FROM_DISPLAY = {"agx_blender": {"limit": lambda display: display.primaries,
                                "range": lambda display: "hdr" if display.is_hdr else "sdr"}}
