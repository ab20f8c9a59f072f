# SPDX-License-Identifier: Apache-2.0
"""Reading LUTs: what is about is taken as it is, what is malformed is refused with file, line and reason; and
`eval --lut`, `apply --lut` do what the numbers in the file say.

Every file is written here, from the formats' specifications: small tables, in as many formats as are read. The corpus of
malformed ones is made of them by a list of mutations, the same on every run. Each is given to `tonewright eval --lut` with
1 GB of address space, 20 s and 300 MB of memory: no crash, exit status 3, one line with the file's name and a reason, and
the line's number where the file has lines. What comes out of the good ones is compared with NumPy's interpolation of the same numbers.
"""

import os
import re
import resource
import struct
import subprocess
import tempfile
import threading
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from lut_encodings import acescct_encode
from lut_tables import linear, tetrahedral, trilinear
from pictures import read_exr, run, share_of, skip, stack, unstack, write_exr

GIGABYTE = 1 << 30
# Resident: the program with its libraries has some 60 MB; what files declare here would be gigabytes.
LARGEST = 300 << 20
# Each takes some hundredths of a second; what hangs, hangs for ever.
LONGEST = 20
SIZE = 3  # points a side, of most cubes here
COLORS = np.random.default_rng(5).uniform(-0.1, 1.1, (64, 3)).astype(np.float32).astype(float)


# --------------------------------------------------------------------------------------------------
# Tables, and what they do


def cube_of(size):
    """(blue, green, red, 3): every axis and every channel different, and not straight between the nodes."""
    axis = np.linspace(0, 1, size)
    b, g, r = np.meshgrid(axis, axis, axis, indexing="ij")
    rgb = np.stack([r ** 2 * 0.7 + 0.2 * g, g ** 3 * 0.6 + 0.3 * b, np.sqrt(b) * 0.5 + 0.1 * r * g + 0.05], axis=-1)
    return np.round(rgb, 4)


def interpolate(cube, colors, is_trilinear=False):
    return (trilinear if is_trilinear else tetrahedral)(cube, colors)


CUBE = cube_of(SIZE)
CURVE = np.round(np.linspace(0, 1, 9) ** 2 * 0.8 + 0.1, 4)


def rows(table):
    return "".join(f"{r:.6g} {g:.6g} {b:.6g}\n" for r, g, b in table.reshape(-1, 3))


def column(table):
    return "".join(f"{v:.6g}\n" for v in table)


BLUE_FASTEST = CUBE.transpose(2, 1, 0, 3)
# Of 3dl, whose line of nodes is told by having more than three numbers.
CUBE_3DL = np.round(cube_of(5) * 4095) / 4095
CODES_12 = np.round(CUBE_3DL.transpose(2, 1, 0, 3) * 4095).astype(int)
TRIPLES = np.repeat(CURVE[:, None], 3, axis=1)

# A file of every format of text; the sizes stand for themselves in the mutations below.
GOOD = {
    "adobe.cube": f'TITLE "x"\n# comment\nLUT_3D_SIZE {SIZE}\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\n' + rows(CUBE),
    "adobe1d.cube": "LUT_1D_SIZE 9\n" + rows(TRIPLES),
    "resolve.cube": f"LUT_3D_SIZE {SIZE}\nLUT_3D_INPUT_RANGE 0 1\n" + rows(CUBE),
    "both.cube": f"LUT_1D_SIZE 9\nLUT_1D_INPUT_RANGE 0 1\nLUT_3D_SIZE {SIZE}\nLUT_3D_INPUT_RANGE 0 1\n" + rows(TRIPLES)
                 + rows(CUBE),
    "curve.spi1d": "Version 1\nFrom 0 1\nLength 9\nComponents 1\n{\n" + column(CURVE) + "}\n",
    "cube.spi3d": f"SPILUT 1.0\n3 3\n{SIZE} {SIZE} {SIZE}\n" + "".join(
        f"{r} {g} {b} {' '.join(f'{v:.6g}' for v in CUBE[b, g, r])}\n" for r in range(SIZE) for g in range(SIZE)
        for b in range(SIZE)),
    "cube.csp": "CSPLUTV100\n3D\n\nBEGIN METADATA\nx\nEND METADATA\n\n" + "2\n0 1\n0 1\n" * 3 + f"\n{SIZE} {SIZE} {SIZE}\n"
                + rows(CUBE),
    "curve.csp": "CSPLUTV100\n1D\n\n" + "2\n0 1\n0 1\n" * 3 + "\n9\n" + rows(TRIPLES),
    "cube.3dl": "3DMESH\nMesh 2 12\n0 256 512 767 1023\n" + "".join(f"{r} {g} {b}\n" for r, g, b in CODES_12.reshape(-1, 3))
                + "\nLUT8\ngamma 1.0\n",
    "cube.lut": f"Version 2\nFormat any\nType 3D\nFrom 0 1\nTo 0 1\nBlack 0\nWhite 1\nLength {SIZE}\nLUT:\n {{\n"
                + rows(CUBE) + " }\n",
    "both.lut": f"Version 3\nFormat any\nType 3D+1D\nFrom 0 1\nTo 0 1\nBlack 0\nWhite 1\nLength {SIZE} 9\nLUT:\nPre {{\n"
                + column(CURVE) + "}\n3D {\n" + rows(CUBE) + "}\n",
    "cube.clf": '<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList compCLFversion="3" id="x">\n<LUT3D inBitDepth="32f" '
                f'outBitDepth="32f" interpolation="tetrahedral">\n<Array dim="{SIZE} {SIZE} {SIZE} 3">\n'
                + rows(BLUE_FASTEST) + "</Array>\n</LUT3D>\n</ProcessList>\n",
    "curve.clf": '<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList compCLFversion="3" id="x">\n<LUT1D inBitDepth="32f" '
                 'outBitDepth="32f">\n<Array dim="9 1">\n' + column(CURVE) + "</Array>\n</LUT1D>\n</ProcessList>\n",
    "cube.ctf": '<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList version="1.4" id="x">\n<LUT3D inBitDepth="32f" '
                f'outBitDepth="32f">\n<Array dim="{SIZE} {SIZE} {SIZE} 3">\n' + rows(BLUE_FASTEST)
                + "</Array>\n</LUT3D>\n</ProcessList>\n",
    "cube.itx": f"LUT_3D_SIZE {SIZE}\n" + rows(CUBE),
    "cube.cub": f"# Truelight Cube v2.0\n# width {SIZE} {SIZE} {SIZE}\n# Cube\n" + rows(CUBE),
    "both.cub": f"# Truelight Cube v2.0\n# lutLength 9\n# width {SIZE} {SIZE} {SIZE}\n# InputLUT\n"
                + rows(TRIPLES * (SIZE - 1)) + "# Cube\n" + rows(CUBE) + "# end\n",
    "cube.vf": f"#Inventor V2.1 ascii\ngrid_size {SIZE} {SIZE} {SIZE}\ndata\n" + rows(BLUE_FASTEST),
    "cube.m3d": f"channel 3d\nin {SIZE ** 3}\nout 4096\nformat lut\nvalues red green blue\n" + "".join(
        f"{i} {r} {g} {b}\n" for i, (r, g, b) in enumerate(np.round(BLUE_FASTEST * 4095).astype(int).reshape(-1, 3))),
    "cube.dat": f"3DLUTSIZE {SIZE}\n" + rows(BLUE_FASTEST),
}
LOOK = (f'<?xml version="1.0" ?>\n<look>\n<LUT>\n<size>"{SIZE}"</size>\n<data>"'
        + CUBE.astype("<f4").tobytes().hex().upper() + '"</data>\n</LUT>\n</look>\n')

# OpenColorIO tries all of its readers on whatever the reader of the extension does not take: nothing of one format may
# reach another's reader under the extension of a third. The last ones hang OpenColorIO 2.1, or declare gigabytes.
MATRIX = "2 0 0 0\n0 0.5 0 0\n0 0 1 6553.5\n"
CORRECTION = ('<ColorCorrection id="x">\n<SOPNode>\n<Description>\nin 2019, out of the box\nwidth of the gamut\n</Description>\n'
              "<Slope>2 0.5 1</Slope><Offset>0 0 0.1</Offset><Power>1 1 1</Power>\n</SOPNode>\n</ColorCorrection>\n")
