# SPDX-License-Identifier: Apache-2.0
"""Ten tone mapping operators and the display side, in NumPy, derived from their publications.

The second opinion on the C++ operators: written from the papers, posts and standards cited below, never
from the C++, in float64 and without any shared code. Names of operators and parameters are those of
`tonewright list`.

An operator takes scene-linear Rec.709, ``rgb : (..., 3) array, 1.0 = diffuse white``, limits it to
[0, 65504] first, and returns its own ("native") output: display-linear Rec.709, or code values where
`CODE_POWER` names it. `view` adds input space, exposure and display.
"""

import numpy as np

HALF_MAX = 65504.0  # largest finite IEEE 754 half float
REC709_WEIGHTS = np.array([0.2126, 0.7152, 0.0722])  # ITU-R BT.709-6, item 3.2


def limit_scene(rgb):
    """Scene-linear limited to [0, 65504] per channel, the first step of every operator here.

    >>> limit_scene([-0.1, 0.18, 1e9]).tolist()
    [0.0, 0.18, 65504.0]
    """
    return np.clip(np.asarray(rgb, float), 0, HALF_MAX)


def luminance(rgb):
    """Weighted sum of (..., 3), as (..., 1).

    >>> luminance(np.array([1.0, 0.0, 0.0])).tolist()
    [0.2126]
    """
    return (rgb * REC709_WEIGHTS).sum(-1, keepdims=True)


def apply_curve(f, rgb, apply):
    """Apply a curve to each channel, or scale the colour by f(n)/n; black where n is 0.

    Parameters
    ----------
    f : callable, (...) array -> (...) array
    rgb : (..., 3) array, >= 0
    apply : {'channels', 'luminance', 'max'}, what n is

    >>> apply_curve(np.sqrt, np.array([4.0, 2.0, 1.0]), "max").tolist()
    [2.0, 1.0, 0.5]
    """
    if apply == "channels":
        return f(rgb)
    norm = {"luminance": luminance, "max": lambda c: c.max(-1, keepdims=True)}[apply](rgb)
    safe = np.where(norm > 0, norm, 1)
    return np.where(norm > 0, rgb * (f(safe) / safe), 0)


# --------------------------------------------------------------------------------------------------
# Operators


def clamp(rgb):
    """Limit each channel to [0, 1]: no tone mapping, the baseline.

    >>> clamp([-0.1, 0.18, 4]).tolist()
    [0.0, 0.18, 1.0]
    """
    return np.clip(np.asarray(rgb, float), 0, 1)


def reinhard(rgb, apply="channels"):
    """f(x) = x / (1 + x).

    References
    ----------
    Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images", ACM TOG 21(3),
    2002, equation 3. The paper maps luminance; per channel is how most code uses it.

    >>> reinhard([0.18, 1, 4]).round(9).tolist()
    [0.152542373, 0.5, 0.8]
    """
    return apply_curve(lambda x: x / (1 + x), limit_scene(rgb), apply)


def reinhard_extended(rgb, white=4.0, apply="channels"):
    """f(x) = x (1 + x / white^2) / (1 + x); f(white) = 1, unbounded above.

    References
    ----------
    Reinhard et al. 2002, equation 4. `white` (L_white) is the smallest scene value mapped to 1.

    >>> reinhard_extended([0.18, 4, 16], white=4).round(9).tolist()
    [0.154258475, 1.0, 1.882352941]
    """
    return apply_curve(lambda x: x * (1 + x / white**2) / (1 + x), limit_scene(rgb), apply)


def reinhard_jodie(rgb):
    """Blend of Reinhard on luminance, C/(1+L), and per channel, t = C/(1+C), with t as the weight.

    References
    ----------
    Jodie, shader "Tone mapping" (shadertoy.com/view/4dBcD1); weights 0.2126, 0.7152, 0.0722.

    >>> reinhard_jodie([0.8, 0.1, 0.05]).round(9).tolist()
    [0.55445415, 0.081271498, 0.040509354]
    """
    c = limit_scene(rgb)
    t = c / (1 + c)
    return (1 - t) * (c / (1 + luminance(c))) + t * t


