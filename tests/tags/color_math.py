# SPDX-License-Identifier: Apache-2.0
"""Colors of tagged files by the closed formulas of the standards, in double precision.

Nothing here comes from Tonewright. Light is relative to 100 cd/m2 = 1.0, which is the project's stated convention.
"""

import numpy as np

# CIE xy of red, green, blue and white.
D65 = (0.3127, 0.3290)
D50 = (0.34567, 0.35850)
DCI_WHITE = (0.314, 0.351)
ACES_WHITE = (0.32168, 0.33767)
ILLUMINANT_C = (0.310, 0.316)
EQUAL_ENERGY = (1 / 3, 1 / 3)
PRIMARIES = {
    "rec709": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), D65),  # ITU-R BT.709-6
    "rec2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65),  # ITU-R BT.2020-2
    "p3_d65": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), D65),  # SMPTE EG 432-1
    "p3_dci": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), DCI_WHITE),  # SMPTE RP 431-2
    "adobe_rgb": ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06), D65),  # Adobe RGB (1998)
    "prophoto": ((0.734699, 0.265301), (0.159597, 0.840403), (0.036598, 0.000105), D50),  # ISO 22028-2
    "ap0": ((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770), ACES_WHITE),  # SMPTE ST 2065-1
    "ap1": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), ACES_WHITE),  # S-2014-004
    "bt470m": ((0.67, 0.33), (0.21, 0.71), (0.14, 0.08), ILLUMINANT_C),  # H.273, 4
    "bt470bg": ((0.64, 0.33), (0.29, 0.60), (0.15, 0.06), D65),  # H.273, 5
    "smpte170m": ((0.630, 0.340), (0.310, 0.595), (0.155, 0.070), D65),  # H.273, 6 and 7
    "film": ((0.681, 0.319), (0.243, 0.692), (0.145, 0.049), ILLUMINANT_C),  # H.273, 8
    "xyz": ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0), EQUAL_ENERGY),  # H.273, 10
    "ebu3213": ((0.630, 0.340), (0.295, 0.605), (0.155, 0.077), D65),  # H.273, 22
    # The defaults of Radiance: filefmts.pdf.
    "radiance": ((0.640, 0.330), (0.290, 0.600), (0.150, 0.060), EQUAL_ENERGY),
}

BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
# The connection space of ICC.1 states its white so, and profiles hold numbers of it.
ICC_D50 = np.array([0.9642, 1.0, 0.8249])


def white_xyz(xy):
    return np.array([xy[0] / xy[1], 1.0, (1 - xy[0] - xy[1]) / xy[1]])


def rgb_to_xyz(primaries):
    """SMPTE RP 177: the matrix that gives white for (1, 1, 1)."""
    *colors, white = primaries
    columns = np.array([[x, y, 1 - x - y] for x, y in colors]).T
    return columns * np.linalg.solve(columns, white_xyz(white))


def bradford(source, target):
    """Adaptation of XYZ from one white to another (XYZ)."""
    gains = (BRADFORD @ target) / (BRADFORD @ source)
    return np.linalg.inv(BRADFORD) @ np.diag(gains) @ BRADFORD


def to_rec709(rgb, primaries):
    """Linear RGB of some primaries (a name, or xy of red, green, blue, white) -> linear Rec.709."""
    if isinstance(primaries, str):
        primaries = PRIMARIES[primaries]
    xyz = rgb_to_xyz(primaries) @ np.asarray(rgb, float)
    if primaries[3] != D65:
        xyz = bradford(white_xyz(primaries[3]), white_xyz(D65)) @ xyz
    return np.linalg.inv(rgb_to_xyz(PRIMARIES["rec709"])) @ xyz


def xyz_to_rec709(xyz, white=None):
    """CIE XYZ -> linear Rec.709, adapted from a white (XYZ) to D65 where one is given."""
    xyz = np.asarray(xyz, float)
    if white is not None:
        xyz = bradford(np.asarray(white, float), white_xyz(D65)) @ xyz
    return np.linalg.inv(rgb_to_xyz(PRIMARIES["rec709"])) @ xyz


def lab_to_xyz(lab, white):
    """CIE 15: L* 0..100."""
    fy = (lab[0] + 16) / 116
    f = np.array([fy + lab[1] / 500, fy, fy - lab[2] / 200])
    return np.where(f > 6 / 29, f**3, 3 * (6 / 29) ** 2 * (f - 4 / 29)) * white


# --------------------------------------------------------------------------------------------------
# Code values -> light


def srgb(code):
    """IEC 61966-2-1, odd for negative codes."""
    code = np.asarray(code, float)
    size = np.abs(code)
    return np.sign(code) * np.where(size <= 0.04045, size / 12.92, ((size + 0.055) / 1.055) ** 2.4)


def power(gamma):
    return lambda code: np.asarray(code, float) ** gamma


def linear(code):
    return np.asarray(code, float)


def bt709_camera(code):
    """Inverse of the camera curve of ITU-R BT.709 (H.273: 1, 6, 14, 15)."""
    code = np.asarray(code, float)
    alpha, beta = 1.09929682680944, 0.018053968510807
    return np.where(code < 4.5 * beta, code / 4.5, ((code + alpha - 1) / alpha) ** (1 / 0.45))


def smpte240m(code):
    """Inverse of the curve of SMPTE ST 240 (H.273: 7)."""
    code = np.asarray(code, float)
    return np.where(code < 4 * 0.0228, code / 4, ((code + 0.1115) / 1.1115) ** (1 / 0.45))


def log_100(code):
    """H.273: 9, inverse of 1 + log10(L) / 2."""
    return 10.0 ** (2 * (np.asarray(code, float) - 1))


def log_316(code):
    """H.273: 10, inverse of 1 + log10(L) / 2.5."""
    return 10.0 ** (2.5 * (np.asarray(code, float) - 1))


def pq(code):
    """SMPTE ST 2084, as multiples of 100 cd/m2."""
    m1, m2, c1, c2, c3 = 2610 / 16384, 2523 / 32, 3424 / 4096, 2413 / 128, 2392 / 128
    root = np.asarray(code, float) ** (1 / m2)
    return (np.maximum(root - c1, 0) / (c2 - c3 * root)) ** (1 / m1) * 100


def hlg(code, primaries="rec2020", peak=1000.0):
    """ITU-R BT.2100: inverse OETF, and the OOTF of a display of 1000 cd/m2 (gamma 1.2); multiples of 100 cd/m2."""
    a = 0.17883277
    b, c = 1 - 4 * a, 0.5 - a * np.log(4 * a)
    code = np.asarray(code, float)
    scene = np.where(code <= 0.5, code**2 / 3, (np.exp((code - c) / a) + b) / 12)
    luminance = rgb_to_xyz(PRIMARIES[primaries])[1] @ scene
    return peak / 100 * luminance ** (1.2 - 1) * scene


def st428(code):
    """SMPTE ST 428-1 (H.273: 17): 48 cd/m2 is 52.37 of full scale, so that 1.0 is the white of 48 cd/m2."""
    return np.asarray(code, float) ** 2.6 * 52.37 / 48