HUGE = 900000000
FOREIGN = {
    "matrix.spimtx": MATRIX,
    "correction.cc": CORRECTION,
    "collection.ccc": f"<ColorCorrectionCollection>\n{CORRECTION}</ColorCorrectionCollection>\n",
    "list.cdl": f"<ColorDecisionList>\n<ColorDecision>\n{CORRECTION}</ColorDecision>\n</ColorDecisionList>\n",
    "discreet.lut": "LUT: 1 2\n0\n255\n",
    "endless.csp": "CSPLUTV100\n3D\n\nBEGIN METADATA\nhello\n",
    "blank lines and endless.csp": "\n\nCSPLUTV100\n3D\n\nBEGIN METADATA\n<ProcessList/>\n",
    "huge.cub": f"# Truelight Cube v2.0\n# iDims 3\n# width {HUGE} {HUGE} {HUGE}\n# lutLength {HUGE}\n",
    "huge.vf": f"#Inventor V2.1 ascii\ngrid_size {HUGE} {HUGE} {HUGE}\ndata\n",
    "huge.m3d": f"channel 3d\nin {HUGE}\nout 4096\nformat lut\nvalues red green blue\n",
    "huge.spi1d": f"Version 1\nFrom 0 1\nLength {HUGE}\nComponents 1\n{{\n0\n1\n}}\n",
    "huge.itx": "LUT_3D_SIZE 1500\n0 0 0\n",
}


def with_description(name, text):
    """A file of the format that OpenColorIO's own reader refuses, with free text that another one may take."""
    if name.endswith("clf"):
        return f"<ProcessList>\n<Description>\n{text}</Description>\n</ProcessList>\n"
    if name.endswith("cc"):
        return f"<ColorCorrection>\n<Description>\n{text}</Description>\n<SOPNode><Slope>x</Slope></SOPNode>\n</ColorCorrection>\n"
    return GOOD["cube.csp"].replace("\nx\n", f"\n{text}", 1)


def expected_of(name, colors, is_trilinear=False):
    stem, extension = name.split(".")
    curve = linear(TRIPLES, np.clip(colors, 0, 1))
    if "1d" in stem or stem == "curve":
        return curve
    cube = {"3dl": CUBE_3DL, "m3d": np.round(CUBE * 4095) / 4095}.get(extension, CUBE)
    return interpolate(cube, curve if stem == "both" else colors, is_trilinear)


# --------------------------------------------------------------------------------------------------
# Pictures and binary files


def png(pixels, bits=16):
    height, width, channels = pixels.shape
    data = np.round(pixels * (2 ** bits - 1)).astype(">u2" if bits == 16 else "u1")
    raw = b"".join(b"\0" + line.tobytes() for line in data)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, bits, 2 if channels == 3 else 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


LEVEL = 2  # of the Hald CLUT: a cube of 4
HALD = cube_of(LEVEL ** 2)
HALD_PIXELS = HALD.reshape(LEVEL ** 3, LEVEL ** 3, 3)
STRIP_PIXELS = CUBE.transpose(1, 0, 2, 3).reshape(SIZE, SIZE * SIZE, 3)
RAW = CUBE.astype("<f4").tobytes()


# --------------------------------------------------------------------------------------------------
# The corpus


def row_lines(text):
    """Indices of the lines that are rows of the table; the last ones of the longest run of lines of numbers alone."""
    lines = text.split("\n")
    number = re.compile(r"^\s*[-+.0-9][-+.0-9e ]*$")
    runs, run_ = [], []
    for i, line in enumerate(lines):
        if number.match(line):
            run_.append(i)
        elif run_:
            runs.append(run_)
            run_ = []
    runs.append(run_)
    return max(runs, key=len)


def with_row(text, change, at=-2):
    """One row of the table changed."""
    lines = text.split("\n")
    index = row_lines(text)[at]
    lines[index] = change(lines[index])
    return "\n".join(line for line in lines if line is not None)


def last_number(replacement):
    return lambda row: re.sub(r"\S+$", replacement, row)


ROWS = {
    "a row is missing": lambda row: None,
    "a row stands twice": lambda row: row + "\n" + row,
    "a row lacks a number": lambda row: re.sub(r"\s*\S+$", "", row),
    "a row has one more number": lambda row: row + " 0.5",
    "nan": last_number("nan"),
    "inf": last_number("inf"),
    "minus inf": last_number("-inf"),
    "too large for a float": last_number("1e60"),
    "too large for a double": last_number("1e999"),
    "a word": last_number("x"),
    "a decimal comma": last_number("0,5"),
    "hexadecimal": last_number("0x10"),
    "letters behind a number": last_number("0.5f"),
    "two signs": last_number("+-1"),
    "a lone point": last_number("."),
    "a word before": lambda row: "x " + row,
    "a row of letters": lambda row: "hello world",
    "a row as long as a book": lambda row: row + " 1" * 50000,
}

# Declared sizes: with the text that declares it; {} is the size.
SIZES = {
    "adobe.cube": (f"LUT_3D_SIZE {SIZE}", "LUT_3D_SIZE {}"),
    "adobe1d.cube": ("LUT_1D_SIZE 9", "LUT_1D_SIZE {}"),
    "resolve.cube": (f"LUT_3D_SIZE {SIZE}", "LUT_3D_SIZE {}"),
    "both.cube": ("LUT_1D_SIZE 9", "LUT_1D_SIZE {}"),
    "curve.spi1d": ("Length 9", "Length {}"),
    "cube.spi3d": (f"{SIZE} {SIZE} {SIZE}", "{0} {0} {0}"),
    "cube.csp": (f"{SIZE} {SIZE} {SIZE}", "{0} {0} {0}"),
    "curve.csp": ("\n9\n", "\n{}\n"),
    "cube.lut": (f"Length {SIZE}", "Length {}"),
    "both.lut": (f"Length {SIZE} 9", f"Length {SIZE} {{}}"),
    "cube.clf": (f"{SIZE} {SIZE} {SIZE} 3", "{0} {0} {0} 3"),
    "curve.clf": ("9 1", "{} 1"),
    "cube.ctf": (f"{SIZE} {SIZE} {SIZE} 3", "{0} {0} {0} 3"),
    "cube.itx": (f"LUT_3D_SIZE {SIZE}", "LUT_3D_SIZE {}"),
    "cube.cub": (f"# width {SIZE} {SIZE} {SIZE}", "# width {0} {0} {0}"),
    "both.cub": ("# lutLength 9", "# lutLength {}"),
    "cube.vf": (f"grid_size {SIZE} {SIZE} {SIZE}", "grid_size {0} {0} {0}"),
    "cube.m3d": (f"in {SIZE ** 3}", "in {}"),
    "cube.dat": (f"3DLUTSIZE {SIZE}", "3DLUTSIZE {}"),
}
# 1500 a side are 40 GB of floats, 950 are 10 GB.
DECLARED = ["0", "1", "-1", "2", "950", "1500", "2147483647", "99999999999999999999", "x", "3.5", ""]