def hable(rgb, shoulder_strength=0.15, linear_strength=0.50, linear_angle=0.10, toe_strength=0.20,
          toe_numerator=0.02, toe_denominator=0.30, white=11.2, exposure_bias=2.0):
    """h(exposure_bias x) / h(white), h(x) = (x(Ax + CB) + DE) / (x(Ax + B) + DF) - E/F.

    The white is not scaled by the bias, as in the author's code: 1 is reached at x = white / exposure_bias.

    References
    ----------
    J. Hable, "Uncharted 2: HDR Lighting", GDC 2010, and "Filmic Tonemapping Operators", filmicworlds.com, 2010:
    A..F in the order of the parameters, W = white.

    >>> hable([0.18, 1, 5.6]).round(9).tolist()
    [0.128338449, 0.492918546, 1.0]
    """
    a, b, c, d, e, f = (shoulder_strength, linear_strength, linear_angle, toe_strength, toe_numerator,
                        toe_denominator)

    def h(x):
        return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f

    return h(exposure_bias * limit_scene(rgb)) / h(white)


def uchimura(rgb, max_brightness=1.0, contrast=1.0, linear_start=0.22, linear_length=0.4,
             black_tightness=1.33, pedestal=0.0):
    """Toe m(x/m)^c + b, line m + a(x-m) and exponential shoulder to P, blended; range [b, P].

    Parameters are the paper's P, a, m, l, c, b in this order; m, a > 0 and l < 1.

    References
    ----------
    H. Uchimura, "HDR Theory and Practice", CEDEC 2017; curve: desmos.com/calculator/gslcdxvipg.

    >>> uchimura([0.18, 1, 4]).round(9).tolist()
    [0.178994806, 0.827832422, 0.999716853]
    """
    p, a, m, l, c, b = max_brightness, contrast, linear_start, linear_length, black_tightness, pedestal
    x = limit_scene(rgb)
    l0 = (p - m) * l / a
    s0, s1 = m + l0, m + a * l0  # where the line ends: input, output
    toe = m * (x / m) ** c + b
    line = m + a * (x - m)
    shoulder = p - (p - s1) * np.exp(-(a * p / (p - s1)) * (x - s0) / p)
    t = np.clip(x / m, 0, 1)
    w_toe = 1 - t * t * (3 - 2 * t)
    w_shoulder = np.where(x >= s0, 1.0, 0.0)
    return toe * w_toe + line * (1 - w_toe - w_shoulder) + shoulder * w_shoulder


def aces_narkowicz(rgb, prescale=1.0):
    """x(2.51x + 0.03) / (x(2.43x + 0.59) + 0.14) of prescale x, limited to [0, 1].

    References
    ----------
    K. Narkowicz, "ACES Filmic Tone Mapping Curve", knarkowicz.wordpress.com, 2016-01-06. Its note: multiply
    the input by 0.6 to match the exposure of ACES.

    >>> aces_narkowicz([0.18, 1, 16]).round(9).tolist()
    [0.26689892, 0.803797468, 1.0]
    """
    x = limit_scene(rgb) * prescale
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)


HILL_IN = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
HILL_OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])


def hill_curve(v):
    """S. Hill's fit of the ACES RRT and ODT curves, between his two matrices.

    >>> float(hill_curve(np.float64(0)).round(9))
    -0.000380278
    """
    return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)


def aces_hill(rgb):
    """Rec.709 -> AP1 with RRT_SAT, curve, ODT_SAT and AP1 -> Rec.709, limited to [0, 1].

    References
    ----------
    S. Hill, ACES.hlsl in M. Pettineo's BakingLab (MIT). Input and output are Rec.709: the matrices hold the
    conversions. Here without BakingLab's gain of 1.8 behind it.

    >>> aces_hill([0.8, 0.1, 0.05]).round(9).tolist()
    [0.572381943, 0.051640303, 0.02338771]
    """
    return np.clip(hill_curve(limit_scene(rgb) @ HILL_IN.T) @ HILL_OUT.T, 0, 1)


