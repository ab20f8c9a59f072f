# SPDX-License-Identifier: Apache-2.0
"""Reading LUT files like OpenColorIO and ffmpeg: each dialect of each format, with the same numbers or refused by all.

    python3 -m pytest tests/parity/test_lut_readers.py --tonewright build/release/bin/tonewright

The script writes small files from the formats' specifications, and reads each with `tonewright eval --lut`, with
PyOpenColorIO and, where ffmpeg has the format, with its filters. A file that OpenColorIO does not read has its reason in
the table below.
"""

import shutil
import struct
import subprocess

import numpy as np
import pytest

ocio = pytest.importorskip("PyOpenColorIO", reason="PyOpenColorIO is not installed (Debian: python3-pyopencolorio)")

# All readers interpolate in float: a few roundings of numbers up to 1.
FLOAT32 = 2e-6
# ffmpeg scales positions by a rounded reciprocal, and rounds in another order.
FFMPEG = 1e-5
COLORS = np.random.default_rng(7).uniform(0, 1, (64, 3)).astype(np.float32)
N = 3
AXIS = np.linspace(0, 1, N)
B, G, R = np.meshgrid(AXIS, AXIS, AXIS, indexing="ij")
CUBE = np.round(np.stack([R ** 2 * 0.7 + 0.2 * G, G ** 3 * 0.6 + 0.3 * B, B * 0.5 + 0.1 * R * G + 0.05], -1), 4)
CURVE = np.round(np.linspace(0, 1, 5) ** 2 * 0.8 + 0.1, 4)
TRIPLES = np.stack([CURVE, CURVE * 0.9, CURVE * 0.5 + 0.1], -1)


def rows(table):
    return "".join(f"{r:.6g} {g:.6g} {b:.6g}\n" for r, g, b in table.reshape(-1, 3))


def codes(table, largest, index=False):
    """Whole numbers, with blue fastest."""
    whole = np.round(table.transpose(2, 1, 0, 3) * largest).astype(int).reshape(-1, 3)
    return "".join((f"{i} " if index else "") + f"{r} {g} {b}\n" for i, (r, g, b) in enumerate(whole))


RED_FIRST = rows(CUBE)
BLUE_FIRST = rows(CUBE.transpose(2, 1, 0, 3))
SIZE = f"LUT_3D_SIZE {N}\n"
SIZE_1D = f"LUT_1D_SIZE {len(CURVE)}\n"
HEX = "".join(struct.pack("<f", v).hex().upper() for v in CUBE.reshape(-1))
FIVE = np.stack([np.linspace(0, 1, 5)[np.indices((5, 5, 5))[2 - c]] for c in range(3)], -1) ** 1.5
LARGE = rows(np.stack([np.linspace(0, 1, 33)[np.indices((33, 33, 33))[c]] for c in range(3)], -1) ** [1.5, 2, 0.5])
CSP = "CSPLUTV100\n3D\n\n"
HOUDINI = f"Version 2\nFormat any\nType 3D\nFrom 0 1\nTo 0 1\nBlack 0\nWhite 1\nLength {N}\nLUT:\n {{\n{RED_FIRST} }}\n"
CLF = ('<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList compCLFversion="3" id="x">\n<LUT3D inBitDepth="32f" '
       f'outBitDepth="32f" interpolation="tetrahedral">\n<Array dim="{N} {N} {N} 3">\n{BLUE_FIRST}</Array>\n</LUT3D>\n'
       "</ProcessList>\n")
SPI1D = f"Version 1\nFrom 0 1\nLength {len(CURVE)}\nComponents 1\n{{\n" + "".join(f"{v}\n" for v in CURVE) + "}\n"
SPI3D = f"SPILUT 1.0\n3 3\n{N} {N} {N}\n" + "".join(
    f"{r} {g} {b} {' '.join(f'{v:.6g}' for v in CUBE[b, g, r])}\n" for r in range(N) for g in range(N) for b in range(N))