def text_corpus():
    """(name, what is wrong, bytes)"""
    for name, text in GOOD.items():
        for what, change in ROWS.items():
            # Whole numbers are what is allowed there.
            yield name, what, with_row(text, change).encode()
        lines = text.split("\n")
        # All but the last of these lines, so that the file ends within.
        half = "\n".join(lines[:row_lines(text)[len(row_lines(text)) // 2]])
        yield name, "it ends after half of its rows", half.encode()
        yield name, "it ends before the first row", "\n".join(lines[:row_lines(text)[0]]).encode()
        yield name, "it is empty", b""
        yield name, "it is blank", b"\n \r\n\t\n"
        yield name, "it is UTF-16", text.encode("utf-16")
        yield name, "it has a NUL", with_row(text, lambda row: row + "\0").encode()
        yield name, "it is a PNG", png(HALD_PIXELS)
        yield name, "it is another format", b"<html><body>404 Not Found</body></html>\n"
        yield name, "it is zeros", bytes(4096)
        if name in SIZES:
            declared, template = SIZES[name]
            for size in DECLARED:
                yield name, f"declared size {size}", text.replace(declared, template.format(size), 1).encode()
    for name, what, old, new in (
            ("adobe.cube", "two sizes", f"LUT_3D_SIZE {SIZE}", f"LUT_3D_SIZE {SIZE}\nLUT_3D_SIZE {SIZE}"),
            ("adobe.cube", "no size", f"LUT_3D_SIZE {SIZE}\n", ""),
            ("adobe.cube", "an unknown keyword", "DOMAIN_MIN", "LUT_IN_VIDEO_RANGE\nDOMAIN_MIN"),
            ("adobe.cube", "a misspelled size", f"LUT_3D_SIZE {SIZE}", f"LUT_3D_SIZ {SIZE}"),
            ("adobe.cube", "a keyword cut short", "DOMAIN_MAX", "DOMAIN_M"),
            ("adobe.cube", "DOMAIN_MIN of two numbers", "DOMAIN_MIN 0 0 0", "DOMAIN_MIN 0 0"),
            ("adobe.cube", "DOMAIN_MAX of letters", "DOMAIN_MAX 1 1 1", "DOMAIN_MAX 1 1 a"),
            ("adobe.cube", "an empty domain", "DOMAIN_MAX 1 1 1", "DOMAIN_MAX 1 0 1"),
            ("adobe.cube", "NaN as domain", "DOMAIN_MAX 1 1 1", "DOMAIN_MAX nan nan nan"),
            ("adobe.cube", "two kinds of domain", "DOMAIN_MIN 0 0 0", "LUT_3D_INPUT_RANGE 0 1\nDOMAIN_MIN 0 0 0"),
            ("adobe.cube", "a 2D table", f"LUT_3D_SIZE {SIZE}", "LUT_2D_SIZE 3"),
            ("resolve.cube", "an empty range", "INPUT_RANGE 0 1", "INPUT_RANGE 1 1"),
            ("both.cube", "a domain beside two tables", "LUT_1D_INPUT_RANGE 0 1", "DOMAIN_MIN 0 0 0"),
            ("curve.spi1d", "no version", "Version 1\n", ""),
            ("curve.spi1d", "version 2", "Version 1", "Version 2"),
            ("curve.spi1d", "no length", "Length 9\n", ""),
            ("curve.spi1d", "no components", "Components 1\n", ""),
            ("curve.spi1d", "9 components", "Components 1", "Components 9"),
            ("curve.spi1d", "an empty range", "From 0 1", "From 1 0"),
            ("curve.spi1d", "no end", "}\n", ""),
            ("curve.spi1d", "no beginning", "{\n", ""),
            ("cube.spi3d", "an index beyond the cube", "2 2 2 ", "2 2 3 "),
            ("cube.spi3d", "a negative index", "2 2 2 ", "2 2 -1 "),
            ("cube.spi3d", "a node that stands twice", "2 2 2 ", "2 2 1 "),
            ("cube.spi3d", "unequal sizes", "3 3 3\n", "3 3 4\n"),
            ("cube.csp", "metadata without end", "END METADATA", "END"),
            ("cube.csp", "2D", "\n3D\n", "\n2D\n"),
            ("cube.csp", "a prelut of fewer numbers", "2\n0 1\n0 1\n", "3\n0 1\n0 1\n"),
            ("cube.csp", "a prelut of more numbers", "2\n0 1\n0 1\n", "2\n0 0.5 1\n0 1\n"),
            ("cube.csp", "a prelut that falls", "2\n0 1\n0 1\n", "2\n1 0\n0 1\n"),
            ("cube.csp", "a prelut with NaN", "2\n0 1\n0 1\n", "2\n0 nan\n0 1\n"),
            ("cube.csp", "a prelut of ten milliards", "2\n0 1\n0 1\n", "9999999999\n0 1\n0 1\n"),
            ("cube.csp", "unequal sizes", "\n3 3 3\n", "\n3 3 4\n"),
            ("cube.3dl", "a number of no depth", "0 256 512", "0 256 99999999"),
            ("cube.3dl", "an unknown keyword behind the rows", "LUT8", "hello"),
            ("cube.lut", "an unknown type", "Type 3D", "Type RGBA"),
            ("cube.lut", "no type", "Type 3D\n", ""),
            ("cube.lut", "no From", "From 0 1\n", ""),
            ("cube.lut", "no end", " }\n", ""),
            ("cube.lut", "no table", "LUT:\n", ""),
            ("cube.lut", "an unknown block", "LUT:\n {", "LUT:\n abc {"),
            ("both.lut", "one size", f"Length {SIZE} 9", f"Length {SIZE}"),
            ("both.lut", "no prelut", "Pre {", "3D {"),
            ("cube.clf", "unequal sizes", f'"{SIZE} {SIZE} {SIZE} 3"', f'"{SIZE} {SIZE} 4 3"'),
            ("cube.clf", "four channels", f"{SIZE} {SIZE} {SIZE} 3", f"{SIZE} {SIZE} {SIZE} 4"),
            ("cube.clf", "no dim", f' dim="{SIZE} {SIZE} {SIZE} 3"', ""),
            ("cube.clf", "a tag that does not close", "</Array>", "</Array"),
            ("cube.clf", "a tag that closes twice", "</LUT3D>", "</LUT3D></LUT3D>"),
            ("cube.clf", "no version", ' compCLFversion="3"', ""),
            ("cube.clf", "an unknown depth", 'inBitDepth="32f"', 'inBitDepth="7z"'),
            ("cube.clf", "a comment without end", "<LUT3D", "<!-- <LUT3D"),
            ("cube.clf", "entities", "<ProcessList", '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">]>\n<ProcessList'),
            ("cube.clf", "another document", "ProcessList", "List"),
            ("cube.ctf", "another document", "ProcessList", "List"),
            ("cube.clf", "a tag that closes another", "</LUT3D>", "</LUT1D>"),
            ("cube.clf", "text before it", "<?xml", "CSPLUTV100\n3D\n\nBEGIN METADATA\n<?xml"),
            ("cube.clf", "an Array in no LUT", "LUT3D", "LUT4D"),
            ("cube.clf", "a size in lower case", f'Array dim="{SIZE} {SIZE} {SIZE} 3"', 'array DIM="1500 1500 1500 3"'),
            ("cube.clf", "a size behind another attribute", f'dim="{SIZE}', f'xdim="{SIZE} {SIZE} {SIZE} 3" dim="950'),
            ("cube.clf", "a size behind a > in quotation marks", f'dim="{SIZE}', f'name=">" dim="950'),
            ("curve.clf", "NaN, and no half domain", "<LUT1D", '<LUT1D halfDomain="false"'),
            ("cube.clf", "an IndexMap of 900000000", "<Array", f'<IndexMap dim="{HUGE}">0@0 1@1</IndexMap>\n<Array'),
            ("cube.clf", "an IndexMap of 100000 with two", "<Array", '<indexmap DIM="100000">0@0 1@1</indexmap>\n<Array'),
            ("cube.clf", "an IndexMap without dim", "<Array", "<IndexMap>0@0 1@1</IndexMap>\n<Array"),
            ("cube.ctf", "a Reference", "<LUT3D", '<Reference path="other.clf" inBitDepth="32f" outBitDepth="32f"/>\n<LUT3D'),
            ("cube.ctf", "a reference", "<LUT3D", '<rEFERENCE path="other.clf"></rEFERENCE>\n<LUT3D'),
            ("cube.clf", "elements without end", "<LUT3D", "<a>" * 100 + "<LUT3D"),
            ("cube.3dl", "a size of another format", "LUT8", "LUT_3D_SIZE 1500")):
        if "NaN" in what:
            yield name, what, with_row(GOOD[name].replace(old, new), last_number("nan")).encode()
            continue
        if old not in GOOD[name]:
            raise ValueError(f"{name}: {what}")
        yield name, what, GOOD[name].replace(old, new).encode()


def foreign_corpus():
    """Every extension that is read, with what every other format holds."""
    contents = GOOD | FOREIGN
    extensions = {name.rsplit(".", 1)[1] for name in GOOD} | {"spimtx", "cc"}
    for extension in sorted(extensions):
        for name, text in contents.items():
            own = name.rsplit(".", 1)[1]
            # CLF and CTF are one; our reader of cubes takes what .itx may hold.
            if own == extension and not name.startswith(("huge", "endless", "blank")):
                continue
            if {own, extension} in ({"clf", "ctf"}, {"itx", "cube"}):
                continue
            yield f"foreign.{extension}", f"it holds {name}", text.encode()
    for extension in ("clf", "cc", "csp"):
        for name, text in FOREIGN.items():
            # Whatever else stands in the metadata of a .csp is fine.
            if "<" in text or (extension == "csp" and name not in ("huge.m3d", "huge.spi1d", "huge.itx")):
                continue
            yield f"described.{extension}", f"{name} in its text", with_description(extension, text).encode()
    acsp = "<!--" + " " * 32 + "acsp" + " " * 100 + "-->\n"
    yield "icc.clf", "the signature of an ICC profile", (acsp + GOOD["cube.clf"].split("\n", 1)[1]).encode()
    for name, text in (("few.spimtx", "1 0 0 0\n0 1 0 0\n0 0 1\n"), ("more.spimtx", MATRIX + "1\n"),
                       ("nan.spimtx", MATRIX.replace("0.5", "nan")), ("word.spimtx", MATRIX.replace("0.5", "x")),
                       ("entities.cc", '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">]>\n' + CORRECTION),
                       ("open.cc", CORRECTION.replace("</SOPNode>", "")),
                       ("depth.lut", "LUT: 1 2 " + "1" * 16 + "\n0\n255\n"), ("from.spi1d", GOOD["curve.spi1d"].replace(
                           "From 0 1", "From 0 1." + "0" * 62)),
                       ("open.look", LOOK.replace("</look>", "")), ("few.look", LOOK.replace(f'"{SIZE}"', '"4"')),
                       ("huge.look", LOOK.replace(f'"{SIZE}"', '"950"')), ("word.look", LOOK.replace(f'"{SIZE}"', '"x"')),
                       ("nan.look", re.sub('(?<=<data>")........', "0000C07F", LOOK)),
                       ("letters.look", re.sub('(?<=<data>")....', "xyzw", LOOK)),
                       ("twice.look", LOOK.replace("<size>", "<size>3</size><size>")),
                       ("mask.look", LOOK.replace("<LUT>", "<mask><a/></mask><LUT>")),
                       ("comment.look", LOOK.replace("<LUT>", '<mask><!-- c -->"mask"</mask><LUT>')),
                       ("joined.look", LOOK.replace("<size>", "<size><!-- c -->")),
                       ("child.look", LOOK.replace("</data>", "<a/>00000000</data>")),
                       ("none.look", "<look></look>\n"),
                       ("infinite.cc", CORRECTION.replace("0 0 0.1", "0 -1e90 0.1")),
                       ("utf16.cc", CORRECTION.encode("utf-16-le").decode("latin1"))):
        yield name, name, text.encode("latin1")


def binary_corpus(command, folder):
    """The same, of files without lines."""
    for extra in (-1, 1, 12, -12):
        yield "cube.raw", f"{extra:+d} bytes", RAW[:extra] if extra < 0 else RAW + bytes(extra)
    yield "cube.raw", "it is empty", b""
    yield "cube.raw", "one node", RAW[:12]
    for number in (np.nan, np.inf, -np.inf):
        values = CUBE.astype("<f4").copy()
        values[1, 2, 0, 1] = number
        yield "cube.raw", f"{number} in it", values.tobytes()
    yield "cube.raw", "130 points a side", 130 ** 3 * bytes(12)
    for version in (2, 4):
        path = folder / f"good{version}.icc"
        run(command, "bake", "hable", "--format", "icc", "--icc-version", version, "--size", 17, "--nodes", "sampled", "-o", path)
        good = path.read_bytes()
        name = f"v{version}.icc"
        for keep in (0, 1, 100, 128, 131, 140, 200, len(good) // 2, len(good) - 1, len(good) - 4000):
            yield name, f"{keep} of {len(good)} bytes", good[:keep]
        for what, old, new in (("no signature", b"acsp", b"acsq"), ("a display's profile", b"link", b"mntr"),
                               ("CMYK in", b"RGB RGB ", b"CMYKRGB "), ("Lab out", b"RGB RGB ", b"RGB Lab "),
                               ("no A2B0", b"A2B0", b"A2B9"), ("an unknown type", b"mft2" if version == 2 else b"mAB ", b"abcd")):
            if old not in good:
                raise ValueError(what)
            yield name, what, good.replace(old, new)
        at = good.index(b"mft2" if version == 2 else b"mAB ", 200)
        channels = good[:at + 8] + bytes([15, 15]) + good[at + 10:]
        yield name, "15 channels", channels
        # The size of the grid: a byte of the tag, or bytes of its CLUT.
        grid = at + 10 if version == 2 else at + int.from_bytes(good[at + 24:at + 28], "big")
        for points in (0, 255):
            yield name, f"{points} points a side", good[:grid] + bytes([points] * (1 if version == 2 else 3)) + good[
                grid + (1 if version == 2 else 3):]
        # A second A2B0, with the name of another tag in it; LittleCMS reads the first.
        yield name, "two tags A2B0", good.replace(b"desc", b"A2B0", 1)
        yield name, "a table of tags without end", good[:128] + b"\xff\xff\xff\xff" + good[132:]
        yield name, "a tag beyond the file", good.replace(b"A2B0" + good[good.index(b"A2B0") + 4:][:8],
                                                          b"A2B0\x7f\xff\xff\xff\x00\x00\x10\x00", 1)
    picture = png(HALD_PIXELS)
    for keep in (0, 8, 20, 33, len(picture) // 2, len(picture) - 20):
        yield "hald.png", f"{keep} of {len(picture)} bytes", picture[:keep]
    yield "hald.png", "it is no picture", b"hello\n"
    yield "hald.png", "a wrong checksum", picture[:50] + b"\xff\xff" + picture[52:]
    yield "odd.png", "of no layout", png(np.zeros((5, 7, 3)))
    yield "odd.png", "9 x 9", png(np.zeros((9, 9, 3)))
    yield "odd.png", "too large a strip", png(np.zeros((65, 65 * 65, 3)), 8)
    yield "odd.png", "alpha below 1", png(np.full((8, 8, 4), 0.5))
    yield "huge.png", "a header of 100000 x 100000", picture[:16] + struct.pack(">II", 100000, 100000) + picture[24:]
    yield "nan.exr", "NaN", ("exr", np.nan)
    yield "inf.exr", "infinity", ("exr", np.inf)


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (GIGABYTE, GIGABYTE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def peak_of(arguments, stdin):
    """(status, stdout, stderr, bytes of memory); what does not end in time is killed, and says so"""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err, tempfile.TemporaryFile() as into:
        into.write(stdin.encode())
        into.seek(0)
        process = subprocess.Popen([str(a) for a in arguments], stdin=into, stdout=out, stderr=err, preexec_fn=limited)
        timer = threading.Timer(LONGEST, process.kill)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        is_late = not timer.is_alive()
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        if is_late:
            return process.returncode, "", f"does not end within {LONGEST} s: {arguments[-1]}", 0
        out.seek(0)
        err.seek(0)
        return process.returncode, out.read().decode(), err.read().decode(errors="replace"), usage.ru_maxrss * 1024


# "tonewright: read: FILE: line 3: WHAT IS WRONG; expected ...", where what is wrong has a subject; or OpenColorIO's words.
MESSAGE = re.compile(r"tonewright: read: [^:]+: (line [1-9][0-9]*: (?!(is|has|ends|holds|begins|opens) )[^; ].*(?<! is); expected .+"
                     r"|.*At line \d+: ?.*)")


def refuse(command, folder, index, case):
    """None, or what is wrong with how a malformed file is refused."""
    name, what, contents = case
    path = folder / f"{index}_{name}"
    if isinstance(contents, tuple):
        pixels = HALD_PIXELS.copy()
        pixels[3, 4, 1] = contents[1]
        write_exr(path, unstack(pixels))
    else:
        path.write_bytes(contents)
    status, out, err, peak = peak_of([command, "eval", "--lut", path], "0.1 0.2 0.3\n")
    path.unlink()
    has_lines = name.rsplit(".", 1)[1] not in ("raw", "icc", "png", "exr")
    reason = err.split(path.name, 1)[-1].strip(": \n")
    if status != 3 or out or err.count("\n") != 1 or not err.startswith("tonewright: ") or path.name not in err or len(reason) < 8:
        return f"{name}, {what}: exit {status}: {(out + err).strip()[:300]}"
    if has_lines and not re.search(r"(?i)\bline \(?\d+", err):
        return f"{name}, {what}: no line: {err.strip()}"
    if has_lines and not MESSAGE.fullmatch(err.strip()):
        return f"{name}, {what}: not of the form of a message: {err.strip()}"
    if not err.isascii() or max(len(line) for line in err.split("\n")) > 600:
        return f"{name}, {what}: {err[:600]!r}"
    return f"{name}, {what}: {peak / 2 ** 20:.0f} MB" if peak > LARGEST else None


def test_corpus(report, command, scratch):
    corpus = list(text_corpus()) + list(foreign_corpus()) + list(binary_corpus(command, scratch))
    report.check(f"{len(corpus)} malformed files", len(corpus) >= 200, len(corpus))
    cases = share_of(corpus, 3)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = list(pool.map(lambda c: refuse(command, scratch, *c), enumerate(cases)))
    kinds = {}
    for (name, _, _), fault in zip(cases, faults):
        kinds.setdefault(name, []).append(fault)
    for name, found in kinds.items():
        bad = [fault for fault in found if fault]
        report.check(f"{name}: {len(found)} malformed files are refused, each in one line", not bad, "\n     ".join(bad))


def test_messages(report, command, scratch):
    """Each names the line at fault, what is wrong there and what is expected."""
    for name, old, new, message in (
            ("adobe.cube", f"LUT_3D_SIZE {SIZE}", "LUT_3D_SIZE", "line 3: LUT_3D_SIZE is missing; expected a whole number in [2, 129]"),
            ("adobe.cube", "DOMAIN_MAX 1 1 1", "DOMAIN_MAX 1 0 1", "line 5: DOMAIN_MIN is 0 0 0, DOMAIN_MAX 1 0 1; expected "
             "DOMAIN_MIN below DOMAIN_MAX in each channel"),
            ("adobe1d.cube", "SIZE 9", "SIZE 8", "line 10: the table has more than 8 rows; expected 8"),
            ("adobe1d.cube", "SIZE 9", "SIZE 10", "line 10: the table ends after 9 rows; expected 10"),
            ("curve.spi1d", "Version 1\n", "", "line 4: Version is missing; expected Version 1 before {"),
            ("curve.spi1d", "}\n", "", "line 14: the file ends; expected }"),
            ("cube.spi3d", "SPILUT 1.0", "", "line 1: the line is empty; expected SPILUT 1.0"),
            ("cube.csp", "0 1\n", "1 0\n", "line 9: 1 0; expected rising numbers"),
            ("cube.csp", "END METADATA", "END", "line 45: the file ends; expected END METADATA"),
            ("cube.3dl", "0 256", "0.5 256", "line 3: number is 0.5; expected a whole number in [-131071, 131071]"),
            ("cube.lut", "Type 3D", "Type RGBA", "line 3: Type is RGBA; expected 3D, 3D+1D or C"),
            ("cube.lut", "From 0 1\n", "", "line 8: From is missing; expected it before LUT:"),
            ("both.lut", f"Length {SIZE} 9", f"Length {SIZE}", "line 9: number of sizes in Length is 1; expected 2 with this Type"),
            ("both.lut", f"Length {SIZE} 9", f"Length {SIZE} 10", "line 20: block Pre has 9 numbers; expected 10"),
            ("curve.clf", "9 1", "8 1", "line 13: the Array has more than 8 numbers; expected 8"),
            ("curve.clf", "0.1125", "0,1125", "line 6: number is 0,1125; expected a number"),
            ("curve.clf", "</LUT1D>", "</LUT3D>", "line 15: </LUT3D> closes no element; expected </LUT1D>"),
            ("curve.clf", "</ProcessList>\n", "", "line 16: the file ends; expected </ProcessList>"),
            ("curve.clf", '<?xml version="1.0" encoding="UTF-8"?>', "2 0 0", "line 1: 2 0 0; expected XML, which begins with <")):
        path = scratch / name
        if old not in GOOD[name]:
            raise ValueError(f"{name}: {old}")
        path.write_text(GOOD[name].replace(old, new, 1))
        _, _, err, _ = peak_of([command, "eval", "--lut", path], "")
        report.check(f"{name}: {message}", err == f"tonewright: read: {path}: {message}\n", err)


def test_noise(report, command, scratch):
    """Bytes changed by chance: the file may still be one. No crash, no great memory, one line or a result."""
    random = np.random.default_rng(11)
    run(command, "bake", "hable", "--format", "icc", "--size", 17, "--nodes", "sampled", "-o", scratch / "good.icc")
    files = {name: text.encode() for name, text in GOOD.items()} | {
        "cube.raw": RAW, "link.icc": (scratch / "good.icc").read_bytes(), "hald.png": png(HALD_PIXELS)}
    jobs = []
    for name, good in files.items():
        for _ in range(2 if name == "hald.png" else 8):
            noisy = bytearray(good)
            for at in random.integers(0, min(len(good), 4000), 6):
                noisy[at] = random.integers(0, 256)
            jobs.append((name, bytes(noisy)))

    def one(job):
        index, (name, contents) = job
        path = scratch / f"noise{index}_{name}"
        path.write_bytes(contents)
        status, out, err, peak = peak_of([command, "eval", "--lut", path], "0.1 0.2 0.3\n")
        path.unlink()
        ok = (status == 0 and len(out.split()) == 3) or (status == 3 and err.count("\n") == 1 and path.name in err)
        return None if ok and peak <= LARGEST else f"{name}: exit {status}, {peak / 2 ** 20:.0f} MB: {(out + err)[:300]!r}"

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        bad = [fault for fault in pool.map(one, enumerate(jobs)) if fault]
    report.check(f"{len(jobs)} files with six bytes changed by chance", not bad, "\n     ".join(bad))


def test_paths(report, command, folder):
    """Paths that are not files, and files that are too large."""
    (folder / "folder.cube").mkdir()
    os.mkfifo(folder / "pipe.cube")
    with open(folder / "ten_gigabytes.cube", "wb") as file:
        file.truncate(10 << 30)
    (folder / "table.txt").write_text(GOOD["adobe.cube"])
    (folder / "noextension").write_text(GOOD["adobe.cube"])
    for name, words in (("missing.cube", "No such file"), ("folder.cube", "is a folder"), ("pipe.cube", "is no regular file"),
                        ("ten_gigabytes.cube", "10737418240 bytes; expected at most 134217728"), ("missing.png", "No such file"),
                        ("missing.icc", "No such file"), ("table.txt", "extension is .txt; expected .cube"),
                        ("noextension", "extension is missing")):
        for arguments in (["eval", "--lut", folder / name], ["verify", "--lut", folder / name],
                          ["apply", folder / "in.exr", folder / "out.exr", "--lut", folder / name]):
            status, out, err, _ = peak_of([command, *arguments], "")
            report.check(f"{arguments[0]} --lut {name}: {words}",
                         status == 3 and not out and err.count("\n") == 1 and name in err and words in err, (status, err))
    (folder / "ten_gigabytes.cube").unlink()


# --------------------------------------------------------------------------------------------------
# Output of LUTs


def evaluate_lut(command, path, colors, *arguments):
    """Colors as the table takes them, unless the arguments say what stands before it."""
    if "--input-encoding" not in arguments:
        arguments += ("--input-encoding", "none")
    text = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in colors.tolist())
    return np.array(run(command, "eval", "--lut", path, *arguments, stdin=text).split(), float).reshape(-1, 3)


# OpenColorIO and LittleCMS work in float32.
FLOAT32 = 2e-6


@pytest.fixture(scope="module")
def folder(command, folder):
    """With all of GOOD, LUTs without lines, and a picture."""
    for name, text in GOOD.items():
        (folder / name).write_text(text)
    (folder / "cube.raw").write_bytes(RAW)
    (folder / "hald.png").write_bytes(png(HALD_PIXELS))
    (folder / "strip.png").write_bytes(png(STRIP_PIXELS))
    write_exr(folder / "hald.exr", unstack(HALD_PIXELS))
    write_exr(folder / "in.exr", unstack(COLORS.reshape(8, 8, 3)))
    for name, options in (("link2.icc", ["--format", "icc", "--icc-version", 2]), ("link4.icc", ["--format", "icc", "--icc-version", 4]),
                          ("link.raw", ["--format", "raw", "--3d"])):
        run(command, "bake", "agx_sobotka", *options, "--size", 17, "--nodes", "sampled", "--input-encoding", "log2", "-o", folder / name)
    return folder


def test_eval(report, command, folder):
    own = GOOD["cube.clf"].replace("tetrahedral", "trilinear")
    (folder / "own.clf").write_text(own)
    report.compare("eval --lut: a CLF's own interpolation", evaluate_lut(command, folder / "own.clf", COLORS),
                   interpolate(CUBE, COLORS, True), FLOAT32)
    report.compare("eval --lut: another than a CLF's own",
                   evaluate_lut(command, folder / "own.clf", COLORS, "--interpolation", "tetrahedral"),
                   interpolate(CUBE, COLORS), FLOAT32)
    for name in GOOD:
        path = folder / name
        for arguments in ([], ["--interpolation", "trilinear"]):
            # A prelut is resampled to 65536 steps.
            report.compare(f"eval --lut {name} {' '.join(arguments)}", evaluate_lut(command, path, COLORS, *arguments),
                           expected_of(name, COLORS, bool(arguments)), FLOAT32)
    for name, cube, depth in (("cube.raw", CUBE, 0), ("hald.png", HALD, 65535), ("strip.png", CUBE, 65535), ("hald.exr", HALD, 0)):
        rounded = np.round(cube * depth) / depth if depth else cube.astype(np.float32).astype(float)
        for arguments in ([], ["--interpolation", "trilinear"]):
            # Our own interpolator works in double; numbers are printed from floats.
            report.compare(f"eval --lut {name} {' '.join(arguments)}",
                           evaluate_lut(command, folder / name, COLORS, *arguments),
                           interpolate(rounded, COLORS, bool(arguments)), 1e-7)
    for version in (2, 4):
        # LittleCMS works in 16 bits: half a step of the input, twice as steep here, and half of the output.
        nodes = np.round(np.clip(np.fromfile(folder / "link.raw", "<f4").reshape(17, 17, 17, 3), 0, 1) * 65535.0) / 65535
        report.compare(f"eval --lut of an ICC device link, version {version}", evaluate_lut(command, folder / f"link{version}.icc", COLORS),
                       interpolate(nodes, COLORS), 2.5e-5)
    special = np.array([[np.nan, 0.5, 0.5], [np.inf, 0.5, 0.5], [-np.inf, 0.5, 0.5], [-1, 2, 0.5]])
    clamped = np.array([[0, 0.5, 0.5], [1, 0.5, 0.5], [0, 0.5, 0.5], [0, 1, 0.5]])
    for name, bound in (("adobe.cube", FLOAT32), ("cube.raw", 1e-7), ("link4.icc", 1e-7)):
        report.compare(f"eval --lut {name}: NaN and what is beyond 0 and 1", evaluate_lut(command, folder / name, special),
                       evaluate_lut(command, folder / name, clamped), bound)


@pytest.mark.share(2)
def test_encoding(report, command, folder):
    """--input-encoding: light of --input, in the encoding's own primaries."""
    path = folder / "adobe.cube"
    light = np.random.default_rng(6).uniform(0, 4, (64, 3)).astype(np.float32).astype(float)
    code = acescct_encode(light)
    report.compare("eval --lut --input-encoding acescct --input lin_ap1",
                   evaluate_lut(command, path, light, "--input-encoding", "acescct", "--input", "lin_ap1"),
                   interpolate(CUBE, code), 1e-5)
    report.compare("eval --lut --input-encoding acescct --input lin_rec709 --lut-space lin_rec709 --exposure -1",
                   evaluate_lut(command, path, light, "--input-encoding", "acescct", "--lut-space", "lin_rec709",
                                "--exposure=-1"), interpolate(CUBE, acescct_encode(light / 2)), 1e-5)
    # The Academy's matrix from Rec.709 (D65) to AP1, with Bradford adaptation; TB-2014-004's chromaticities.
    to_ap1 = np.array([[0.6131, 0.3395, 0.0474], [0.0702, 0.9164, 0.0134], [0.0206, 0.1096, 0.8698]])
    report.compare("eval --lut --input-encoding acescct: Rec.709 light becomes AP1",
                   evaluate_lut(command, path, light, "--input-encoding", "acescct"),
                   interpolate(CUBE, acescct_encode(light @ to_ap1.T)), 1e-4)


def test_apply(report, command, folder):
    """Pictures: pixel types, gray, alpha, and the same as eval."""
    path = folder / "adobe.cube"
    colors = COLORS.reshape(8, 8, 3)
    for name in ("adobe.cube", "cube.raw", "hald.png", "both.lut", "link4.icc"):
        run(command, "apply", folder / "in.exr", folder / "out.exr", "--lut", folder / name, "-d", "float",
            "--input-encoding", "none")
        report.compare(f"apply --lut {name}: as eval", stack(read_exr(folder / "out.exr")).reshape(-1, 3),
                       evaluate_lut(command, folder / name, COLORS), FLOAT32)
    run(command, "apply", folder / "in.exr", folder / "out.exr", "--lut", path, "-d", "float", "--interpolation", "trilinear",
        "--input-encoding", "acescct", "--input", "lin_ap1", "--exposure", 1, "--threads", 2)
    report.compare("apply --lut with all options", stack(read_exr(folder / "out.exr")).reshape(-1, 3),
                   interpolate(CUBE, acescct_encode(2 * COLORS), True), 1e-5)
    # A gray picture becomes one in color: the LUT is not neutral.
    write_exr(folder / "gray.exr", {"Y": colors[..., 0]})
    run(command, "apply", folder / "gray.exr", folder / "out.exr", "--lut", path, "-d", "float")
    report.compare("apply --lut: a gray picture", stack(read_exr(folder / "out.exr")).reshape(-1, 3),
                   interpolate(CUBE, np.repeat(COLORS[:, :1], 3, axis=1)), FLOAT32)
    alpha = np.random.default_rng(7).uniform(0.2, 1, (8, 8))
    write_exr(folder / "alpha.exr", unstack(colors * alpha[..., None]) | {"A": alpha})
    run(command, "apply", folder / "alpha.exr", folder / "out.exr", "--lut", path, "-d", "float")
    out = read_exr(folder / "out.exr")
    report.compare("apply --lut: color that is multiplied by alpha", stack(out).reshape(-1, 3),
                   interpolate(CUBE, COLORS) * alpha.reshape(-1, 1), FLOAT32)
    report.check("apply --lut: alpha stays", np.array_equal(out["A"], alpha.astype(np.float32)))


@pytest.mark.share(2)
def test_stated(report, command, folder):
    """apply --lut without --input-encoding: what the header of a file of `bake` says; else a warning."""
    light = np.random.default_rng(8).uniform(0, 4, (8, 8, 3)).astype(np.float32)
    write_exr(folder / "light.exr", unstack(light))

    def applied(lut, *arguments):
        done = subprocess.run([str(command), "apply", str(folder / "light.exr"), str(folder / "out.exr"), "--lut", str(lut),
                               "-d", "float", *map(str, arguments)], capture_output=True, text=True, check=False)
        return done, stack(read_exr(folder / "out.exr")) if done.returncode == 0 else None

    # Linear light is what an EXR should hold.
    bake = ("bake", "agx_sobotka", "--3d", "--size", 17, "--nodes", "sampled", "--input-encoding", "davinci", "--display",
            "linear")
    for name, arguments, explicit in (
            ("stated.cube", (), ("--input-encoding", "davinci")),
            ("own.cube", ("--input", "lin_rec709"), ("--input-encoding", "davinci", "--lut-space", "lin_rec709")),
            ("stated.clf", (), ("--input-encoding", "davinci")), ("stated.ctf", (), ("--input-encoding", "davinci")),
            ("stated.icc", (), ("--input-encoding", "davinci")),
            ("stated4.icc", ("--icc-version", 4), ("--input-encoding", "davinci")),
            ("stated.csp", (), ("--input-encoding", "linear", "--lut-space", "lin_davinci_wg"))):
        run(command, *bake, *arguments, "-o", folder / name)
        done, shown = applied(folder / name)
        _, wanted = applied(folder / name, *explicit)
        report.check(f"apply --lut {name}: as its header says", shown is not None and np.array_equal(shown, wanted),
                     done.stderr)
        lines = done.stderr.splitlines()
        report.check(f"apply --lut {name}: one line says what was assumed", len(lines) == 1 and name in lines[0]
                     and "lin_rec709" in lines[0] and ("DaVinci" in lines[0]), done.stderr)
    said = subprocess.run([str(command), "eval", "--lut", str(folder / "stated.cube")], input="4 2 .5\n", capture_output=True,
                          text=True, check=True)
    report.compare("eval --lut: as its header says", np.array([said.stdout.split()], float),
                   evaluate_lut(command, folder / "stated.cube", np.array([[4, 2, 0.5]]), "--input-encoding", "davinci"), 0)
    report.check("eval --lut: one line says what was assumed", "DaVinci" in said.stderr and said.stderr.count("\n") == 1)
    done, shown = applied(folder / "stated.cube", "-q")
    report.check("apply --lut -q: says nothing", done.returncode == 0 and not done.stderr, done.stderr)
    done, shown = applied(folder / "stated.cube", "--exposure", 1)
    _, wanted = applied(folder / "stated.cube", "--exposure", 1, "--input-encoding", "davinci")
    report.check("apply --lut --exposure: of the light before a stated encoding", np.array_equal(shown, wanted))
    _, plain = applied(folder / "stated.cube", "--input-encoding", "none")
    report.compare("apply --lut --input-encoding none: colors go in as they are", plain.reshape(-1, 3),
                   evaluate_lut(command, folder / "stated.cube", light.reshape(-1, 3).astype(float)), FLOAT32)
    report.check("apply --lut: what the header says is no contradiction, nor is none", not any(
        applied(folder / "stated.cube", "--input-encoding", name)[0].stderr for name in ("davinci", "none")))
    for arguments, words in ((("--input-encoding", "logc3"), "makes logc3 of Linear ARRI Wide Gamut 3"),
                             (("--input-encoding", "davinci", "--lut-space", "acescg"), "makes davinci of ACEScg")):
        done, _ = applied(folder / "stated.cube", *arguments)
        report.check(f"apply --lut {arguments}: one warning, the header says otherwise", done.returncode == 0
                     and len(done.stderr.splitlines()) == 1 and "warning: " in done.stderr and words in done.stderr
                     and "expects DaVinci Intermediate" in done.stderr, done.stderr)
    done, _ = applied(folder / "stated.cube", "--input-encoding", "logc3", "--strict")
    report.check("apply --lut, the header says otherwise, --strict: exit 1", done.returncode == 1, done.stderr)
    done, _ = applied(folder / "adobe.cube")
    report.check("apply --lut of a file that says nothing: one warning", done.returncode == 0
                 and len(done.stderr.splitlines()) == 1 and "warning: " in done.stderr and "adobe.cube" in done.stderr,
                 done.stderr)
    done, _ = applied(folder / "adobe.cube", "--strict")
    report.check("apply --lut of a file that says nothing, --strict: exit 1", done.returncode == 1, done.stderr)


def chunk_of(png, name):
    """A chunk of a PNG file, or nothing (W3C, PNG, 5.3)."""
    at = 8
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == name:
            return png[at + 8:at + 8 + size]
        at += size + 12
    return b""


def red_of_icc(chunk):
    """The tag rXYZ of the profile in a chunk iCCP (ICC.1:2010, 7.3 and 10.31)."""
    profile = zlib.decompress(chunk[chunk.index(b"\0") + 2:])
    for i in range(struct.unpack(">I", profile[128:132])[0]):
        tag, offset, _ = struct.unpack(">4sII", profile[132 + 12 * i:144 + 12 * i])
        if tag == b"rXYZ":
            return np.array(struct.unpack(">3i", profile[offset + 8:offset + 20])) / 65536
    return np.zeros(3)


@pytest.mark.share(2)
def test_output(report, command, folder):
    """apply --lut: the picture says what its colors are, where the LUT's header does."""
    light = np.random.default_rng(9).uniform(0, 2, (8, 8, 3)).astype(np.float32)
    write_exr(folder / "light.exr", unstack(light))

    def applied(lut, out):
        done = subprocess.run([str(command), "apply", str(folder / "light.exr"), str(folder / out), "--lut",
                               str(folder / lut), "--input-encoding", "acescct"], capture_output=True, text=True, check=True)
        return (folder / out).read_bytes(), done.stderr

    # ITU-T H.273: primaries and transfer of the display, RGB, full range.
    for display, points in (("display_p3", None), ("rec2100_pq", (9, 16, 0, 1)), ("rec2100_hlg", (9, 18, 0, 1)),
                            ("p3d65_pq", (12, 16, 0, 1))):
        for extension in ("cube", "clf", "icc") if points is None else ("cube",):
            lut = f"{display}.{extension}"
            run(command, "bake", "clamp", "--3d", "--size", 17, "--nodes", "sampled", "--display", display,
                "-o", folder / lut)
            png, said = applied(lut, "out.png")
            report.check(f"apply --lut {lut}: says nothing", not said, said)
            if points:
                report.check(f"apply --lut {lut}: cICP", chunk_of(png, b"cICP") == bytes(points), chunk_of(png, b"cICP"))
                continue
            # Apple's Display P3, by Bradford in D50: four decimals are published.
            red = red_of_icc(chunk_of(png, b"iCCP")) if chunk_of(png, b"iCCP") else np.zeros(3)
            report.bound(f"apply --lut {lut}: iCCP, red", np.abs(red - (0.5151, 0.2412, -0.0011)).max(), 1e-4)
    _, said = applied("rec2100_pq.cube", "out.jpg")
    report.check("apply --lut: PQ in a JPEG: one warning", said.count("\n") == 1 and "JPEG does not say" in said, said)
    _, said = applied("display_p3.cube", "out.exr")
    report.check("apply --lut: code values in an EXR: one warning", said.count("\n") == 1
                 and "a LUT that is baked with --display linear" in said, said)
    png, _ = applied("adobe.cube", "out.png")
    report.check("apply --lut of a file that says nothing: no tag", not any(
        chunk_of(png, name) for name in (b"iCCP", b"sRGB", b"cICP", b"gAMA")))


@pytest.mark.share(2)
def test_wild(report, command, folder):
    """Spellings that are about mean the same."""
    cube = GOOD["adobe.cube"]
    body = rows(CUBE)
    wild = {
        "CRLF": cube.replace("\n", "\r\n"),
        "comments and empty lines before the rows": cube.replace("DOMAIN_MIN", "\n# one\n\n#two\nDOMAIN_MIN"),
        "no TITLE": cube.split("\n", 1)[1],
        "lower case": cube.replace("LUT_3D_SIZE", "lut_3d_size").replace("DOMAIN", "domain"),
        "no domain": f"LUT_3D_SIZE {SIZE}\n" + body,
        "LUT_3D_INPUT_RANGE": f"LUT_3D_SIZE {SIZE}\nLUT_3D_INPUT_RANGE 0.0 1.0\n" + body,
        "TITLE and LUT_3D_INPUT_RANGE": f'TITLE "x"\nLUT_3D_SIZE {SIZE}\nLUT_3D_INPUT_RANGE 0 1\n' + body,
        "LUT_3D_INPUT_RANGE first": f"LUT_3D_INPUT_RANGE 0 1\nLUT_3D_SIZE {SIZE}\n" + body,
        "exponents": cube.replace("0.05\n", "5e-2\n"),
        "tabs and spaces": cube.replace(" ", "\t  "),
        "no newline at the end": cube.rstrip("\n"),
        "empty lines at the end": cube + "\n\n \n",
        "a size with a comment's line before": "#LUT_3D_SIZE 99\n" + cube,
    }
    truth = interpolate(CUBE, COLORS)
    for what, text in wild.items():
        path = folder / "wild.cube"
        path.write_bytes(text.encode())
        report.compare(f".cube: {what}", evaluate_lut(command, path, COLORS), truth, FLOAT32)
    path.write_text(cube.replace("DOMAIN_MAX 1 1 1", "DOMAIN_MAX 2 4 8"))
    report.compare(".cube: DOMAIN_MAX 2 4 8", evaluate_lut(command, path, COLORS * [2, 4, 8]), truth, FLOAT32)
    path.write_text(GOOD["resolve.cube"].replace("INPUT_RANGE 0 1", "INPUT_RANGE -1 3"))
    report.compare(".cube: LUT_3D_INPUT_RANGE -1 3", evaluate_lut(command, path, COLORS * 4 - 1), truth, FLOAT32)
    for name in GOOD:
        path = folder / f"crlf_{name}"
        path.write_bytes(GOOD[name].replace("\n", "\r\n").encode())
        report.compare(f"CRLF: {name}", evaluate_lut(command, path, COLORS), expected_of(name, COLORS), FLOAT32)
        path.write_bytes(b"\xef\xbb\xbf" + GOOD[name].encode())
        report.compare(f"a byte order mark: {name}", evaluate_lut(command, path, COLORS), expected_of(name, COLORS), FLOAT32)


@pytest.mark.share(2)
def test_xml(report, command, folder):
    """Names without regard to case, all that Arrays may stand in, and free text."""
    cube, curve = GOOD["cube.clf"], GOOD["curve.clf"]
    truth = interpolate(CUBE, COLORS)
    described = cube.replace("<LUT3D", "<Description>\nin 2019\nout of the box\nwidth 1920\nlength 7\n</Description>\n<LUT3D")
    for what, text in (("upper case", cube.replace("Array", "ARRAY").replace("LUT3D", "LUT3d")), ("free text", described),
                       ("a comment with tags", cube.replace("<LUT3D", "<!-- <Array dim='9'> -->\n<LUT3D"))):
        path = folder / "wild.clf"
        path.write_text(text)
        report.compare(f".clf: {what}", evaluate_lut(command, path, COLORS), truth, FLOAT32)
    # Inputs at indices of the table: Common LUT Format 2 (Academy S-2014-006); version 3 has it no more.
    for lowest, highest in ((0, 0.5), (-0.25, 0.75)):
        path = folder / f"indices{highest}.clf"
        path.write_text(cube.replace('"3"', '"2.0"', 1).replace(
            "<Array", f'<IndexMap dim="2">{lowest}@0 {highest}@{SIZE - 1}</IndexMap>\n<Array'))
        report.compare(f".clf: IndexMap {lowest} to {highest}", evaluate_lut(command, path, COLORS),
                       interpolate(CUBE, (COLORS - lowest) / (highest - lowest)), FLOAT32)
    path = folder / "wild.clf"
    path.write_text(cube.replace("<LUT3D", "<Unknown/>\n<LUT3D"))
    status, out, err, _ = peak_of([command, "eval", "--lut", path, "--input-encoding", "none"], "0.1 0.2 0.3\n")
    report.check(".clf: an element that OpenColorIO warns of, without its warning",
                 status == 0 and len(out.split()) == 3 and not err, (status, err))
    corrected = np.clip(COLORS, 0, None)
    for name, text in (("wild.cc", CORRECTION), ("wild.spimtx", MATRIX)):
        (folder / name).write_text(text)
        # A power of 1: OpenColorIO's fast one may stand there, 15 bits.
        report.compare(f"{name}: slope and offset", evaluate_lut(command, folder / name, corrected),
                       corrected * [2, 0.5, 1] + [0, 0, 0.1], FLOAT32)
    # Autodesk's inverses: what went in comes out. The curve's least slope is a tenth, the cube's about as much.
    inside = np.random.default_rng(8).uniform(0.1, 0.9, (64, 3)).astype(np.float32).astype(float)
    header = '<ProcessList version="1.6" id="x">\n'
    for what, text, shown in (
            ("InverseLUT1D", header + curve.split("\n", 2)[2].replace("LUT1D", "InverseLUT1D"), linear(TRIPLES, inside)),
            ("InverseLUT3D", header + GOOD["cube.ctf"].split("\n", 2)[2].replace("LUT3D", "InverseLUT3D"),
             interpolate(CUBE, inside))):
        path = folder / "inverse.ctf"
        path.write_text(text)
        report.compare(f".ctf: {what}", evaluate_lut(command, path, shown), inside, 1e-4)


@pytest.mark.share(2)
def test_early_end(report, command, folder):
    """A file that has less than its size says: those of Linux's sysfs have 4096 bytes, and hold a line."""
    short = [path for path in ("/sys/kernel/mm/transparent_hugepage/enabled", "/sys/kernel/notes", "/sys/devices/system/cpu/online",
                               "/sys/devices/system/cpu/possible")
             if os.access(path, os.R_OK) and os.path.getsize(path) > len(Path(path).read_bytes())]
    if not short:
        skip("a file that ends early: there is none in /sys")
    (folder / "early.cube").symlink_to(short[0])
    status, out, err, _ = peak_of([command, "eval", "--lut", folder / "early.cube"], "")
    report.check("a file that ends early", status == 3 and not out and err.count("\n") == 1 and "ends early" in err, err)


def test_usage(report, command, folder):
    path = folder / "adobe.cube"
    for arguments, words in ((["--interpolation", "cubic"], "interpolation is cubic; auto, tetrahedral or trilinear"),
                             (["--input-encoding", "acescc"], "acescc; did you mean acescct?"),
                             (["--input", "lin_ap1"], "--input is given; --input-encoding"),
                             (["--exposure", "1"], "--exposure is given; --input-encoding"),
                             (["--lut-space", "lin_ap1"], "--lut-space is given; --input-encoding"),
                             (["--input-encoding", "srgb", "--lut-space", "nowhere"], "nowhere"),
                             (["--input-encoding", "srgb", "--exposure", "99"], "exposure is 99; [-64, 64]"),
                             (["--display", "srgb"], "--display and --lut are given; expected one of them"),
                             (["--set", "white=2"], "--set and --lut are given; expected one of them")):
        for before in (["eval"], ["apply", folder / "in.exr", folder / "none.exr"]):
            status, out, err, _ = peak_of([command, *before, "--lut", path, *arguments], "")
            report.check(f"{before[0]} --lut {' '.join(arguments)}: {words}",
                         status == 2 and not out and err.count("\n") == 1 and all(w in err for w in words.split("; "))
                         and not (folder / "none.exr").exists(), err)
    for arguments, words in ((["eval", "hable", "--lut", path], "OPERATOR and --lut are given; expected one of them"),
                             (["eval"], "OPERATOR is missing; --lut FILE"),
                             (["eval", "hable", "--interpolation", "trilinear"], "--interpolation is trilinear; expected --lut FILE with it"),
                             (["eval", "--lut", folder / "link4.icc", "--interpolation", "trilinear"], "tetrahedral; link4.icc")):
        status, out, err, _ = peak_of([command, *arguments], "")
        report.check(f"{' '.join(Path(a).name for a in map(str, arguments))}: {words}",
                     status == 2 and not out and err.count("\n") == 1 and all(w in err for w in words.split("; ")), err)