AGX_INSET = np.array([[0.842479062253094, 0.0784335999999992, 0.0792237451477643],
                      [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
                      [0.0423756549057051, 0.0784336, 0.879142973793104]])


# -10 and +6.5 stops about 0.18 as Sobotka's config and its followers truncate them. The exact log2(0.18) - 10
# and log2(0.18) + 6.5 would move code values by up to 1e-7.
AGX_LOG2 = (-12.47393, 4.026069)


def agx_shape(rgb):
    """log2 of scene-linear, normalised so that AGX_LOG2 becomes [0, 1], clamped.

    >>> agx_shape(np.array([0.0, 0.18, 99.0])).round(6).tolist()
    [0.0, 0.606061, 1.0]
    """
    low, high = AGX_LOG2
    with np.errstate(divide="ignore"):  # log2(0) = -inf, which the clamp turns into 0
        return np.clip((np.log2(rgb) - low) / (high - low), 0, 1)


def agx_sigmoid(n, pivot=(10 / 16.5, 0.5), slope=2.0, powers=(3.0, 3.25)):
    """T. Sobotka's two-sided sigmoid through (0,0), the pivot with the given slope, and (1,1).

    Each side is u / (1 + u^p)^(1/p), scaled to end exactly at its corner. Toe power first, then shoulder. The
    defaults reproduce the 4096 entries of AgX_Default_Contrast.spi1d within their seven printed decimals.

    >>> agx_sigmoid(np.array([0.5, 10 / 16.5, 0.9])).round(7).tolist()
    [0.2926735, 0.5, 0.9545841]
    """
    (px, py), k, (toe, shoulder) = pivot, slope, powers

    def side(u, lx, ly, p):  # u, lx, ly: distances from the pivot
        scale = ((k * lx) ** -p * ((k * lx / ly) ** p - 1)) ** (-1 / p)
        return scale * (k * u / scale) / (1 + (k * u / scale) ** p) ** (1 / p)

    below = np.maximum(py - side(np.maximum(px - n, 0), px, py, toe), 0)  # S(0) is 0, not -1e-16
    above = py + side(np.maximum(n - px, 0), 1 - px, 1 - py, shoulder)
    return np.where(n < px, below, above)


# ASC CDL of the config's looks, in OCIO's no-clamp style.
AGX_LOOKS = {
    "golden": {"slope": np.array([1.0, 0.9, 0.5]), "power": 0.8, "saturation": 1.3},
    "punchy": {"slope": np.ones(3), "power": 1.35, "saturation": 1.4},
}


def cdl(code, slope, power, saturation):
    """ASC CDL 1.2 without offset and without clamps: saturation about the luma of the powered value.

    >>> cdl(np.array([0.5, 0.5, 0.5]), np.ones(3), 2.0, 1.4).round(9).tolist()
    [0.25, 0.25, 0.25]
    """
    v = code * slope
    v = np.where(v > 0, np.maximum(v, 0) ** power, v)  # no-clamp: negatives pass unpowered
    luma = luminance(v)
    return luma + saturation * (v - luma)


def agx_sobotka(rgb, look=""):
    """Inset, log2 over -10..+6.5 stops about 0.18, sigmoid, look. Code values of a 2.2 power; no outset.

    References
    ----------
    T. Sobotka, AgX (github.com/sobotka/AgX), config.ocio: matrix, allocation (log2), looks.

    >>> agx_sobotka([0.8, 0.1, 0.05]).round(6).tolist()
    [0.729398, 0.437204, 0.370924]
    """
    code = agx_sigmoid(agx_shape(limit_scene(rgb) @ AGX_INSET.T))
    return cdl(code, **AGX_LOOKS[look]) if look else code


# Highest power first.
AGX_POLYNOMIALS = {
    6: [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232],
    7: [-17.86, 78.01, -126.7, 92.06, -28.72, 4.361, -0.1718, 0.002857],
}


def agx_minimal(rgb, order=6):
    """Sobotka's inset and log2, a polynomial for his curve, inverse inset on the code values.

    Code values of a 2.2 power; order 6 gives negative ones at black.

    References
    ----------
    B. Wrensch, "Minimal AgX Implementation", iolite-engine.com, 2023 (order 6); order 7: Filament, ToneMapper.cpp.

    >>> agx_minimal([0.8, 0.1, 0.05]).round(9).tolist()
    [0.79469506, 0.423532987, 0.341266439]
    """
    n = agx_shape(limit_scene(rgb) @ AGX_INSET.T)
    return np.polyval(AGX_POLYNOMIALS[int(order)], n) @ np.linalg.inv(AGX_INSET).T


OPERATORS = {f.__name__: f for f in (clamp, reinhard, reinhard_extended, reinhard_jodie, hable, uchimura,
                                     aces_narkowicz, aces_hill, agx_sobotka, agx_minimal)}
# Operators that put out code values, and the power that decodes them.
CODE_POWER = {"agx_sobotka": 2.2, "agx_minimal": 2.2}

# --------------------------------------------------------------------------------------------------
# Colour spaces and displays

D65 = (0.3127, 0.3290)  # ITU-R BT.709-6, table 1
ACES_WHITE = (0.32168, 0.33767)  # SMPTE ST 2065-1
# xy of red, green, blue, white.
PRIMARIES = {
    "rec709": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), D65),  # ITU-R BT.709-6
    "rec2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65),  # ITU-R BT.2020-2
    "p3d65": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), D65),  # SMPTE EG 432-1
    "ap0": ((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770), ACES_WHITE),  # SMPTE ST 2065-1
    "ap1": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), ACES_WHITE),  # Academy S-2014-004
}
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz(xy):
    """CIE XYZ with Y = 1 of a chromaticity.

    >>> xyz((0.25, 0.5)).tolist()
    [0.5, 1.0, 0.5]
    """
    x, y = xy
    return np.array([x / y, 1, (1 - x - y) / y])