CUB = f"# Truelight Cube v2.0\n# iDims 3\n# oDims 3\n# width {N} {N} {N}\n"
INPUT = rows(np.repeat(CURVE[:, None], 3, axis=1) * (N - 1))
LONG_CUB = CUB + f"# lutLength {len(CURVE)}\n# InputLUT\n{INPUT}\n# Cube\n{RED_FIRST}\n# end\n"
VF = f"#Inventor V2.1 ascii\ngrid_size {N} {N} {N}\n"
PANDORA = f"channel 3d\nin {N ** 3}\nout 4096\nformat lut\nvalues red green blue\n"
MATRIX = "2 0.1 0 0\n0 0.5 0.2 0\n0 0 1 6553.5\n"
CC = ('<ColorCorrection id="x">\n<SOPNode><Slope>1.2 0.9 1</Slope><Offset>0 0.01 0.1</Offset><Power>1 1.1 1</Power>'
      "</SOPNode>\n<SatNode><Saturation>0.8</Saturation></SatNode>\n</ColorCorrection>\n")

BOTH, NEITHER, OURS = "both", "neither", "ours"
# (file, what is in it, text, who reads it: ours and OpenColorIO, the words of our refusal or why OpenColorIO cannot)
FILES = (
    ("a.cube", "Adobe's", 'TITLE "x"\n# c\n' + SIZE + "DOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\n" + RED_FIRST, BOTH, ""),
    ("a.cube", "DOMAIN_MAX before the size", "DOMAIN_MAX 1 2 4\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.cube", "DOMAIN_MIN after the size", SIZE + "DOMAIN_MIN -1 -0.5 0\n" + RED_FIRST, BOTH, ""),
    ("a.cube", "TITLE without quotation marks", "TITLE my film 5\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.cube", "TITLE after the size", SIZE + "TITLE x\n" + RED_FIRST, BOTH, ""),
    ("a.cube", "CRLF", (SIZE + RED_FIRST).replace("\n", "\r\n"), BOTH, ""),
    ("a.cube", "comments between rows", SIZE + RED_FIRST.replace("\n", "\n# c\n", 3), BOTH, ""),
    ("a.cube", "lower case", SIZE.lower() + RED_FIRST, BOTH, ""),
    ("a.cube", "a byte order mark before a title", "\ufeffTITLE x\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.cube", "a byte order mark before a comment", "\ufeff# c\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.cube", "a byte order mark before the size", "\ufeff" + SIZE + RED_FIRST, OURS, "OpenColorIO sees no size"),
    ("a.cube", "an application's keyword", "VENDOR_KEY 5 text\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.cube", "LUT_IN_VIDEO_RANGE", "LUT_IN_VIDEO_RANGE\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.cube", "a keyword after the size", SIZE + "VENDOR_KEY\n" + RED_FIRST, NEITHER, "keyword is VENDOR_KEY"),
    ("a.cube", "Resolve's range", SIZE + "LUT_3D_INPUT_RANGE -0.5 1.5\n" + RED_FIRST, BOTH, ""),
    ("a.cube", "TITLE and Resolve's range", "TITLE x\n" + SIZE + "LUT_3D_INPUT_RANGE 0 2\n" + RED_FIRST, OURS,
     "OpenColorIO has a reader for one of them each"),
    ("a.cube", "a 1D LUT", SIZE_1D + rows(TRIPLES), BOTH, ""),
    ("a.cube", "a 1D LUT with a domain", SIZE_1D + "DOMAIN_MIN 0 0 0\nDOMAIN_MAX 2 2 2\n" + rows(TRIPLES), BOTH, ""),
    ("a.cube", "a 1D LUT with a range", SIZE_1D + "LUT_1D_INPUT_RANGE 0 2\n" + rows(TRIPLES), BOTH, ""),
    ("a.cube", "a 1D LUT and a keyword", "VENDOR_KEY 5\n" + SIZE_1D + rows(TRIPLES), OURS, "ffmpeg reads it"),
    ("a.cube", "a 1D and a 3D LUT", SIZE_1D + "LUT_1D_INPUT_RANGE 0 1\n" + SIZE + "LUT_3D_INPUT_RANGE 0 1\n"
     + rows(TRIPLES) + RED_FIRST, BOTH, ""),
    ("a.cube", "a 2D table", "LUT_2D_SIZE 3\n" + RED_FIRST, NEITHER, "keyword is LUT_2D_SIZE"),
    ("a.cube", "a row is missing", SIZE + RED_FIRST.split("\n", 1)[1], NEITHER, "the table ends after 26 rows"),
    ("a.cube", "two numbers in a row", SIZE + RED_FIRST.replace(" ", "", 1), NEITHER, "expected three numbers"),
    ("a.3dl", "Lustre's", "3DMESH\nMesh 2 12\n0 256 512 767 1023\n" + codes(FIVE, 4095) + "\nLUT8\ngamma 1.0\n", BOTH, ""),
    ("a.3dl", "Flame's", "0 256 512 767 1023\n" + codes(FIVE, 4095), BOTH, ""),
    ("a.3dl", "16 bits", "0 256 512 767 1023\n" + codes(FIVE, 65535), BOTH, ""),
    ("a.3dl", "a shaper that is a curve", "0 100 300 600 1023\n" + codes(FIVE, 4095), BOTH, ""),
    ("a.3dl", "no line of nodes", codes(FIVE, 1023), BOTH, ""),
    ("a.3dl", "an application's keyword", "Vendor v1\n0 256 512 767 1023\n" + codes(FIVE, 4095), BOTH, ""),
    ("a.3dl", "floats", RED_FIRST, NEITHER, "expected"),
    ("a.csp", "3D", CSP + "2\n0 1\n0 1\n" * 3 + f"\n{N} {N} {N}\n" + RED_FIRST, BOTH, ""),
    ("a.csp", "metadata", CSP + "BEGIN METADATA\nwho\nEND METADATA\n" + "2\n0 1\n0 1\n" * 3 + f"{N} {N} {N}\n" + RED_FIRST,
     BOTH, ""),
    ("a.csp", "1D", CSP.replace("3D", "1D") + "2\n0 1\n0 1\n" * 3 + f"\n{len(CURVE)}\n" + rows(TRIPLES), BOTH, ""),
    ("a.csp", "a prelut of 2", CSP + "2\n0 2\n0 1\n" * 3 + f"\n{N} {N} {N}\n" + RED_FIRST, BOTH, ""),
    ("a.csp", "a byte order mark", "\ufeff" + CSP + "2\n0 1\n0 1\n" * 3 + f"\n{N} {N} {N}\n" + RED_FIRST, OURS,
     "OpenColorIO wants its first word first"),
    ("a.spi1d", "one component", SPI1D, BOTH, ""),
    ("a.spi1d", "three components", SPI1D.split("{")[0].replace("Components 1", "Components 3") + "{\n" + rows(TRIPLES)
     + "}\n", BOTH, ""),
    ("a.spi1d", "a range", SPI1D.replace("From 0 1", "From -0.5 2"), BOTH, ""),
    ("a.spi1d", "an application's keyword", SPI1D.replace("Length", "Vendor x\nLength"), BOTH, ""),
    ("a.spi1d", "no length", SPI1D.replace("Length", "Len"), NEITHER, "Length is missing"),
    ("a.spi3d", "its", SPI3D, BOTH, ""),
    ("a.spimtx", "its", MATRIX, BOTH, ""),
    ("a.cub", "a 3D LUT", CUB + "# Cube\n" + RED_FIRST + "# end\n", BOTH, ""),
    ("a.cub", "both tables", LONG_CUB, BOTH, ""),
    ("a.cub", "both tables, CRLF", LONG_CUB.replace("\n", "\r\n"), BOTH, ""),
    ("a.cub", "a 1D LUT", f"# Truelight Cube v2.0\n# lutLength {len(CURVE)}\n# InputLUT\n" + rows(TRIPLES), BOTH, ""),
    ("a.cub", "no end", LONG_CUB.replace("# end\n", ""), BOTH, ""),
    ("a.cub", "a row is missing", LONG_CUB.replace("# Cube\n" + RED_FIRST.split("\n", 1)[0], "# Cube"), NEITHER,
     "the table ends after 26 rows"),
    ("a.cub", "unequal sizes", LONG_CUB.replace(f"{N} {N} {N}", f"{N} {N} 4"), NEITHER, "three equal sizes"),
    ("a.cub", "another first line", LONG_CUB.replace("Truelight", "True"), NEITHER, "# Truelight Cube v2.0"),
    ("a.itx", "its", SIZE + RED_FIRST, BOTH, ""),
    ("a.itx", "an application's keyword", "Vendor x\n" + SIZE + RED_FIRST, BOTH, ""),
    ("a.vf", "its", VF + "element_size 0.25\nworld_origin 0 0 0\ndata\n" + BLUE_FIRST, BOTH, ""),
    ("a.vf", "a transform", VF + f"global_transform {1 / N} 0 0 0 0 {1 / N} 0 0 0 0 {0.5 / N} 0 0 0 0 1\ndata\n"
     + BLUE_FIRST, BOTH, ""),
    ("a.vf", "a row is missing", VF + "data\n" + BLUE_FIRST.split("\n", 1)[1], NEITHER, "the table ends after 26 rows"),
    ("a.m3d", "its", PANDORA + codes(CUBE, 4095, True), BOTH, ""),
    ("a.mga", "its", PANDORA + codes(CUBE, 4095, True), BOTH, ""),
    ("a.mga", "a row is missing", PANDORA + codes(CUBE, 4095, True).split("\n", 1)[1], NEITHER, "the table ends after 26"),
    ("a.mga", "no cube of a whole number", PANDORA.replace("27", "28") + codes(CUBE, 4095, True), NEITHER, "N x N x N"),
    ("a.lut", "Houdini's", HOUDINI, BOTH, ""),
    ("a.lut", "Discreet's", "LUT: 1 256\n" + "".join(f"{255 - i}\n" for i in range(256)), BOTH, ""),
    ("a.clf", "a 3D LUT", CLF, BOTH, ""),
    ("a.ctf", "a 3D LUT", CLF.replace('compCLFversion="3"', 'version="1.4"'), BOTH, ""),
    ("a.cc", "a correction", CC, BOTH, ""),
    ("a.m3d", "no index", PANDORA + codes(CUBE, 4095), BOTH, ""),
    ("a.dat", "DaVinci's", f"3DLUTSIZE {N}\n" + BLUE_FIRST, OURS, "ffmpeg reads 33 nodes a side alone"),
    ("a.dat", "DaVinci's of 33", "3DLUTSIZE 33\n" + LARGE, OURS, "ffmpeg reads it"),
    ("a.dat", "no size", LARGE, OURS, "ffmpeg reads it"),
    ("a.dat", "a row is missing", f"3DLUTSIZE {N}\n" + BLUE_FIRST.split("\n", 1)[1], NEITHER, "the table ends after 26"),
    ("a.look", "Iridas's", f'<?xml version="1.0" ?>\n<look>\n<LUT>\n<size>"{N}"</size>\n<data>"\n{HEX}"</data>\n</LUT>\n'
     "</look>\n", BOTH, ""),
    ("a.look", "a number is missing", f'<look>\n<LUT>\n<size>"{N}"</size>\n<data>"{HEX[8:]}"</data>\n</LUT>\n</look>\n',
     NEITHER, "data has 640 digits; expected 648"),
    ("a.look", "a mask", f'<look>\n<mask><name>m</name></mask>\n<LUT>\n<size>"{N}"</size>\n<data>"{HEX}"</data>\n</LUT>\n'
     "</look>\n", NEITHER, "it has a mask"),
    ("a.ccc", "many corrections", f"<ColorCorrectionCollection>\n{CC}</ColorCorrectionCollection>\n", NEITHER,
     "extension is .ccc; expected .cube"),
    ("a.cdl", "many corrections", f"<ColorDecisionList>\n<ColorDecision>\n{CC}</ColorDecision>\n</ColorDecisionList>\n", NEITHER,
     "extension is .cdl; expected .cube"),
)
# Those that ffmpeg's filters read, by what is in them.
FFMPEG_FILES = {("a.cube", "Adobe's"): "lut3d", ("a.cube", "CRLF"): "lut3d", ("a.cube", "an application's keyword"): "lut3d",
                ("a.cube", "a byte order mark before a title"): "lut3d", ("a.cube", "a 1D LUT"): "lut1d",
                ("a.cube", "a 1D LUT and a keyword"): "lut1d", ("a.cube", "a 1D LUT with a range"): "lut1d",
                ("a.dat", "DaVinci's of 33"): "lut3d", ("a.dat", "no size"): "lut3d", ("a.m3d", "no index"): "lut3d",
                ("a.csp", "3D"): "lut3d"}


