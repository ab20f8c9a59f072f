#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tagged picture files: every tag of every format that Tonewright reads, and the light that its standard gives.

    /usr/bin/python3 tests/tags/make_files.py FOLDER [NAME...]

writes the files. A row names the tag, makes the file byte by byte, and derives the linear Rec.709 value of its pixels from
the stored integers by the formulas of color_math.py. 1.0 is 100 cd/m2. `treatment` is what Tonewright does with the tag:

    used        the derived value comes out; no line says anything, or one says with `word` what was chosen
    named       one line of warning (or of `info`) has the word, and the value is `ignored`: that of the file without the tag
    impossible  the file is refused (exit status 3), and the message has the word
    no effect   the tag says nothing about color, layer, orientation, units or alpha; the value is right, and nothing is named
"""

import dataclasses
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path
from typing import Callable

import numpy as np
from color_math import (D50, ICC_D50, PRIMARIES, bt709_camera, hlg, lab_to_xyz, linear, log_100, log_316, power, pq,
                        rgb_to_xyz, smpte240m, srgb, st428, to_rec709, white_xyz, xyz_to_rec709)
from file_bytes import *  # noqa: F403

USED, NAMED, IMPOSSIBLE, NO_EFFECT = "used", "named", "impossible", "no effect"
# Half of the smallest step of half floats and of RGBE is below 0.5 %; all other files are derived from stored integers.
TOLERANCE = 0.01


class Missing(Exception):
    """The program that writes a file is not here."""


@dataclasses.dataclass
class Row:
    name: str  # of the file
    format: str
    tag: str
    make: Callable[[], bytes]
    rgb: tuple = None  # linear Rec.709; None: only the treatment counts
    treatment: str = USED
    ignored: tuple = None  # the value without the named tag, where it differs
    word: str = ""  # what the warning or the message must have; several: one of them, separated by |
    value: bool = False  # one of the files on which other programs are compared
    others: tuple = ()  # values that other programs may give, because the standard admits them: (rgb, why)
    points: tuple = ()  # ((x, y), rgb) instead of one color everywhere
    size: tuple = None  # width, height of the upright picture
    alpha: float = None
    options: tuple = ()
    info: dict = dataclasses.field(default_factory=dict)  # fields of `info --json`
    tolerance: float = TOLERANCE
    why: str = ""  # of another tolerance, or of several treatments
    extra: tuple = ()  # (name, bytes) of files beside it


ROWS = []


def add(name, form, tag, make, rgb=None, **more):
    if rgb is not None:
        rgb = tuple(float(v) for v in rgb)
    row = Row(name, form, tag, make, rgb, **more)
    if row.ignored is not None:
        row.ignored = tuple(float(v) for v in row.ignored)
    row.others = tuple((tuple(float(v) for v in other), why) for other, why in row.others)
    ROWS.append(row)


def run_encoder(command, data, source, target):
    """The bytes that a program writes."""
    if not shutil.which(command[0]):
        raise Missing(f"{command[0]} is not installed")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / source).write_bytes(data)
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        made = Path(folder) / target
        if done.returncode or not made.is_file():
            raise Missing(f"{command[0]} cannot write it: {(done.stderr or done.stdout).strip()[-200:]}")
        return made.read_bytes()


def with_oiio(suffix, array, attributes=(), dtype="uint8"):
    """The bytes that OpenImageIO writes; for formats whose streams are long to write by hand."""
    try:
        import OpenImageIO as oiio  # noqa: PLC0415
    except ImportError as error:
        raise Missing("OpenImageIO for Python is not installed") from error
    height, width, channels = array.shape
    spec = oiio.ImageSpec(width, height, channels, dtype)
    for key, value in attributes:
        spec[key] = value
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / f"made.{suffix}")
        out = oiio.ImageOutput.create(path)
        if not out or not out.open(path, spec) or not out.write_image(array) or not out.close():
            raise Missing(f"OpenImageIO cannot write .{suffix}: {oiio.geterror()}")
        return Path(path).read_bytes()


# Codes of most files: no channel is negative in Rec.709 or near black.
CODES = (0.5, 0.4, 0.3)
C16 = codes(CODES, 16)
C8 = codes(CODES, 8)
F16, F8 = np.array(C16) / 65535, np.array(C8) / 255
RGB16, RGB8 = pixels(C16), pixels(C8)
SRGB8, SRGB16 = srgb(F8), srgb(F16)


# --------------------------------------------------------------------------------------------------
# Orientation: four corners of different colors


CORNERS = {"top left": (200, 60, 60), "top right": (60, 200, 60), "bottom left": (60, 60, 200), "bottom right": (200, 200, 60)}


def corner_picture(width=32, height=16, channels=3):
    out = np.zeros((height, width, channels), np.uint8)
    for name, color in CORNERS.items():
        rows = slice(0, height // 2) if "top" in name else slice(height // 2, None)
        columns = slice(0, width // 2) if "left" in name else slice(width // 2, None)
        out[rows, columns, :3] = color
    if channels == 4:
        out[:, :, 3] = 255
    return out


def corner_points(light=lambda code: srgb(np.array(code) / 255), width=32, height=16):
    x = {"left": 1, "right": width - 2}
    y = {"top": 1, "bottom": height - 2}
    return tuple(((x[name.split()[1]], y[name.split()[0]]), tuple(light(color))) for name, color in CORNERS.items())


# Exif and TIFF 6.0: upright picture -> rows as they are stored. 5 to 8 change rows and columns.
STORED = {1: lambda a: a, 2: lambda a: a[:, ::-1], 3: lambda a: a[::-1, ::-1], 4: lambda a: a[::-1],
          5: lambda a: a.transpose(1, 0, 2), 6: lambda a: np.rot90(a, 1), 7: lambda a: a[::-1, ::-1].transpose(1, 0, 2),
          8: lambda a: np.rot90(a, -1)}


def stored(number):
    return np.ascontiguousarray(STORED[number](corner_picture()))


def add_corners(name, form, tag, make, **more):
    more.setdefault("points", corner_points())
    add(name, form, tag, make, size=(32, 16), **more)


# --------------------------------------------------------------------------------------------------
# PNG (W3C, third edition; ITU-T H.273)

H273_PRIMARIES = {1: "rec709", 4: "bt470m", 5: "bt470bg", 6: "smpte170m", 7: "smpte170m", 8: "film", 9: "rec2020", 10: "xyz",
                  11: "p3_dci", 12: "p3_d65", 22: "ebu3213"}
H273_CURVES = {1: power(2.4), 4: power(2.2), 5: power(2.8), 6: power(2.4), 7: smpte240m, 8: linear, 9: log_100, 10: log_316,
               13: srgb, 14: power(2.4), 15: power(2.4), 16: pq, 17: st428}


def h273(code, primaries, transfer):
    space = H273_PRIMARIES[primaries]
    # The Color Interop Forum's pq_xyzd65_display and g26_xyzd65_display have primaries 10: CIE XYZ itself, whose gray is D65.
    if space == "xyz":
        return xyz_to_rec709(H273_CURVES[transfer](code))
    return to_rec709(hlg(code, space) if transfer == 18 else H273_CURVES[transfer](code), space)


def h273_others(code, primaries, transfer):
    """Curves for which two standards give two numbers."""
    space = H273_PRIMARIES[primaries]
    if transfer in (1, 6, 14, 15):
        return ((to_rec709(bt709_camera(code), space), "inverse of the camera curve of H.273 instead of the display's BT.1886"),)
    if transfer == 7:
        return ((to_rec709(power(2.4)(code), space), "a display of BT.1886"),)
    if transfer == 17:
        return ((to_rec709(power(2.6)(code), space), "white is full scale, as in OpenColorIO"),)
    return ()


def png_rows():
    form = "PNG"
    common = {(1, 13), (9, 16), (9, 18), (12, 16), (12, 13), (1, 8), (9, 8), (1, 16), (1, 18), (9, 13), (1, 4), (9, 1), (9, 14),
              (9, 15), (1, 1), (1, 6), (12, 8), (12, 4), (9, 4), (12, 18), (1, 15), (12, 1), (1, 14)}
    rare = {(11, 17), (1, 5), (6, 6), (5, 1), (5, 5), (4, 4), (22, 6), (8, 1), (10, 17), (10, 8), (6, 7), (1, 9), (1, 10), (11, 16)}
    values = {(9, 16), (9, 18), (12, 16), (12, 13), (1, 16), (9, 13), (9, 8), (1, 8), (1, 18)}
    for primaries, transfer in sorted(common | rare):
        add(f"cicp-{primaries}-{transfer}.png", form, f"cICP {primaries}/{transfer}",
            lambda p=primaries, t=transfer: png(RGB16, chunks=[cicp(p, t)]), h273(F16, primaries, transfer),
            others=h273_others(F16, primaries, transfer), value=(primaries, transfer) in values)

    limited = (np.array(C16) - 16 * 256) / (219 * 256)  # H.273, equation 20, for 16 bits
    add("cicp-limited.png", form, "cICP, narrow range", lambda: png(RGB16, chunks=[cicp(9, 16, 0, 0)]),
        h273(limited, 9, 16), value=True)
    add("cicp-8bit.png", form, "cICP 9/16, 8 bits", lambda: png(RGB8, 8, [cicp(9, 16)]), h273(F8, 9, 16))
    for numbers, why in (((200, 16), "reserved primaries"), ((1, 200), "reserved transfer"), ((2, 2), "unspecified")):
        add(f"cicp-{numbers[0]}-{numbers[1]}.png", form, f"cICP {numbers[0]}/{numbers[1]}",
            lambda n=numbers: png(RGB16, chunks=[cicp(*n)]), SRGB16,
            treatment=NAMED if numbers == (2, 2) else IMPOSSIBLE, word="200|2/2|cICP", why=why)
    add("cicp-matrix.png", form, "cICP with a matrix", lambda: png(RGB16, chunks=[cicp(9, 16, 9)]), h273(F16, 9, 16),
        treatment=IMPOSSIBLE, word="matrix|cICP", why="PNG asks for matrix 0")
    # Order of precedence: cICP, iCCP, sRGB, gAMA with cHRM.
    srgb_profile = icc_matrix("rec709", SRGB_PARAMETRIC, 4)
    p3 = icc_matrix("p3_d65", icc_curve(2.2))
    others = [(b"sRGB", b"\0"), gama(1 / 2.2), chrm("rec709")]
    add("cicp-over-all.png", form, "cICP over iCCP, sRGB, gAMA, cHRM",
        lambda: png(RGB16, chunks=[cicp(9, 16), iccp(srgb_profile), *others[1:]]), h273(F16, 9, 16),
        word="but cICP decides", value=True)
    p3_light = to_rec709(power(563 / 256)(F16), "p3_d65")  # 2.2 as icc_curve stores it: 8 bits after the point
    add("iccp-over-gama.png", form, "iCCP over gAMA, cHRM", lambda: png(RGB16, chunks=[iccp(p3), gama(1), chrm("rec2020")]),
        p3_light, word="gAMA and cHRM: it says", value=True)
    add("srgb-over-gama.png", form, "sRGB over gAMA, cHRM", lambda: png(RGB16, chunks=[others[0], gama(1), chrm("rec2020")]),
        SRGB16, word="but sRGB chunk decides", value=True)
    add("cicp-after-pixels.png", form, "cICP after IDAT", lambda: png(RGB16, after=[cicp(9, 16)]), SRGB16,
        treatment=NAMED, word="cICP: it comes after the pixels", others=((h273(F16, 9, 16), "the chunk counts anywhere"),))
    add_corners("exif-after-pixels.png", form, "eXIf after IDAT",
                lambda: png(stored(6), 8, after=[(b"eXIf", exif_block({274: (SHORT, 6)}))]))
    # Profiles
    add("iccp-v2-gamma.png", form, "iCCP, v2 matrix, gamma", lambda: png(RGB16, chunks=[iccp(p3)]), p3_light, value=True)
    table = [round(float(srgb(i / 1023)) * 65535) for i in range(1024)]
    add("iccp-v2-table.png", form, "iCCP, v2 matrix, table",
        lambda: png(RGB16, chunks=[iccp(icc_matrix("adobe_rgb", icc_curve(table)))]), to_rec709(SRGB16, "adobe_rgb"), value=True)
    add("iccp-v4-para.png", form, "iCCP, v4 matrix, parametric",
        lambda: png(RGB16, chunks=[iccp(icc_matrix("p3_d65", SRGB_PARAMETRIC, 4))]), to_rec709(SRGB16, "p3_d65"), value=True)
    add("iccp-v4-linear.png", form, "iCCP, v4 matrix, line",
        lambda: png(RGB16, chunks=[iccp(icc_matrix("rec2020", icc_curve(None), 4))]), to_rec709(F16, "rec2020"))
    add("iccp-prophoto.png", form, "iCCP, white D50", lambda: png(RGB16, chunks=[iccp(icc_matrix("prophoto", icc_curve(1.8)))]),
        # 461/256 is what the profile stores for 1.8
        to_rec709(power(461 / 256)(F16), (*PRIMARIES["prophoto"][:3], D50)), value=True)
    add("iccp-lut16.png", form, "iCCP, v2 LUT", lambda: png(RGB16, chunks=[iccp(icc_lut16("adobe_rgb", 2.2))]),
        to_rec709(power(2.2)(F16), "adobe_rgb"), value=True)
    add("iccp-lut-ab.png", form, "iCCP, v4 lutAToB",
        lambda: png(RGB16, chunks=[iccp(icc_lut_ab("p3_d65", icc_parametric(0, 2.2)))]), to_rec709(power(2.2)(F16), "p3_d65"))
    add("iccp-gray.png", form, "iCCP, gray", lambda: png(pixels([C16[0]]), chunks=[iccp(icc_gray(icc_curve(1.8)))]),
        [F16[0] ** (461 / 256)] * 3, value=True)
    add("iccp-cicp.png", form, "iCCP, v4.4 tag cicp",
        lambda: png(RGB16, chunks=[iccp(icc_cicp("rec2020", icc_parametric(0, 2.2), (9, 16, 0, 1)))]), h273(F16, 9, 16),
        others=((to_rec709(power(2.2)(F16), "rec2020"), "the curves of the profile count"),))
    add("iccp-broken.png", form, "iCCP that is no profile", lambda: png(RGB16, chunks=[iccp(b"no profile" * 20)]), SRGB16,
        treatment=NAMED, word="ICC|profile")
    # Chunks of 1996
    add("srgb.png", form, "sRGB", lambda: png(RGB16, chunks=[(b"sRGB", b"\0")]), SRGB16, value=True)
    add("untagged.png", form, "none", lambda: png(RGB8, 8), SRGB8)
    add("gama-1-8.png", form, "gAMA", lambda: png(RGB16, chunks=[gama(1 / 1.8)]), power(100000 / 55556)(F16), value=True)
    add("gama-linear.png", form, "gAMA 1", lambda: png(RGB16, chunks=[gama(1)]), F16)
    add("gama-22.png", form, "gAMA 0.45455", lambda: png(RGB16, chunks=[gama(1 / 2.2)]), power(2.2)(F16))
    add("gama-chrm.png", form, "gAMA, cHRM", lambda: png(RGB16, chunks=[gama(1 / 2.2), chrm("adobe_rgb")]),
        to_rec709(power(2.2)(F16), "adobe_rgb"), value=True)
    add("gama-chrm-2020.png", form, "gAMA 1, cHRM", lambda: png(RGB16, chunks=[chrm("rec2020"), gama(1)]),
        to_rec709(F16, "rec2020"))
    add("chrm.png", form, "cHRM alone", lambda: png(RGB16, chunks=[chrm("p3_d65")]), to_rec709(SRGB16, "p3_d65"))
    # Metadata of a mastering display say nothing about a pixel.
    mdcv = struct.pack(">8HII", 35400, 14600, 8500, 39850, 6550, 2300, 15635, 16450, 10000000, 1)
    for tag, data, spelled in (("mDCV", mdcv, b"mDCV"), ("cLLI", struct.pack(">II", 10000000, 4000000), b"cLLI"),
                               ("cLLi (draft)", struct.pack(">II", 10000000, 4000000), b"cLLi")):
        add(f"{spelled.decode()}{'-draft' if 'draft' in tag else ''}.png", form, tag,
            lambda s=spelled, d=data: png(RGB16, chunks=[cicp(9, 16), (s, d)]), h273(F16, 9, 16),
            treatment=NO_EFFECT)
    add("sbit.png", form, "sBIT", lambda: png(RGB8, 8, [(b"sBIT", b"\5\6\5")]), SRGB8, treatment=NO_EFFECT)
    add("phys.png", form, "pHYs", lambda: png(RGB8, 8, [(b"pHYs", struct.pack(">IIB", 2, 1, 0))]), SRGB8,
        treatment=NO_EFFECT)
    # Kinds of pixels
    add("trns.png", form, "tRNS of a color", lambda: png(RGB8, 8, [(b"tRNS", struct.pack(">3H", 1, 2, 3))]), SRGB8)
    palette = bytes(C8) + bytes([0, 0, 0])
    add("palette.png", form, "PLTE, 8 bits", lambda: png(pixels([0]), 8, [(b"PLTE", palette)], kind=3), SRGB8)
    add("palette-1bit.png", form, "PLTE, 1 bit", lambda: png(pixels([0]), 1, [(b"PLTE", palette)], kind=3), SRGB8)
    add("palette-trns.png", form, "PLTE, tRNS",
        lambda: png(pixels([0]), 8, [(b"PLTE", palette), (b"tRNS", b"\x80")], kind=3), SRGB8, alpha=128 / 255)
    add("palette-icc.png", form, "PLTE, iCCP", lambda: png(pixels([0]), 8, [iccp(p3), (b"PLTE", palette)], kind=3),
        to_rec709(power(563 / 256)(F8), "p3_d65"))
    for bits in (1, 2, 4):
        level = {1: 1, 2: 2, 4: 6}[bits]
        add(f"gray-{bits}bit.png", form, f"gray, {bits} bit", lambda b=bits, v=level: png(pixels([v]), b),
            [float(srgb(level / (2**bits - 1)))] * 3)
    add("interlaced.png", form, "interlaced", lambda: png(RGB16, chunks=[cicp(9, 16)], interlaced=True), h273(F16, 9, 16))
    add("alpha.png", form, "alpha, straight", lambda: png(pixels([*C8, 51]), 8), SRGB8, alpha=0.2)
    add("alpha-1.png", form, "alpha 1 of 255", lambda: png(pixels([200, 100, 50, 1]), 8), srgb(np.array([200, 100, 50]) / 255),
        alpha=1 / 255)
    add("gray-alpha.png", form, "gray with alpha", lambda: png(pixels([C16[0], 32768])), [float(SRGB16[0])] * 3, alpha=32768 / 65535)
    for number in range(1, 9):
        add_corners(f"exif-{number}.png", form, f"eXIf orientation {number}",
                    lambda n=number: png(stored(n), 8, [(b"eXIf", exif_block({274: (SHORT, n)}))]))
    frame = struct.pack(">IIIIIHHBB", 0, 8, 8, 0, 0, 1, 10, 0, 0)
    second = struct.pack(">IIIIIHHBB", 1, 8, 8, 0, 0, 1, 10, 0, 0)
    add("animated.png", form, "acTL, fcTL, fdAT (APNG)",
        lambda: png(RGB8, 8, [(b"acTL", struct.pack(">II", 2, 0)), (b"fcTL", frame)],
                    after=[(b"fcTL", second), (b"fdAT", struct.pack(">I", 2) + png_data(pixels([0, 0, 0]), 8))]),
        SRGB8, treatment=NAMED, word="frame|animat")


# --------------------------------------------------------------------------------------------------
# JPEG (ITU-T T.81, T.871; Exif 2.32; ICC.1 annex B)


class Bits:
    def __init__(self):
        self.text = ""

    def put(self, value, count):
        self.text += f"{value:0{count}b}" if count else ""

    def stuffed(self):
        text = self.text + "1" * (-len(self.text) % 8)
        return int(text, 2).to_bytes(len(text) // 8, "big").replace(b"\xff", b"\xff\0")


def jpeg(blocks, segments=(JFIF,), ids=None):
    """Baseline JPEG; blocks: rows x columns x components, one value for 8 x 8 samples: exact, as only DC is coded."""
    rows, columns, components = blocks.shape
    ids = ids or list(range(1, components + 1))
    out = b"\xff\xd8" + b"".join(jpeg_segment(marker, data) for marker, data in segments)
    out += jpeg_segment(0xDB, b"\0" + bytes([8]) + bytes([1] * 63))
    frame = struct.pack(">BHHB", 8, rows * 8, columns * 8, components)
    out += jpeg_segment(0xC0, frame + b"".join(bytes([i, 0x11, 0]) for i in ids))
    # DC: 9 categories of 4 bits; AC: the end of the block alone, one bit.
    out += jpeg_segment(0xC4, b"\0" + bytes([0, 0, 0, 9] + [0] * 12) + bytes(range(9)))
    out += jpeg_segment(0xC4, b"\x10" + bytes([1] + [0] * 15) + b"\0")
    out += jpeg_segment(0xDA, bytes([components]) + b"".join(bytes([i, 0]) for i in ids) + b"\0\x3f\0")
    bits, last = Bits(), [0] * components
    for row in blocks:
        for block in row:
            for i, value in enumerate(block):
                difference = int(value) - 128 - last[i]
                last[i] += difference
                size = abs(difference).bit_length()
                bits.put(size, 4)
                bits.put(difference if difference > 0 else difference + (1 << size) - 1, size)
                bits.put(0, 1)
    return out + bits.stuffed() + b"\xff\xd9"


def ycc(rgb):
    """T.871, rounded as a file stores it."""
    r, g, b = (float(v) for v in rgb)
    y = 0.299 * r + 0.587 * g + 0.114 * b
    return [round(v) for v in (y, (b - y) / 1.772 + 128, (r - y) / 1.402 + 128)]


def rgb_of(ycc_codes):
    y, cb, cr = ycc_codes
    r, b = y + 1.402 * (cr - 128), y + 1.772 * (cb - 128)
    g = (y - 0.299 * r - 0.114 * b) / 0.587
    return [min(max(round(v), 0), 255) for v in (r, g, b)]


def jpeg_flat(rgb, **more):
    return jpeg(np.tile(np.array(ycc(rgb)), (2, 2, 1)), **more)


JPEG_CODES = rgb_of(ycc((128, 64, 26)))
J8 = np.array(JPEG_CODES) / 255


def corner_blocks(number):
    small = STORED[number](corner_picture(4, 2))
    return np.array([[ycc(pixel) for pixel in row] for row in small])


def corner_jpeg_points():
    return corner_points(lambda color: srgb(np.array(rgb_of(ycc(color))) / 255))


def exif_segment(data):
    return 0xE1, b"Exif\0\0" + data


def jpeg_rows():
    form = "JPEG"
    light = srgb(J8)
    add("jfif.jpg", form, "JFIF alone", lambda: jpeg_flat(JPEG_CODES), light, value=True)
    adobe = icc_matrix("adobe_rgb", icc_curve(563 / 256))
    wide = to_rec709(power(563 / 256)(J8), "adobe_rgb")
    add("icc.jpg", form, "ICC profile in APP2", lambda: jpeg_flat(JPEG_CODES, segments=[JFIF, *jpeg_icc(adobe)]), wide, value=True)
    add("icc-parts.jpg", form, "ICC profile in five APP2",
        lambda: jpeg_flat(JPEG_CODES, segments=[JFIF, *jpeg_icc(adobe, 5)]), wide, value=True)
    add("icc-parts-swapped.jpg", form, "ICC profile, parts out of order",
        lambda: jpeg_flat(JPEG_CODES, segments=[JFIF, *jpeg_icc(adobe, 3)[::-1]]), wide)
    add("icc-part-missing.jpg", form, "ICC profile, a part is missing",
        lambda: jpeg_flat(JPEG_CODES, segments=[JFIF, *jpeg_icc(adobe, 3)[:2]]), light, treatment=NAMED,
        word="ICC|profile")
    add("icc-lut.jpg", form, "ICC profile, v2 LUT",
        lambda: jpeg_flat(JPEG_CODES, segments=[JFIF, *jpeg_icc(icc_lut16("adobe_rgb", 2.2))]),
        to_rec709(power(2.2)(J8), "adobe_rgb"))
    add("icc-v4.jpg", form, "ICC profile, v4",
        lambda: jpeg_flat(JPEG_CODES, segments=[JFIF, *jpeg_icc(icc_matrix("p3_d65", SRGB_PARAMETRIC, 4))]),
        to_rec709(light, "p3_d65"), value=True)
    for number in range(1, 9):
        add_corners(f"exif-{number}.jpg", form, f"Exif orientation {number}",
                    lambda n=number: jpeg(corner_blocks(n), [exif_segment(exif_block({274: (SHORT, n)}))]),
                    points=corner_jpeg_points())
    add_corners("exif-big-endian.jpg", form, "Exif, big endian",
                lambda: jpeg(corner_blocks(6), [exif_segment(exif_block({274: (SHORT, 6)}, ">"))]), points=corner_jpeg_points())
    add_corners("xmp-orientation.jpg", form, "XMP tiff:Orientation",
                lambda: jpeg(corner_blocks(1), [JFIF, (0xE1, b"http://ns.adobe.com/xap/1.0/\0" + XMP.format(
                    'xmlns:tiff="http://ns.adobe.com/tiff/1.0/" tiff:Orientation="6"').encode())]),
                points=corner_jpeg_points(), treatment=NAMED, word="rientation")  # Exif's is the one that counts
    dcf = {"exif": {0xA001: (SHORT, 0xFFFF), 0x9000: (UNDEFINED, b"0232")}}
    add("exif-r03.jpg", form, "Exif ColorSpace uncalibrated, R03",
        lambda: jpeg_flat(JPEG_CODES, segments=[exif_segment(exif_block(dcf, interoperability=b"R03"))]),
        wide, why="DCF 2.0 says that R03 is Adobe RGB (1998)")
    add("exif-uncalibrated.jpg", form, "Exif ColorSpace uncalibrated",
        lambda: jpeg_flat(JPEG_CODES, segments=[exif_segment(exif_block(dcf))]), light, treatment=NO_EFFECT)
    srgb_exif = {"exif": {0xA001: (SHORT, 1), 0x9000: (UNDEFINED, b"0232")}}
    add("exif-srgb.jpg", form, "Exif ColorSpace sRGB",
        lambda: jpeg_flat(JPEG_CODES, segments=[exif_segment(exif_block(srgb_exif))]), light)
    add("icc-over-exif.jpg", form, "ICC profile over Exif ColorSpace",
        lambda: jpeg_flat(JPEG_CODES, segments=[exif_segment(exif_block(srgb_exif)), *jpeg_icc(adobe)]), wide,
        word="but ICC profile")
    rgb_blocks = np.tile(np.array(C8), (2, 2, 1))
    adobe_marker = lambda kind: (0xEE, b"Adobe\0\x64\0\0\0\0" + bytes([kind]))  # noqa: E731
    add("adobe-rgb.jpg", form, "Adobe APP14, RGB", lambda: jpeg(rgb_blocks, [adobe_marker(0)], [82, 71, 66]), SRGB8)
    # Adobe stores 255 - ink.
    cmyk = np.tile(np.array([200, 150, 120, 230]), (2, 2, 1))
    plain = srgb(np.array([200, 150, 120]) * 230 / 255 / 255)
    add("adobe-cmyk.jpg", form, "Adobe APP14, CMYK", lambda: jpeg(cmyk, [adobe_marker(0)]), plain, treatment=NAMED,
        word="CMYK", why="without a profile, ink is no color")
    ycck = np.tile(np.array([*ycc([55, 105, 135]), 230]), (2, 2, 1))
    add("adobe-ycck.jpg", form, "Adobe APP14, YCCK", lambda: jpeg(ycck, [adobe_marker(2)]), treatment=NAMED,
        word="CMYK|YCCK", why="without a profile, ink is no color")
    # XYZ = white * (1 - 0.3 c - 0.2 m - 0.1 y - 0.4 k): linear in each ink, so that any interpolation of 2 nodes is exact.
    paper = lambda c, m, y, k: ICC_D50 * (1 - 0.3 * c - 0.2 * m - 0.1 * y - 0.4 * k)  # noqa: E731
    ink = 1 - np.array([200, 150, 120, 230]) / 255
    add("icc-cmyk.jpg", form, "CMYK with an ICC profile",
        lambda: jpeg(cmyk, [adobe_marker(0), *jpeg_icc(icc_cmyk(paper))]), xyz_to_rec709(paper(*ink), ICC_D50),
        treatment=IMPOSSIBLE, word="CMYK")
    gray = np.tile(np.array([C8[0]]), (2, 2, 1))
    add("gray.jpg", form, "gray", lambda: jpeg(gray), [float(SRGB8[0])] * 3)
    add("icc-gray.jpg", form, "gray with an ICC profile",
        lambda: jpeg(gray, [JFIF, *jpeg_icc(icc_gray(icc_curve(1.8)))]), [F8[0] ** (461 / 256)] * 3)
    add("gain-map-xmp.jpg", form, "gain map (MPF, XMP hdrgm)", lambda: gain_map_jpeg("xmp"), light, treatment=NAMED, word="ain map")
    add("gain-map-iso.jpg", form, "gain map (MPF, ISO 21496-1)", lambda: gain_map_jpeg("iso"), light, treatment=NAMED, word="ain map")
    add("mpf.jpg", form, "MPF, a second picture", lambda: gain_map_jpeg("none"), light, treatment=NO_EFFECT, why="a preview is no choice for a user")


XMP = ('<?xpacket begin="" id="W5M0MpCehiHzreSzNTczkc9d"?><x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF '
       'xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description rdf:about="" {}/></rdf:RDF></x:xmpmeta>'
       '<?xpacket end="w"?>')


def gain_map_jpeg(kind):
    """A picture, and a map of one value behind it, as libultrahdr and phones write them."""
    hdrgm = 'xmlns:hdrgm="http://ns.adobe.com/hdr-gain-map/1.0/" hdrgm:Version="1.0"'
    gray = np.tile(np.array([128]), (2, 2, 1))
    name, iso = b"http://ns.adobe.com/xap/1.0/\0", b"urn:iso:std:iso:ts:21496:-1\0"
    second = [JFIF]
    if kind == "xmp":
        second.append((0xE1, name + XMP.format(hdrgm + ' hdrgm:GainMapMax="2" hdrgm:HDRCapacityMax="2"').encode()))
    elif kind == "iso":
        numbers = [0, 1, 2, 1, 0, 1, 2, 1, 1, 1, 1, 64, 1, 64]  # headrooms; minimum, maximum, gamma and offsets
        second.append((0xE2, iso + struct.pack(">HHB", 0, 0, 0x40) + struct.pack(">14I", *numbers)))
    gain = jpeg(gray, second)

    def primary(offset):
        segments = [JFIF]
        if kind == "xmp":
            container = ('xmlns:Container="http://ns.google.com/photos/1.0/container/" '
                         'xmlns:Item="http://ns.google.com/photos/1.0/container/item/"')
            segments.append((0xE1, name + XMP.format(f"{hdrgm} {container}").encode()))
        elif kind == "iso":
            segments.append((0xE2, iso + struct.pack(">HH", 0, 0)))
        size = len(jpeg_flat(JPEG_CODES, segments=[*segments, (0xE2, bytes(86))]))
        entries = struct.pack("<IIIHH", 0x030000, size, 0, 0, 0) + struct.pack("<IIIHH", 0, len(gain), offset, 0, 0)
        index = b"MPF\0II*\0\x08\0\0\0" + struct.pack("<H", 3)
        index += struct.pack("<HHI4s", 0xB000, 7, 4, b"0100") + struct.pack("<HHII", 0xB001, 4, 1, 2)
        index += struct.pack("<HHII", 0xB002, 7, 32, 50) + struct.pack("<I", 0) + entries
        data = jpeg_flat(JPEG_CODES, segments=[*segments, (0xE2, index)])
        return data, data.index(b"MPF\0") + 4

    data, mpf = primary(0)
    return primary(len(data) - mpf)[0] + gain


# --------------------------------------------------------------------------------------------------
# TIFF 6.0, TIFF/EP, the technical notes of Adobe, LogLuv of G. Ward Larson


def one_page(array, photometric=2, tags=None):
    return tiff([(array, photometric, tags or {})])


def packed_logluv(xyz):
    """LogLuv32 without compression has no bytes of its own; SGILOG runs: one value a row."""
    total = sum(xyz)
    x, y = xyz[0] / total, xyz[1] / total
    u, v = 4 * x / (-2 * x + 12 * y + 3), 9 * y / (-2 * x + 12 * y + 3)
    word = (int(256 * (np.log2(xyz[1]) + 64)) << 16) | (int(410 * u) << 8) | int(410 * v)
    return word


def logluv_value(word):
    luminance = 2 ** (((word >> 16) + 0.5) / 256 - 64)
    u, v = ((word >> 8 & 255) + 0.5) / 410, ((word & 255) + 0.5) / 410
    x, y = 9 * u / (6 * u - 16 * v + 12), 4 * v / (6 * u - 16 * v + 12)
    return np.array([x / y, 1, (1 - x - y) / y]) * luminance


def sgilog_tiff(words, photometric, width=8, height=8):
    """Compression 34676: the bytes of a row plane by plane, as runs."""
    size = 4 if photometric == 32845 else 2
    row = b"".join(bytes([128 + width - 2, (words >> (8 * i)) & 255]) for i in reversed(range(size)))
    data = row * height
    count = 3 if size == 4 else 1
    tags = {256: (LONG, width), 257: (LONG, height), 258: (SHORT, [16] * count), 259: (SHORT, 34676), 262: (SHORT, photometric),
            273: (LONG, 0), 277: (SHORT, count), 278: (LONG, height), 279: (LONG, len(data)), 284: (SHORT, 1),
            339: (SHORT, [2] * count)}
    tags[273] = (LONG, 8 + len(ifd(tags, 8)))
    return struct.pack("<2sHI", b"II", 42, 8) + ifd(tags, 8) + data


# tif_luv.c of libtiff: "CCIR-709 primaries", for XYZ of white E.
LIBTIFF_XYZ = np.array([[2.690, -1.276, -0.414], [-1.022, 1.978, 0.044], [0.061, -0.224, 1.163]])


def tiff_rows():
    form = "TIFF"
    floats = pixels((2.0, 1.0, 0.4), dtype=np.float32)
    add("untagged-8.tif", form, "none, 8 bits", lambda: one_page(RGB8.astype(np.uint8)), SRGB8, value=True)
    add("untagged-16.tif", form, "none, 16 bits", lambda: one_page(RGB16), SRGB16, value=True)
    add("untagged-float.tif", form, "none, float", lambda: one_page(floats), (2, 1, 0.4), value=True)
    add("untagged-half.tif", form, "none, half", lambda: one_page(pixels((2.0, 1.0, 0.5), dtype=np.float16)), (2, 1, 0.5))
    add("big-endian.tif", form, "big endian", lambda: tiff([(RGB16, 2, {})], ">"), SRGB16)
    add("planar.tif", form, "PlanarConfiguration 2", lambda: one_page(RGB16, tags={284: (SHORT, 2)}), SRGB16)
    icc = lambda profile: {34675: (UNDEFINED, profile)}  # noqa: E731
    add("icc-float.tif", form, "InterColorProfile, float",
        lambda: one_page(floats, tags=icc(icc_matrix("rec2020", icc_curve(1.0)))), to_rec709((2, 1, 0.4), "rec2020"), value=True)
    add("icc-prophoto.tif", form, "InterColorProfile, 16 bits",
        lambda: one_page(RGB16, tags=icc(icc_matrix("prophoto", icc_curve(1.8)))), to_rec709(F16 ** (461 / 256), "prophoto"),
        value=True)
    add("icc-8.tif", form, "InterColorProfile, 8 bits",
        lambda: one_page(RGB8.astype(np.uint8), tags=icc(icc_matrix("adobe_rgb", icc_curve(563 / 256)))),
        to_rec709(F8 ** (563 / 256), "adobe_rgb"))
    add("icc-gray.tif", form, "InterColorProfile, gray",
        lambda: one_page(pixels([C16[0]]), 1, icc(icc_gray(icc_curve(2.2)))), [F16[0] ** (563 / 256)] * 3)
    p3 = PRIMARIES["p3_d65"]
    ends = {318: (RATIONAL, list(p3[3])), 319: (RATIONAL, [v for xy in p3[:3] for v in xy])}
    add("primaries.tif", form, "WhitePoint, PrimaryChromaticities, float",
        lambda: one_page(floats, tags=ends), to_rec709((2, 1, 0.4), "p3_d65"))
    curve = [round(float((i / 65535) ** 1.8) * 65535) for i in range(65536)]
    add("transfer.tif", form, "TransferFunction, 16 bits", lambda: one_page(RGB16, tags={301: (SHORT, curve)}), F16 ** 1.8,
        treatment=NAMED, ignored=SRGB16, word="TransferFunction")
    signed = pixels((0.5, 0.4, 0.3), dtype=np.float32)
    add("int16.tif", form, "SampleFormat 2, 16 bits", lambda: one_page((signed * 32767).astype(np.int16)),
        srgb(np.floor(np.array(CODES) * 32767) / 32767))
    # PhotometricInterpretation
    add("white-is-zero.tif", form, "Photometric 0 (WhiteIsZero)", lambda: one_page(pixels([C8[0]], dtype=np.uint8), 0),
        [float(srgb(1 - F8[0]))] * 3, value=True)
    add("gray.tif", form, "Photometric 1 (BlackIsZero)", lambda: one_page(pixels([C16[0]]), 1), [float(SRGB16[0])] * 3)
    palette = [C16[0], *[0] * 255, C16[1], *[0] * 255, C16[2], *[0] * 255]
    add("palette.tif", form, "Photometric 3 (palette)",
        lambda: one_page(pixels([0], dtype=np.uint8), 3, {320: (SHORT, palette)}), SRGB16,
        tolerance=0.025, why="readers cut 16-bit palettes to 8 bits: a code of sRGB at 0.3 is 2.2 %")
    inks = np.array([200, 150, 120, 230])
    add("cmyk.tif", form, "Photometric 5 (CMYK)", lambda: one_page(pixels(255 - inks, dtype=np.uint8), 5, {332: (SHORT, 1)}),
        treatment=NAMED, word="CMYK", why="without a profile, ink is no color")
    paper = lambda c, m, y, k: ICC_D50 * (1 - 0.3 * c - 0.2 * m - 0.1 * y - 0.4 * k)  # noqa: E731
    add("icc-cmyk.tif", form, "CMYK with a profile",
        lambda: one_page(pixels(255 - inks, dtype=np.uint8), 5, {332: (SHORT, 1), **icc(icc_cmyk(paper))}),
        xyz_to_rec709(paper(*(1 - inks / 255)), ICC_D50), treatment=IMPOSSIBLE, word="CMYK")
    add("ycbcr.tif", form, "Photometric 6 (YCbCr)",
        lambda: one_page(pixels(ycc(JPEG_CODES), dtype=np.uint8), 6,
                         {530: (SHORT, [1, 1]), 532: (RATIONAL, [0, 255, 128, 255, 128, 255])}),
        srgb(J8))
    lab = (60, 20, -30)
    encoded = np.array([lab[0] / 100 * 255, lab[1], lab[2]])
    add("cielab-8.tif", form, "Photometric 8 (CIELab), 8 bits",
        lambda: one_page(pixels([round(encoded[0]), lab[1], lab[2] & 255], dtype=np.uint8), 8),
        xyz_to_rec709(lab_to_xyz((round(encoded[0]) / 2.55, *lab[1:]), ICC_D50), ICC_D50), treatment=IMPOSSIBLE, word="Lab",
        others=((xyz_to_rec709(lab_to_xyz((round(encoded[0]) / 2.55, *lab[1:]), white_xyz(PRIMARIES["rec709"][3]))),
                 "white D65, as libtiff assumes"),))
    add("cielab-16.tif", form, "Photometric 8 (CIELab), 16 bits",
        lambda: one_page(pixels([round(0.6 * 65535), 20 * 256, -30 * 256 & 65535]), 8),
        xyz_to_rec709(lab_to_xyz(lab, ICC_D50), ICC_D50), treatment=IMPOSSIBLE, word="Lab",
        others=((xyz_to_rec709(lab_to_xyz(lab, white_xyz(PRIMARIES["rec709"][3]))), "white D65, as libtiff assumes"),))
    add("icclab-8.tif", form, "Photometric 9 (ICCLab)",
        lambda: one_page(pixels([round(encoded[0]), lab[1] + 128, lab[2] + 128], dtype=np.uint8), 9),
        xyz_to_rec709(lab_to_xyz((round(encoded[0]) / 2.55, *lab[1:]), ICC_D50), ICC_D50), treatment=IMPOSSIBLE, word="Lab")
    rec709 = np.array([1.6, 0.8, 0.3])
    word = packed_logluv(rgb_to_xyz(PRIMARIES["rec709"]) @ rec709)
    add("logluv.tif", form, "Photometric 32845 (LogLuv)", lambda: sgilog_tiff(word, 32845), xyz_to_rec709(logluv_value(word)),
        treatment=IMPOSSIBLE, word="LogLuv|LOGLUV|Luv", value=True,
        others=((LIBTIFF_XYZ @ logluv_value(word), "libtiff's own matrix, white E"),
                (xyz_to_rec709(logluv_value(word), np.ones(3)), "adapted from white E")))
    level = int(256 * (np.log2(2.0) + 64))
    add("logl.tif", form, "Photometric 32844 (LogL)", lambda: sgilog_tiff(level, 32844), [2 ** ((level + 0.5) / 256 - 64)] * 3,
        treatment=IMPOSSIBLE, word="LogL|LOGL")
    # Alpha
    straight = pixels([*C8, 51], dtype=np.uint8)
    add("extra-straight.tif", form, "ExtraSamples 2 (straight)", lambda: one_page(straight, tags={338: (SHORT, 2)}), SRGB8, alpha=0.2)
    associated = pixels((0.4, 0.2, 0.1, 0.25), dtype=np.float32)
    add("extra-associated.tif", form, "ExtraSamples 1 (associated), float", lambda: one_page(associated, tags={338: (SHORT, 1)}),
        (1.6, 0.8, 0.4), alpha=0.25)
    add("extra-associated-8.tif", form, "ExtraSamples 1 (associated), 8 bits",
        lambda: one_page(pixels([100, 80, 60, 128], dtype=np.uint8), tags={338: (SHORT, 1)}),
        srgb(np.array([100, 80, 60]) / 128), alpha=128 / 255,
        others=((srgb(np.array([100, 80, 60]) / 255) / (128 / 255), "associated after decoding"),))
    add("extra-unspecified.tif", form, "ExtraSamples 0 (unspecified)", lambda: one_page(straight, tags={338: (SHORT, 0)}), SRGB8, options=("--alpha", "ignore"),
        why="the fourth channel has no stated meaning")
    for number in range(1, 9):
        add_corners(f"orientation-{number}.tif", form, f"Orientation {number}",
                    lambda n=number: one_page(stored(n), tags={274: (SHORT, n)}))
    add("pages.tif", form, "several pages", lambda: tiff([(RGB16, 2, {}), (RGB16, 2, {})]), SRGB16, treatment=NAMED,
        word="page|subimage")
    add("reduced.tif", form, "NewSubfileType 1 (reduced picture first)",
        lambda: tiff([(pixels([0, 0, 0]), 2, {254: (LONG, 1)}), (RGB16, 2, {254: (LONG, 0)})]), SRGB16, treatment=NAMED,
        ignored=(0, 0, 0), word="page|subimage|reduced")
    exif = {254: (LONG, 0), 274: (SHORT, 1)}
    add("subfile.tif", form, "NewSubfileType 0", lambda: one_page(RGB16, tags=exif), SRGB16)


# --------------------------------------------------------------------------------------------------
# OpenEXR


LIGHT = (2.0, 1.0, 0.5)


def layers(names, dtype=np.float32):
    """{"beauty.R": 2.0, ...}: a plane of each."""
    return {name: np.full((8, 8), value, dtype) for name, value in names.items()}


def colors(prefix, rgb):
    return {f"{prefix}{channel}": value for channel, value in zip("RGB", rgb)}


def exr_rows():
    form = "OpenEXR"
    add("plain.exr", form, "none", lambda: exr_rgb(LIGHT), LIGHT, value=True)
    add("half.exr", form, "half", lambda: exr_rgb(LIGHT, dtype=np.float16), LIGHT)
    add("uint.exr", form, "UINT channels", lambda: exr([{"planes": layers(colors("", (2, 1, 1)), np.uint32)}]),
        treatment=NAMED, word="uint|UINT|integer", why="integers are identifiers in OpenEXR")
    for space, value in (("rec2020", True), ("ap0", True), ("ap1", True), ("p3_d65", False), ("p3_dci", False), ("prophoto", False),
                         ("adobe_rgb", False)):
        add(f"chromaticities-{space.replace('_', '')}.exr", form, f"chromaticities, {space}",
            lambda s=space: exr_rgb(LIGHT, [exr_chromaticities(s)]), to_rec709(LIGHT, space), value=value)
    add("chromaticities-xyz.exr", form, "chromaticities, XYZ", lambda: exr_rgb(LIGHT, [exr_chromaticities("xyz")]),
        to_rec709(LIGHT, "xyz"), others=((xyz_to_rec709(LIGHT), "without adaptation of white E"),))
    add("chromaticities-709-d50.exr", form, "chromaticities, white D50",
        lambda: exr_rgb(LIGHT, [exr_chromaticities((*PRIMARIES["rec709"][:3], D50))]),
        to_rec709(LIGHT, (*PRIMARIES["rec709"][:3], D50)))
    add("chromaticities-zero.exr", form, "chromaticities, zeros", lambda: exr_rgb(LIGHT, [exr_chromaticities(((0, 0),) * 4)]), LIGHT,
        treatment=IMPOSSIBLE, word="chromaticities")
    container = exr_attribute("acesImageContainerFlag", "int", struct.pack("<i", 1))
    add("aces-container.exr", form, "acesImageContainerFlag", lambda: exr_rgb(LIGHT, [container]), to_rec709(LIGHT, "ap0"))
    neutral = exr_attribute("adoptedNeutral", "v2f", struct.pack("<2f", *D50))
    add("adopted-white.exr", form, "adoptedNeutral, the file's white",
        lambda: exr_rgb(LIGHT, [neutral, exr_chromaticities((*PRIMARIES["rec709"][:3], D50))]), to_rec709(LIGHT, (*PRIMARIES["rec709"][:3], D50)))
    add("adopted-neutral.exr", form, "adoptedNeutral", lambda: exr_rgb(LIGHT, [neutral]), LIGHT,
        treatment=NAMED, word="adoptedNeutral", others=((to_rec709(LIGHT, (*PRIMARIES["rec709"][:3], D50)), "the white that is shown as neutral"),))
    luminance = exr_attribute("whiteLuminance", "float", struct.pack("<f", 203.0))
    add("white-luminance.exr", form, "whiteLuminance 203", lambda: exr_rgb(LIGHT, [luminance]), LIGHT,
        treatment=NAMED, word="whiteLuminance: 1.0 is 203", others=((np.array(LIGHT) * 2.03, "1.0 is 203 cd/m2"),))
    for name, curve, space in (("lin_ap1_scene", linear, "ap1"), ("lin_rec2020_scene", linear, "rec2020"),
                               ("srgb_rec709_scene", srgb, "rec709"), ("g22_rec709_display", power(2.2), "rec709"),
                               ("g24_rec709_display", power(2.4), "rec709"), ("srgb_p3d65_display", srgb, "p3_d65"),
                               ("pq_rec2020_display", pq, "rec2020"), ("lin_adobergb_scene", linear, "adobe_rgb"),
                               ("hlg_rec2020_display", None, "rec2020")):
        code = np.array(CODES, np.float32).astype(float)
        light = hlg(code) if curve is None else curve(code)
        add(f"interop-{name.replace('_', '-')}.exr", form, f"colorInteropID {name}",
            lambda n=name: exr_rgb(CODES, [exr_string("colorInteropID", n)]), to_rec709(light, space),
            value=name in ("srgb_rec709_scene", "pq_rec2020_display"))
    add("interop-over-chromaticities.exr", form, "colorInteropID over chromaticities",
        lambda: exr_rgb(CODES, [exr_chromaticities("rec2020"), exr_string("colorInteropID", "srgb_rec709_display")]),
        srgb(np.array(CODES)), word="but colorInteropID decides")
    add("interop-unknown.exr", form, "colorInteropID, unknown name",
        lambda: exr_rgb(LIGHT, [exr_string("colorInteropID", "lin_nowhere_scene")]), LIGHT, treatment=IMPOSSIBLE,
        word="colorInteropID|lin_nowhere")
    add("interop-data.exr", form, "colorInteropID data", lambda: exr_rgb(LIGHT, [exr_string("colorInteropID", "data")]), LIGHT)
    add("oiio-colorspace.exr", form, "oiio:ColorSpace", lambda: exr_rgb(CODES, [exr_string("oiio:ColorSpace", "sRGB")]),
        srgb(np.array(CODES)))
    # Which part, which layer
    color = {f"beauty.{n}": v for n, v in zip("RGB", LIGHT)}
    ao = colors("AO.", (0.9, 0.9, 0.9))
    first = {"word": "layer is beauty|layer is ViewLayer.Combined|layer is rgba"}
    add("layer-beauty.exr", form, "layers: AO first", lambda: exr([{"planes": layers({**ao, **color})}]), LIGHT, **first)
    add("layer-blender.exr", form, "layers of Blender",
        lambda: exr([{"planes": layers({"ViewLayer.AO.R": 0.9, "ViewLayer.AO.G": 0.9, "ViewLayer.AO.B": 0.9,
                                        **{f"ViewLayer.Combined.{n}": v for n, v in zip("RGBA", (*LIGHT, 1.0))},
                                        "ViewLayer.Depth.Z": 5.0, "ViewLayer.Emit.R": 0.1, "ViewLayer.Emit.G": 0.1,
                                        "ViewLayer.Emit.B": 0.1})}]), LIGHT, **first)
    add("layer-crypto.exr", form, "layers: cryptomatte first",
        lambda: exr([{"planes": layers({**{f"CryptoObject00.{n}": 0.3 for n in "RGBA"}, **{f"rgba.{n}": v for n, v in
                                                                                         zip("RGB", LIGHT)}})}]), LIGHT, **first)
    add("layer-depth.exr", form, "channel Z before R, G, B", lambda: exr([{"planes": layers({"A": 1.0, **colors("", LIGHT), "Z": 9.0})}]),
        LIGHT)
    add("layer-named.exr", form, "--layer NAME", lambda: exr([{"planes": layers({**colors("", (0.1, 0.1, 0.1)), **color})}]), LIGHT,
        options=("--layer", "beauty"))
    add("layer-lower-case.exr", form, "channels r, g, b", lambda: exr([{"planes": layers({"r": 2.0, "g": 1.0, "b": 0.5})}]), LIGHT)
    add("gray.exr", form, "channel Y", lambda: exr([{"planes": layers({"Y": 0.7})}]), (0.7, 0.7, 0.7))
    add("luminance-chroma.exr", form, "Y, RY, BY",
        lambda: exr([{"planes": {"Y": np.full((8, 8), 1.0, np.float16), "RY": (np.full((4, 4), 0.6, np.float16), 2),
                                 "BY": (np.full((4, 4), -0.4, np.float16), 2)}}]),
        rgb=luminance_chroma(1.0, 0.6, -0.4))
    parts = lambda *names: exr([{"planes": layers(colors("", LIGHT if name == "beauty" else (0.9, 0.9, 0.9))), "name": name}  # noqa: E731
                                for name in names])
    add("parts.exr", form, "parts: depth first", lambda: parts("depth", "beauty"), LIGHT,
        word="subimage is 1 (beauty)")
    add("parts-named.exr", form, "--subimage NAME", lambda: parts("depth", "beauty"), LIGHT, options=("--subimage", "beauty"))
    add("parts-number.exr", form, "--subimage N", lambda: parts("depth", "beauty"), LIGHT, options=("--subimage", "1"))
    stereo = exr_attribute("multiView", "stringvector", b"".join(struct.pack("<i", len(v)) + v for v in (b"left", b"right")))
    add("views.exr", form, "multiView", lambda: exr([{"planes": layers({**colors("", LIGHT), **colors("right.", (0.1, 0.1, 0.1))}),
                                                      "attributes": [stereo]}]), LIGHT, word="layer is RGB, of")
    view = lambda name: [exr_string("view", name)]  # noqa: E731
    add("view-parts.exr", form, "parts with view",
        lambda: exr([{"planes": layers(colors("", LIGHT)), "name": "rgba.left", "attributes": view("left")},
                     {"planes": layers(colors("", (0.1, 0.1, 0.1))), "name": "rgba.right", "attributes": view("right")}]),
        LIGHT, word="subimage is 0 (rgba.left)")
    add("deep.exr", form, "deep scan lines", lambda: deep_exr(), treatment=IMPOSSIBLE, word="deep")
    # Windows and shape
    add("window-crop.exr", form, "dataWindow within displayWindow", lambda: exr([{"planes": layers(colors("", LIGHT)),
                                                                                 "window": (2, 2, 9, 9)}], display=(0, 0, 15, 15)), LIGHT,
        points=(((4, 4), LIGHT),))
    add("window-outside.exr", form, "dataWindow outside displayWindow",
        lambda: exr([{"planes": layers(colors("", LIGHT)), "window": (100, 100, 107, 107)}], display=(0, 0, 15, 15)), LIGHT)
    add("window-negative.exr", form, "dataWindow, negative origin",
        lambda: exr([{"planes": layers(colors("", LIGHT)), "window": (-4, -4, 3, 3)}], display=(0, 0, 3, 3)), LIGHT)
    add("pixel-aspect.exr", form, "pixelAspectRatio 2", lambda: exr([{"planes": layers(colors("", LIGHT)), "pixel_aspect": 2.0}]), LIGHT)
    add("screen-window.exr", form, "screenWindowCenter, screenWindowWidth",
        lambda: exr([{"planes": layers(colors("", LIGHT)), "screen": ((0.5, 0.25), 2.0)}]), LIGHT,
        treatment=NO_EFFECT)
    add("envmap.exr", form, "envmap", lambda: exr_rgb(LIGHT, [exr_attribute("envmap", "envmap", b"\0")]), LIGHT,
        treatment=NO_EFFECT)
    add("exposure-time.exr", form, "expTime, aperture, isoSpeed",
        lambda: exr_rgb(LIGHT, [exr_attribute(n, "float", struct.pack("<f", 0.5)) for n in ("expTime", "aperture", "isoSpeed")]), LIGHT,
        treatment=NO_EFFECT)
    add("wrap-modes.exr", form, "wrapmodes, capDate, owner, comments",
        lambda: exr_rgb(LIGHT, [exr_string(n, "x") for n in ("wrapmodes", "capDate", "owner", "comments")]), LIGHT,
        treatment=NO_EFFECT)
    orientation = exr_attribute("Orientation", "int", struct.pack("<i", 6))
    add("orientation.exr", form, "Orientation (an attribute of OpenImageIO)", lambda: exr_rgb(LIGHT, [orientation]), LIGHT)
    alpha = tuple(v * 0.25 for v in LIGHT)
    add("alpha.exr", form, "channel A, associated", lambda: exr_rgb(alpha, alpha=0.25), LIGHT, alpha=0.25)
    profile = icc_matrix("p3_d65", icc_curve(1.0))
    add("icc.exr", form, "ICCProfile (an attribute of OpenImageIO)",
        lambda: exr_rgb(LIGHT, [exr_attribute("ICCProfile", "bytes", struct.pack("<I", 0) + profile)]), to_rec709(LIGHT, "p3_d65"), others=((LIGHT, "no standard has it"),))


def luminance_chroma(y, ry, by):
    """The technical introduction of OpenEXR, with the luminance weights of its default primaries (Rec.709)."""
    weights = rgb_to_xyz(PRIMARIES["rec709"])[1]
    red, blue = (1 + float(np.float16(ry))) * y, (1 + float(np.float16(by))) * y
    return red, (y - weights[0] * red - weights[2] * blue) / weights[1], blue


def deep_exr():
    """One sample a pixel, not compressed."""
    width, height = 4, 4
    head = struct.pack("<II", 20000630, 2 | 0x800)
    channels = {name: (np.float32, 1, 1) for name in ("A", "B", "G", "R", "Z")}
    body = exr_header(channels, (0, 0, 3, 3), (0, 0, 3, 3), [exr_string("name", "deep"), exr_string("type", "deepscanline"),
                                                             exr_attribute("version", "int", struct.pack("<i", 1)),
                                                             exr_attribute("maxSamplesPerPixel", "int", struct.pack("<i", 1)),
                                                             exr_attribute("chunkCount", "int", struct.pack("<i", height))])
    counts = struct.pack("<4i", 1, 2, 3, 4)
    samples = b"".join(np.full(width, v, np.float32).tobytes() for v in (1, 0.5, 1, 2, 5))
    line = len(struct.pack("<iQQQ", 0, 0, 0, 0)) + len(counts) + len(samples)
    at = len(head) + len(body) + 8 * height
    table = b"".join(struct.pack("<Q", at + line * y) for y in range(height))
    data = b"".join(struct.pack("<iQQQ", y, len(counts), len(samples), len(samples)) + counts + samples for y in range(height))
    return head + body + table + data


# --------------------------------------------------------------------------------------------------
# Radiance (filefmts.pdf)


def radiance_rows():
    form = "Radiance"
    flat = rgbe(LIGHT)
    rows = [[flat] * 16] * 8
    value = rgbe_value(flat)
    plain = lambda *header, **more: (lambda: radiance(rows, header, **more))  # noqa: E731
    add("plain.hdr", form, "none", plain(), value, value=True)
    line = lambda primaries: "PRIMARIES= " + " ".join(f"{v:.4f}" for xy in primaries for v in xy)  # noqa: E731
    for space in ("rec2020", "p3_d65", "ap0"):
        add(f"primaries-{space.replace('_', '')}.hdr", form, f"PRIMARIES, {space}", plain(line(PRIMARIES[space])),
            to_rec709(value, space), value=space != "p3_d65")
    add("primaries-radiance.hdr", form, "PRIMARIES, Radiance's own",
        plain("PRIMARIES= 0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333"),
        value, others=((to_rec709(value, "radiance"), "the numbers, adapted from white E"),),
        why="libvips writes this line for every file")
    add("primaries-vips.hdr", form, "PRIMARIES, as libvips rounds them",
        plain("PRIMARIES=0.640000 0.330000 0.290000 0.600000 0.150000 0.060000 0.333300 0.333300"), value,
        others=((to_rec709(value, "radiance"), "the numbers, adapted from white E"),))
    add("primaries-zero.hdr", form, "PRIMARIES, eight zeros", plain("PRIMARIES=0 0 0 0 0 0 0 0"), value,
        why="ImageMagick writes them; they mean nothing")
    add("primaries-seven.hdr", form, "PRIMARIES, seven numbers", plain("PRIMARIES=0.708 0.292 0.170 0.797 0.131 0.046 0.3127"), value,
        treatment=NAMED, word="PRIMARIES")
    divided = {"treatment": NAMED, "ignored": value, "word": "EXPOSURE", "why": "Radiance and pfstools divide, most readers do not"}
    add("exposure.hdr", form, "EXPOSURE", plain("EXPOSURE=2"), value / 2, **divided, value=True)
    add("exposure-twice.hdr", form, "EXPOSURE, two lines", plain("EXPOSURE=2", "EXPOSURE= 4.0"), value / 8, **divided)
    add("exposure-one.hdr", form, "EXPOSURE 1", plain("EXPOSURE=1.0"), value)
    add("exposure-zero.hdr", form, "EXPOSURE 0", plain("EXPOSURE=0"), value, treatment=NAMED, word="EXPOSURE")
    add("colorcorr.hdr", form, "COLORCORR", plain("COLORCORR= 2 1 0.5"), value / (2, 1, 0.5), treatment=NAMED, ignored=value, word="COLORCORR")
    add("pixaspect.hdr", form, "PIXASPECT", plain("PIXASPECT=0.5"), value)
    add("view.hdr", form, "VIEW, SOFTWARE, comments", plain("VIEW= -vtv -vp 0 0 0 -vd 0 1 0", "SOFTWARE=x", "# a comment"), value)
    add("gamma.hdr", form, "GAMMA", plain("GAMMA=1"), value)
    # A color inside Rec.709, whatever white is meant.
    xyz = rgbe(rgb_to_xyz(PRIMARIES["rec709"]) @ np.array([2.0, 1.0, 0.6]))
    add("xyze.hdr", form, "FORMAT=32-bit_rle_xyze", lambda: radiance([[xyz] * 16] * 8, kind="xyze"),
        xyz_to_rec709(rgbe_value(xyz), np.ones(3)), value=True,  # the white of Radiance is E
        others=((xyz_to_rec709(rgbe_value(xyz)), "without adaptation"),
                (np.linalg.inv(rgb_to_xyz(PRIMARIES["radiance"])) @ rgbe_value(xyz), "Radiance's own primaries, white E")))
    add("old-rle.hdr", form, "old runs", plain(old_rle=True), value, treatment=IMPOSSIBLE, word="scanline|run|read")
    add("rgbe-magic.hdr", form, "#?RGBE", lambda: radiance(rows).replace(b"#?RADIANCE", b"#?RGBE"), value)
    corner_colors = {name: rgbe(color) for name, color in zip(CORNERS, ((2, 0.5, 0.25), (0.25, 1, 0.5), (0.5, 0.25, 4), (1, 1, 0.25)))}
    upright = [[corner_colors[f"{'top' if y < 8 else 'bottom'} {'left' if x < 16 else 'right'}"] for x in range(32)] for y in range(16)]
    points = tuple(((x, y), tuple(rgbe_value(upright[y][x]))) for x in (1, 30) for y in (1, 14))
    for order in ("-Y +X", "+Y +X", "-Y -X", "+Y -X", "+X -Y", "-X -Y", "+X +Y", "-X +Y"):
        picture = np.empty((16, 32), object)
        for y in range(16):
            for x in range(32):
                picture[y, x] = upright[y][x]
        if "-X" in order:
            picture = picture[:, ::-1]
        if "+Y" in order:
            picture = picture[::-1]
        if order[1] == "X":
            picture = picture.T
        first, second = order.split()
        text = f"{first} {picture.shape[0]} {second} {picture.shape[1]}"
        name = order.replace("-", "m").replace("+", "p").replace(" ", "").lower()
        add_corners(f"axes-{name}.hdr", form, f"axes {order}", lambda p=picture, t=text: radiance(p.tolist(), orientation=t), points=points)


# --------------------------------------------------------------------------------------------------
# PFM, PNM, PAM


def netpbm_rows():
    form = "PFM"
    floats = pixels(LIGHT, dtype=np.float32)
    add("little.pfm", form, "little endian", lambda: pfm(floats), LIGHT, value=True)
    add("big.pfm", form, "big endian", lambda: pfm(floats, 1.0), LIGHT)
    add("gray.pfm", form, "gray", lambda: pfm(floats[:, :, :1]), (2.0, 2.0, 2.0))
    add("scale.pfm", form, "scale factor 4", lambda: pfm(floats, -4.0), np.array(LIGHT) * 4,
        word="scale factor", others=((LIGHT, "no factor"), (np.array(LIGHT) / 4, "samples divided by it")))
    ramp = floats.copy()
    ramp[0] = (0.5, 0.25, 1)
    add("rows.pfm", form, "rows from the bottom", lambda: pfm(ramp), points=(((4, 0), (0.5, 0.25, 1)), ((4, 7), LIGHT)))
    form = "PNM"
    add("p6.ppm", form, "P6, 8 bits", lambda: pnm(6, RGB8), SRGB8, value=True)
    add("p6-16.ppm", form, "P6, 16 bits", lambda: pnm(6, RGB16, 65535), SRGB16,
        others=((bt709_camera(F16), "the curve of BT.709, as Netpbm's manual has it"),))
    add("p6-maxval.ppm", form, "P6, largest value 200", lambda: pnm(6, pixels((100, 80, 60)), 200), srgb(np.array([100, 80, 60]) / 200),
        tolerance=0.025, why="readers scale to 8 bits: half a code of 76 is 1.5 % of its light")
    add("p6-1023.ppm", form, "P6, largest value 1023", lambda: pnm(6, pixels((500, 400, 300)), 1023), srgb(np.array([500, 400, 300]) / 1023))
    add("p3.ppm", form, "P3", lambda: pnm(3, RGB8, text=True), SRGB8)
    add("p5.pgm", form, "P5", lambda: pnm(5, pixels([C8[0]])), [float(SRGB8[0])] * 3)
    add("p2.pgm", form, "P2", lambda: pnm(2, pixels([C8[0]]), text=True), [float(SRGB8[0])] * 3)
    add("p4.pbm", form, "P4 (1 is black)", lambda: pnm(4, pixels([0])), (1, 1, 1))
    add("p1.pbm", form, "P1", lambda: pnm(1, pixels([0]), text=True), (1, 1, 1))
    add("pam.pam", form, "P7 (PAM)", lambda: pam(RGB8), SRGB8, treatment=IMPOSSIBLE, word="pam|PAM|format|read")


# --------------------------------------------------------------------------------------------------
# DPX and Cineon


def cineon_light(code):
    """Kodak, "Conversion of 10-bit Log Film Data": 0.002 densities a code, gamma 0.6, black 95, white 685."""
    black = 10 ** ((95 - 685) * 0.002 / 0.6)
    return (10 ** ((np.asarray(code, float) - 685) * 0.002 / 0.6) - black) / (1 - black)


def dpx_rows():
    form = "DPX"
    code = np.array(codes(CODES, 10))
    ten = pixels(code)
    f10 = code / 1023
    log_others = ((10 ** ((code - 685) * 0.002 / 0.6), "without the black of code 95"),)
    add("density.dpx", form, "transfer 1 (printing density)", lambda: dpx(ten, transfer=1, colorimetric=1), cineon_light(code),
        others=log_others, value=True)
    add("density-levels.dpx", form, "printing density, reference levels",
        lambda: dpx(ten, transfer=1, colorimetric=1, reference=(95, 0.0, 685, 2.046)), cineon_light(code), others=log_others)
    add("log.dpx", form, "transfer 3 (logarithmic)", lambda: dpx(ten, transfer=3, colorimetric=3), cineon_light(code), others=log_others)
    add("linear.dpx", form, "transfer 2 (linear)", lambda: dpx(ten, transfer=2), f10, value=True)
    add("linear-16.dpx", form, "transfer 2 (linear), 16 bits", lambda: dpx(RGB16, 16, transfer=2), F16)
    for number, name, space in ((4, "unspecified video", 1), (5, "SMPTE 274M", 1), (6, "ITU-R 709", 1), (7, "ITU-R 601, 625 lines", 5),
                                (8, "ITU-R 601, 525 lines", 6), (9, "NTSC", 6), (10, "PAL", 5)):
        add(f"video-{number}.dpx", form, f"transfer {number} ({name})", lambda n=number: dpx(ten, transfer=n, colorimetric=n),
            h273(f10, space, 1), others=h273_others(f10, space, 1), value=number == 6)
    undefined = ((cineon_light(code), "the config's rule for .dpx: Cineon"), (srgb(f10), "sRGB"), (10 ** ((code - 685) * 0.002 / 0.6), "Cineon"))
    add("undefined.dpx", form, "transfer 255 (undefined)", lambda: dpx(ten, transfer=255, colorimetric=255), cineon_light(code), others=undefined)
    add("user.dpx", form, "transfer 0 (user defined)", lambda: dpx(ten, transfer=0), cineon_light(code), others=undefined)
    add("gamma.dpx", form, "transfer 0, gamma 2.2", lambda: dpx(ten, transfer=0, gamma=2.2), power(2.2)(f10),
        others=undefined)
    add("z-depth.dpx", form, "transfer 11 (depth)", lambda: dpx(ten, transfer=11), treatment=IMPOSSIBLE, word="depth|ransfer")
    add("linear-levels.dpx", form, "linear, reference levels 64, 940", lambda: dpx(ten, transfer=2, reference=(64, 0.0, 940, 1.0)),
        (code - 64) / (940 - 64), treatment=NAMED, ignored=f10, word="reference|level")
    add("packing-b.dpx", form, "10 bits, method B", lambda: dpx(ten, transfer=2, packing="B"), f10)
    add("rgb-8.dpx", form, "8 bits", lambda: dpx(RGB8, 8, transfer=2), F8)
    points = corner_points(lambda color: np.array(color) / 255)
    # ST 268-1, table 2: the first direction is that of a line's pixels.
    for number, exif in ((0, 1), (1, 2), (2, 4), (3, 3), (4, 5), (5, 6), (6, 8), (7, 7)):
        add_corners(f"orientation-{number}.dpx", form, f"orientation {number}",
                    lambda n=number, e=exif: dpx(stored(e), 8, transfer=2, orientation=n), points=points,
                    treatment=IMPOSSIBLE if number > 3 else USED, word="columns" if number > 3 else "", why="OpenImageIO mixes up rows and columns" if number > 3 else "")
    add("plate.cin", "Cineon", "printing density", lambda: cineon(ten), cineon_light(code), others=log_others)


# --------------------------------------------------------------------------------------------------
# TGA, BMP, SGI, IFF, RLA, ICO, DDS, GIF, FITS, PSD


def small_rows():
    eight = RGB8.astype(np.uint8)
    add("plain.tga", "TGA", "none", lambda: tga(eight), SRGB8, value=True)
    add("gamma.tga", "TGA", "gamma 1.8 of the extension area", lambda: tga(eight, gamma=(18, 10)), power(1.8)(F8))
    add("gamma-1.tga", "TGA", "gamma 1.0 of the extension area", lambda: tga(eight, gamma=(1, 1)), SRGB8,
        others=((F8, "linear; but many writers put 1.0 here and mean nothing"),))
    add("gamma-0.tga", "TGA", "gamma 0/0 (not used)", lambda: tga(eight, gamma=(0, 0)), SRGB8)
    four = pixels([*C8, 51])
    for kind, name, color, alpha in ((0, "no alpha", SRGB8, None), (1, "undefined, ignore", SRGB8, None), (2, "undefined, keep", SRGB8, None),
                                     (3, "straight", SRGB8, 0.2)):
        add(f"attributes-{kind}.tga", "TGA", f"attributes type {kind} ({name})", lambda k=kind: tga(four, attributes=k), color, alpha=alpha)
    premultiplied = pixels([100, 80, 60, 128])
    add("attributes-4.tga", "TGA", "attributes type 4 (premultiplied)", lambda: tga(premultiplied, attributes=4),
        srgb(np.array([100, 80, 60]) / 128), alpha=128 / 255,
        others=((srgb(np.array([100, 80, 60]) / 255) / (128 / 255), "associated after decoding"),))
    for descriptor, exif in ((0x20, 1), (0x30, 2), (0x10, 3), (0x00, 4)):
        add_corners(f"origin-{descriptor:02x}.tga", "TGA", f"descriptor 0x{descriptor:02x}",
                    lambda d=descriptor, e=exif: tga(stored(e), descriptor=d))
    add("gray.tga", "TGA", "gray", lambda: tga(eight[:, :, :1], kind=3), [float(SRGB8[0])] * 3)

    add("v3.bmp", "BMP", "none", lambda: bmp(eight), SRGB8)
    add("v5-srgb.bmp", "BMP", "V5, LCS_sRGB", lambda: bmp(eight, 5, space=0x73524742), SRGB8)
    add("v5-windows.bmp", "BMP", "V5, LCS_WINDOWS_COLOR_SPACE", lambda: bmp(eight, 5, space=0x57696E20), SRGB8)
    add("v4-calibrated.bmp", "BMP", "V4, end points and gamma", lambda: bmp(eight, 4, "p3_d65", (2.2, 2.2, 2.2), space=0),
        to_rec709(power(2.2)(F8), "p3_d65"))
    add("v5-icc.bmp", "BMP", "V5, embedded profile", lambda: bmp(eight, 5, profile=icc_matrix("p3_d65", icc_curve(2.2)), space=0x4D424544),
        to_rec709(power(563 / 256)(F8), "p3_d65"))
    add("v5-linked.bmp", "BMP", "V5, linked profile", lambda: bmp(eight, 5, profile=b"p3.icc\0", space=0x4C494E4B), SRGB8,
        treatment=NAMED, word="profile")
    add_corners("top-down.bmp", "BMP", "negative height", lambda: bmp(corner_picture(), down=True))

    add("plain.sgi", "SGI", "none", lambda: sgi(RGB8), SRGB8)
    add("two-bytes.sgi", "SGI", "16 bits", lambda: sgi(RGB16, 2), SRGB16)
    add_corners("rows.sgi", "SGI", "rows from the bottom", lambda: sgi(corner_picture()))
    big = np.tile(eight[:1, :1], (16, 16, 1))
    add("plain.iff", "IFF", "none", lambda: with_oiio("iff", big), SRGB8)
    add("plain.rla", "RLA", "none", lambda: with_oiio("rla", big), SRGB8)
    add("gamma.rla", "RLA", "gamma 2.2", lambda: rla_with(big, gamma="2.2"), power(2.2)(F8))
    add("gamma-1.rla", "RLA", "gamma 1.0", lambda: rla_with(big, gamma="1.0"), F8,
        others=((SRGB8, "writers put 1.0 here and mean nothing"),))
    add("chroma.rla", "RLA", "chroma fields", lambda: rla_with(big, chroma=("0.680 0.320", "0.265 0.690", "0.150 0.060", "0.3127 0.3290")),
        to_rec709(SRGB8, "p3_d65"))
    add("plain.ico", "ICO", "one PNG", lambda: ico([(8, 8, png(pixels([*C8, 255]), 8))]), SRGB8)
    add("several.ico", "ICO", "several pictures", lambda: ico([(8, 8, png(pixels([*C8, 255]), 8)), (4, 4, png(pixels([0, 0, 0, 255], 4, 4), 8))]),
        SRGB8, treatment=NAMED, word="subimage|picture|page")
    rgba = pixels([*C8, 255])
    add("plain.dds", "DDS", "no DX10 header", lambda: dds(rgba), SRGB8, others=((F8, "linear, as the format has no field"),))
    add("unorm.dds", "DDS", "DXGI 28 (R8G8B8A8_UNORM)", lambda: dds(rgba, 28), SRGB8, others=((F8, "linear: UNORM"),),
        treatment=IMPOSSIBLE, word="DXGI|format|upport|read")
    add("srgb.dds", "DDS", "DXGI 29 (R8G8B8A8_UNORM_SRGB)", lambda: dds(rgba, 29), SRGB8, treatment=IMPOSSIBLE, word="DXGI|format|upport|read")
    # One block of BC6H: direct mode of 10 bits, both end points equal; code 512 of an unsigned half is 0.4849 or so.
    add("bc6h.dds", "DDS", "DXGI 95 (BC6H_UF16)", lambda: dds(np.zeros((4, 4, 4)), 95, bc6h_block((480, 440, 400))),
        bc6h_value((480, 440, 400)))
    add("plain.gif", "GIF", "none", lambda: gif([1], [(0, 0, 0), C8]), SRGB8)
    add("animated.gif", "GIF", "two frames", lambda: gif([1, 0], [(0, 0, 0), C8]), SRGB8, treatment=NAMED, word="frame|animat")
    add("float.fits", "FITS", "BITPIX -32", lambda: fits(pixels(LIGHT, dtype=np.float32)), LIGHT, treatment=IMPOSSIBLE,
        word="subimage|plane|layer|FITS", others=(((2.0,) * 3, "planes are pictures of their own"),))
    add("gray.fits", "FITS", "BITPIX -32, one plane", lambda: fits(pixels([0.7], dtype=np.float32)), (0.7, 0.7, 0.7))
    add("scaled.fits", "FITS", "BSCALE, BZERO", lambda: fits(pixels([0.7], dtype=np.float32), [("BSCALE", 2.0), ("BZERO", 1.0)]),
        [float(np.float32(0.7)) * 2 + 1] * 3, treatment=NAMED, ignored=(0.7,) * 3, word="BSCALE|BZERO")

    add("plain.psd", "PSD", "none", lambda: psd(RGB8), SRGB8)
    add("two-bytes.psd", "PSD", "16 bits", lambda: psd(RGB16, bits=16), SRGB16)
    add("float.psd", "PSD", "32 bits", lambda: psd(pixels(LIGHT, dtype=np.float32), bits=32), LIGHT, value=True)
    add("icc.psd", "PSD", "resource 1039 (ICC)", lambda: psd(RGB8, resources=[(1039, icc_matrix("adobe_rgb", icc_curve(563 / 256)))]),
        to_rec709(F8 ** (563 / 256), "adobe_rgb"), value=True)
    add("icc-float.psd", "PSD", "resource 1039 (ICC), 32 bits",
        lambda: psd(pixels(LIGHT, dtype=np.float32), bits=32, resources=[(1039, icc_matrix("rec2020", icc_curve(1.0)))]), to_rec709(LIGHT, "rec2020"))
    add("cmyk.psd", "PSD", "mode 4 (CMYK)", lambda: psd(pixels([200, 150, 120, 230]), 4), treatment=NAMED, word="CMYK")
    add("lab.psd", "PSD", "mode 9 (Lab)", lambda: psd(pixels([153, 148, 98]), 9),
        xyz_to_rec709(lab_to_xyz((60, 20, -30), ICC_D50), ICC_D50), treatment=IMPOSSIBLE, word="Lab|mode|color")
    add("gray.psd", "PSD", "mode 1 (gray)", lambda: psd(pixels([C8[0]]), 1), [float(SRGB8[0])] * 3)


def rla_with(array, gamma=None, chroma=None):
    """Header of RLA: gamma at 28 (16 bytes), the four chroma fields at 44 (24 bytes each)."""
    out = bytearray(with_oiio("rla", array))
    if gamma:
        out[28:44] = gamma.encode().ljust(16, b"\0")
    for i, text in enumerate(chroma or ()):
        out[44 + 24 * i:68 + 24 * i] = text.encode().ljust(24, b"\0")
    return bytes(out)


def bc6h_block(code):
    """Mode 11: bits 00011, then the end points of 10 bits, then indices 0."""
    bits = 0b00011
    for n, value in enumerate([*code, *code]):
        bits |= value << (5 + 10 * n)
    return bits.to_bytes(16, "little")


def bc6h_value(code):
    """The specification: unquantized to 16 bits, times 31/64, as a half."""
    full = np.array([((v << 16) + 0x8000) >> 10 for v in code])
    return tuple(float(v) for v in (full * 31 // 64).astype(np.uint16).view(np.float16))


# --------------------------------------------------------------------------------------------------
# WebP, JPEG 2000, HEIF, AVIF


def vp8l(array):
    """Lossless WebP of at most two values a channel (RGB or RGBA), each pixel coded by itself."""
    height, width, channels = array.shape
    bits = ""

    def put(value, count):
        nonlocal bits
        bits += f"{value:0{count}b}"[::-1] if count else ""

    put(0x2F, 8), put(width - 1, 14), put(height - 1, 14), put(int(channels == 4), 1), put(0, 3)
    put(0, 1), put(0, 1), put(0, 1)  # no transform, no color cache, one group of codes
    planes = [array[:, :, i] for i in (1, 0, 2)] + [array[:, :, 3] if channels == 4 else np.full((height, width), 255)]
    symbols = [sorted(set(int(v) for v in plane.ravel())) for plane in planes]
    for values in [*symbols, [0]]:  # green, red, blue, alpha, distance
        put(1, 1), put(len(values) - 1, 1), put(1, 1)
        for value in values:
            put(value, 8)
    for y in range(height):
        for x in range(width):
            for plane, values in zip(planes, symbols):
                put(values.index(int(plane[y, x])), len(values) - 1)
    bits += "0" * (-len(bits) % 8)
    return riff([(b"VP8L", bytes(int(bits[i:i + 8][::-1], 2) for i in range(0, len(bits), 8)))])


def avif(yuv, primaries, transfer, matrix, full, bits=10):
    """AV1 without loss by ffmpeg, 4:4:4; the numbers of H.273 in the stream and in the box."""
    size = 64
    kind = "<u2" if bits > 8 else "u1"
    data = b"".join(np.full((size, size), value, kind).tobytes() for value in yuv)
    pix = "yuv444p10le" if bits == 10 else "yuv444p"
    # ffmpeg takes the numbers of H.273 for these options.
    command = ["ffmpeg", "-v", "error", "-f", "rawvideo", "-pix_fmt", pix, "-s", f"{size}x{size}", "-i", "in.yuv", "-frames:v", "1",
               "-c:v", "libaom-av1", "-still-picture", "1", "-aom-params", "lossless=1", "-color_primaries", str(primaries),
               "-color_trc", str(transfer), "-colorspace", str(matrix), "-color_range", "2" if full else "1", "out.avif"]
    return run_encoder(command, data, "in.yuv", "out.avif")


KR_KB = {1: (0.2126, 0.0722), 6: (0.299, 0.114), 9: (0.2627, 0.0593)}


def yuv_to_rgb(yuv, matrix, full, bits=10):
    """H.273: codes -> 0..1 RGB."""
    y, u, v = (float(value) for value in yuv)
    if full:
        y, u, v = y / (2**bits - 1), (u - 2 ** (bits - 1)) / (2**bits - 1), (v - 2 ** (bits - 1)) / (2**bits - 1)
    else:
        scale = 2 ** (bits - 8)
        y, u, v = (y / scale - 16) / 219, (u / scale - 128) / 224, (v / scale - 128) / 224
    kr, kb = KR_KB[matrix]
    r, b = y + 2 * (1 - kr) * v, y + 2 * (1 - kb) * u
    return np.array([r, (y - kr * r - kb * b) / (1 - kr - kb), b])


def modern_rows():
    eight = RGB8.astype(np.uint8)
    form = "WebP"
    p3 = icc_matrix("p3_d65", icc_curve(2.2))
    add("plain.webp", form, "none", lambda: vp8l(eight), SRGB8)
    add("icc.webp", form, "ICCP", lambda: webp_with(vp8l(eight), 8, 8, profile=p3), to_rec709(power(563 / 256)(F8), "p3_d65"), value=True)
    for number in (3, 6, 8):
        add_corners(f"exif-{number}.webp", form, f"EXIF orientation {number}",
                    lambda n=number: webp_with(vp8l(stored(n)), *stored(n).shape[1::-1], exif=exif_block({274: (SHORT, n)})))
    add("animated.webp", form, "ANIM, two frames", lambda: webp_with(vp8l(eight), 8, 8, animated=True), SRGB8, treatment=NAMED, word="frame|animat")
    add("alpha.webp", form, "alpha", lambda: vp8l(pixels([*C8, 51])), SRGB8, alpha=0.2, treatment=NAMED, word="alpha",
        tolerance=0.08, why="OpenImageIO 2.4 multiplies by alpha 51 in 8 bits: half a code of 15 is 8 % of its light")

    form = "JPEG 2000"
    big = np.tile(eight[:1, :1], (64, 64, 1))
    # J2K streams of OpenJPEG are without loss only for some settings: a flat picture keeps its color.
    jp2 = lambda box: (lambda: replace_box(with_oiio("jp2", big), b"colr", box))  # noqa: E731
    near = {"tolerance": 0.04, "why": "OpenImageIO compresses with loss: one code"}
    add("srgb.jp2", form, "colr, enumerated 16 (sRGB)", jp2(struct.pack(">BBBI", 1, 0, 0, 16)), SRGB8, **near)
    add("sycc.jp2", form, "colr, enumerated 18 (sYCC)", jp2(struct.pack(">BBBI", 1, 0, 0, 18)), srgb(np.array(rgb_of(C8)) / 255), tolerance=0.06, why=near["why"])
    add("icc.jp2", form, "colr, ICC profile", jp2(struct.pack(">BBB", 2, 0, 0) + p3), to_rec709(power(563 / 256)(F8), "p3_d65"), **near)

    form = "AVIF"
    full_pq = [512, 480, 540]
    for name, yuv, numbers, full, tag, is_value in (("pq", full_pq, (9, 16, 9), True, "nclx 9/16/9", True),
                                                    ("hlg", full_pq, (9, 18, 9), True, "nclx 9/18/9", True),
                                                    ("pq-limited", full_pq, (9, 16, 9), False, "nclx 9/16/9, limited range", True),
                                                    ("p3", full_pq, (12, 13, 6), True, "nclx 12/13/6", True),
                                                    ("srgb", full_pq, (1, 13, 6), True, "nclx 1/13/6", False)):
        light = h273(yuv_to_rgb(yuv, numbers[2], full), numbers[0], numbers[1])
        add(f"nclx-{name}.avif", form, f"{tag}, 10 bits", lambda y=yuv, n=numbers, f=full: avif(y, *n, f), light, value=is_value)
    eight_bits = [128, 120, 135]
    add("nclx-srgb-8.avif", form, "nclx 1/13/6, 8 bits", lambda: avif(eight_bits, 1, 13, 6, True, 8),
        h273(np.array([round(v * 255) for v in yuv_to_rgb(eight_bits, 6, True, 8)]) / 255, 1, 13), tolerance=0.03,
        why="readers round RGB to 8 bits: half a code of 130 is 1 %")


def hidden_rows():
    """HEIC of OpenImageIO, where libheif has an encoder."""
    big = np.tile(RGB8.astype(np.uint8)[:1, :1], (64, 64, 1))
    add("plain.heic", "HEIF", "8 bits", lambda: with_oiio("heic", big, [("compression", "heic:100")]), SRGB8, tolerance=0.04,
        why="HEVC is lossy, and 4:2:0: one code")


png_rows()
jpeg_rows()
tiff_rows()
exr_rows()
radiance_rows()
netpbm_rows()
dpx_rows()
small_rows()
modern_rows()
hidden_rows()
names = [row.name for row in ROWS]
assert len(set(names)) == len(names), sorted(n for n in names if names.count(n) > 1)


def write(folder, names=()):
    """Writes the files; returns name -> why it was left out."""
    left_out = {}
    for row in ROWS:
        if names and row.name not in names:
            continue
        try:
            (Path(folder) / row.name).write_bytes(row.make())
        except Missing as error:
            left_out[row.name] = str(error)
    return left_out


if __name__ == "__main__":
    Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
    for name, why in write(sys.argv[1], sys.argv[2:]).items():
        print(f"left out: {name}: {why}")
    print(f"{len(ROWS)} rows, {sum(row.value for row in ROWS)} of them for the comparison of programs")