def rgb_to_xyz(name):
    """Matrix of linear RGB to CIE XYZ under the space's own white (SMPTE RP 177).

    >>> rgb_to_xyz("ap1")[1].round(9).tolist()
    [0.272228717, 0.674081766, 0.053689517]
    """
    *rgb, white = PRIMARIES[name]
    columns = np.stack([xyz(p) for p in rgb], axis=-1)
    return columns * np.linalg.solve(columns, xyz(white))


def rgb_to_rgb(source, target):
    """Matrix between linear RGB spaces, Bradford-adapted (ICC.1 annex E) where their whites differ.

    >>> rgb_to_rgb("ap0", "ap1")[0].round(10).tolist()  # Academy S-2014-004: 1.4514393161, ...
    [1.4514393161, -0.2365107469, -0.2149285693]
    """
    if source == target:
        return np.eye(3)
    cones = [BRADFORD @ xyz(PRIMARIES[name][3]) for name in (source, target)]
    adapt = np.linalg.solve(BRADFORD, np.diag(cones[1] / cones[0]) @ BRADFORD)
    if PRIMARIES[source][3] == PRIMARIES[target][3]:
        adapt = np.eye(3)
    return np.linalg.solve(rgb_to_xyz(target), adapt @ rgb_to_xyz(source))


def srgb_encode(light):
    """Display light -> code value, IEC 61966-2-1:1999.

    >>> srgb_encode(np.array([0.001, 0.5])).round(9).tolist()
    [0.01292, 0.735356983]
    """
    light = np.asarray(light, float)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def power_encode(exponent):
    """Display light -> code value of a pure power display; negatives become 0.

    >>> power_encode(2.0)(np.array([-1.0, 0.25])).tolist()
    [0.0, 0.5]
    """
    return lambda light: np.maximum(light, 0) ** (1 / exponent)


INPUTS = {f"lin_{name}": name for name in PRIMARIES}
DISPLAYS = {
    "srgb": ("rec709", srgb_encode),
    "rec1886": ("rec709", power_encode(2.4)),  # ITU-R BT.1886 with black at 0
    "g22": ("rec709", power_encode(2.2)),
    "display_p3": ("p3d65", srgb_encode),
    "rec2020": ("rec2020", power_encode(2.4)),
}


def sanitise(rgb):
    """NaN -> 0, then each channel limited to +-65504.

    >>> sanitise([np.nan, -np.inf, np.inf]).tolist()
    [0.0, -65504.0, 65504.0]
    """
    return np.clip(np.nan_to_num(np.asarray(rgb, float), nan=0.0), -HALF_MAX, HALF_MAX)


def view(operator, rgb, settings=None, look="", exposure=0.0, input="lin_rec709", display="srgb"):
    """What `tonewright eval` prints: input space -> exposure -> operator -> display.

    Parameters
    ----------
    operator : key of OPERATORS
    rgb : (..., 3) array, scene-linear in `input`; any float, NaN and infinities included
    settings : dict, parameters of the operator that differ from its defaults
    look : str, look of the operator, or empty
    exposure : stops
    input : key of INPUTS
    display : key of DISPLAYS, or 'native' (the operator's own output), or 'linear' (display-linear Rec.709, unclamped)

    Returns
    -------
    (..., 3) array

    >>> view("agx_sobotka", [0.18, 0.18, 0.18], display="g22").round(4).tolist()
    [0.5, 0.5, 0.5]
    """
    scene = sanitise(rgb) @ rgb_to_rgb(INPUTS[input], "rec709").T * 2.0**exposure
    out = OPERATORS[operator](scene, **(settings or {}), **({"look": look} if look else {}))
    if display == "native":
        return out
    if operator in CODE_POWER:
        out = np.maximum(out, 0) ** CODE_POWER[operator]
    if display == "linear":
        return out
    primaries, encode = DISPLAYS[display]
    return encode(np.clip(np.clip(out, 0, 1) @ rgb_to_rgb("rec709", primaries).T, 0, 1))