@pytest.fixture(scope="module", autouse=True)
def logging_level():
    """OpenColorIO prints nothing about files that it refuses."""
    level = ocio.GetLoggingLevel()
    ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_NONE)
    yield
    ocio.SetLoggingLevel(level)


def of_ours(command, path):
    lines = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in COLORS.tolist())
    done = subprocess.run([command, "eval", "--lut", path], input=lines, capture_output=True, text=True, check=False)
    if done.returncode:
        return None, done
    return np.array([[float(v) for v in line.replace(",", " ").split()] for line in done.stdout.splitlines()]), done


def of_opencolorio(path):
    transform = ocio.FileTransform(src=str(path), interpolation=ocio.INTERP_BEST)
    image = COLORS.copy()
    try:
        processor = ocio.Config.CreateRaw().getProcessor(transform)
    except ocio.Exception:
        return None
    processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
    return image


def of_ffmpeg(path, kind):
    planes = np.ascontiguousarray(COLORS[:, [1, 2, 0]].T)
    interpolation = "tetrahedral" if kind == "lut3d" else "linear"
    form = ["-f", "rawvideo", "-pix_fmt", "gbrpf32le"]
    done = subprocess.run(["ffmpeg", "-v", "error", *form, "-s", f"{len(COLORS)}x1", "-i", "-", "-vf",
                           f"{kind}=file={path.name}:interp={interpolation}", *form, "-"], input=planes.tobytes(),
                          capture_output=True, check=False, cwd=path.parent)
    if done.returncode or len(done.stdout) != planes.nbytes:
        return None
    return np.frombuffer(done.stdout, np.float32).reshape(3, -1).T[:, [2, 0, 1]]


@pytest.mark.parametrize(("file", "what", "text", "who", "words"), FILES, ids=[f"{file[2:]}, {what}" for file, what, *_ in FILES])
def test_file(report, command, scratch, file, what, text, who, words):
    # A folder each: OpenColorIO keeps files by their names.
    path = scratch / file
    path.write_bytes(text.encode())
    title = f"{file[1:]}, {what}"
    (ours, done), theirs = of_ours(command, path), of_opencolorio(path)
    report.check(f"{title}: OpenColorIO {'reads' if who == BOTH else 'refuses'} it", (theirs is not None) == (who == BOTH))
    if who == NEITHER:
        report.check(f"{title}: refused in one line", done.returncode == 3 and words in done.stderr
                     and done.stderr.count("\n") == 1, done.stderr)
        return
    if not report.check(f"{title}: Tonewright reads it", ours is not None, done.stderr):
        return
    if who == BOTH:
        report.compare(f"{title}: as OpenColorIO", ours, theirs.astype(float), FLOAT32)
    said = "is unknown and ignored" in done.stderr
    report.check(f"{title}: a line names a keyword that is ignored", said == ("keyword" in what or what.startswith("LUT_IN")),
                 done.stderr)
    kind = FFMPEG_FILES.get((file, what))
    # ffmpeg is not asked about DOMAIN_MIN: ffmpeg 5.1 divides by the domain and does not subtract its beginning.
    if kind and not shutil.which("ffmpeg"):
        print("skipped: the comparison with ffmpeg, which is not installed")
    elif kind:
        shown = of_ffmpeg(path, kind)
        if report.check(f"{title}: ffmpeg reads it", shown is not None):
            report.compare(f"{title}: as ffmpeg", ours, shown.astype(float), FFMPEG)
