# SPDX-License-Identifier: Apache-2.0
"""Good files for the fuzz targets to begin with, in a folder for each target.

    /usr/bin/python3 tests/fuzz/seeds.py build/fuzz/seeds

Texts and LUT files stand behind the byte that chooses the reader. Formulas, response curves and some shaders are the texts of the unit tests.
"""

import json
import re
import shutil
import struct
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / folder) for folder in ("cli", "parity/clients", "../python_check")]
from test_lut_files import FOREIGN, GOOD, RAW  # noqa: E402
from test_lut_operators import nodes, shared_exponent, write_dds  # noqa: E402

# The order of kFormats in src/lut/lut_text.cpp; then .raw, .icc.
FORMATS = ["cube", "clf", "ctf", "spi1d", "spi3d", "csp", "3dl", "lut", "itx", "cub", "vf", "m3d", "mga", "spimtx", "cc", "ccc",
           "cdl"]


def strings_of(path):
    """The string literals of a C++ file; those that follow each other are one."""
    for run in re.findall(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+', path.read_text()):
        text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', run))
        yield text.replace(r"\n", "\n").replace(r"\"", '"').replace(r"\\", "\\")


def folder_of(target):
    folder = Path(sys.argv[1]) / target
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def write_texts(target, texts):
    for number, text in enumerate(dict.fromkeys(texts)):
        (folder_of(target) / f"{number}.txt").write_text(text)


def device_link(kind):
    """ICC.1:2010-12, 10.8 to 10.10: a table of two nodes a side, with linear curves before and behind it."""
    nodes = [65535 * (node >> place & 1) for node in range(8) for place in (2, 1, 0)]
    matrix = struct.pack(">9i", *(65536 * (i % 4 == 0) for i in range(9)))
    if kind == "mft1":
        ramp = bytes(range(256)) * 3
        tag = b"mft1" + bytes([0, 0, 0, 0, 3, 3, 2, 0]) + matrix + ramp + bytes(v >> 8 for v in nodes) + ramp
    elif kind == "mft2":
        ramp = struct.pack(">6H", *[0, 65535] * 3)
        tag = (b"mft2" + bytes([0, 0, 0, 0, 3, 3, 2, 0]) + matrix + struct.pack(">2H", 2, 2) + ramp
               + struct.pack(">24H", *nodes) + ramp)
    else:
        curves = (b"curv" + bytes(8)) * 3
        table = bytes([2] * 3 + [0] * 13 + [2, 0, 0, 0]) + struct.pack(">24H", *nodes)
        # B, then neither matrix nor M, the table, A.
        tag = b"mAB " + bytes([0, 0, 0, 0, 3, 3, 0, 0]) + struct.pack(">5I", 32, 0, 0, 68, 136) + curves + table + curves
    whole = 128 + 4 + 12 + len(tag)
    version = 0x02400000 if kind.startswith("mft") else 0x04300000
    header = struct.pack(">I4xI", whole, version) + b"linkRGB RGB " + bytes(12) + b"acsp" + bytes(28)
    header += struct.pack(">3I", 0xF6D6, 0x10000, 0xD32D)
    return header.ljust(128, b"\0") + struct.pack(">I", 1) + b"A2B0" + struct.pack(">2I", 144, len(tag)) + tag


for target in ("lut_file", "lut"):
    folder = folder_of(target)
    for name, text in (GOOD | FOREIGN).items():
        extension = name.rsplit(".", 1)[1]
        if extension in FORMATS:
            (folder / name).write_bytes(bytes([FORMATS.index(extension)]) + text.encode())
    (folder / "cube.raw").write_bytes(bytes([len(FORMATS)]) + RAW)
    for kind in ("mft1", "mft2", "mAB "):
        (folder / f"{kind.strip()}.icc").write_bytes(bytes([len(FORMATS) + 1]) + device_link(kind))

for name, dxgi, texels in (("rgb9e5", 67, shared_exponent(nodes(2))[0]),
                           ("rgba16f", 10, nodes(2).repeat(2, 1)[:, :4].astype("<f2").tobytes()),
                           ("rgba32f", 2, nodes(2).repeat(2, 1)[:, :4].astype("<f4").tobytes())):
    write_dds(folder_of("dds") / f"{name}.dds", 2, dxgi, texels)
    volume = (folder_of("dds") / f"{name}.dds").read_bytes()
    (folder_of("lut") / f"{name}.dds").write_bytes(bytes([len(FORMATS) + 2]) + volume)

UNIT = TESTS / "unit" / "formula"
write_texts("formula", [text for name in ("parse", "print") for text in strings_of(UNIT / f"{name}_test.cpp")])
write_texts("glsl", [text for source in sorted(UNIT.glob("glsl*_test.cpp")) for text in strings_of(source) if "(" in text])
for path in (TESTS / "data" / "glsl").iterdir():
    shutil.copy(path, folder_of("glsl"))
write_texts("definition", [text for source in (TESTS / "unit" / "definition").glob("*.cpp") for text in strings_of(source)
                           if "=" in text])
for path in (TESTS.parent / "docs" / "examples").glob("*.tone"):
    shutil.copy(path, folder_of("definition"))

UNIT = TESTS / "unit" / "operators"
write_texts("responses", ["\n" + text for text in strings_of(UNIT / "response_curve_test.cpp") if "\n" in text])
for path in (TESTS / "data").glob("synthetic_response*"):
    lines = path.read_text().splitlines()
    # Every tenth sample of the columns; the curves of DoRF whole.
    short = [line for number, line in enumerate(lines) if path.suffix == ".txt" or number % 10 == 0 or line == lines[-1]]
    (folder_of("responses") / path.name).write_text("\n" + "\n".join(short) + "\n")

# The readers of text.cpp in their order.
METERING = {
    "pixels": dict.fromkeys(("counted", "black", "nan", "infinite", "uncovered"), 1),
    "luminance": dict.fromkeys(("log_average", "geometric_mean", "mean", "minimum", "maximum", "histogram_average"), 0.5)
    | {"percentiles": dict.fromkeys(("1", "5", "25", "50", "75", "95", "99"), 0.5)},
    "histogram": [1, 2],
    "statistics": dict.fromkeys(("log_average", "mean_luminance", "minimum_luminance", "maximum_luminance"), 0.5)
    | {"mean_rgb": [1, 2, 3], "maximum_rgb": [1, 2, 3], "count": 1, "lit_count": 1},
}
OPTIONS = {"input": "auto", "subimage": 0, "unpremult": "as the picture says", "region": None, "delta": 0.001,
           "histogram_range": [-8.0, 3.5], "bins": 256, "percentiles": [0.0, 100.0], "exact": False}
CACHE = {"tonewright_meter_cache": 1, "options": OPTIONS,
         "pictures": {"/x/a.exr": {"bytes": 1, "modified": 2, "metering": METERING}}}
NUMBERS = struct.pack("<2d", 0.5, 2)
SUM = 0xCBF29CE484222325
for byte in NUMBERS:
    SUM = (SUM ^ byte) * 0x100000001B3 % 2**64
TEXTS = [
    ["agx_blender:look=punchy", "agx_blender\nlook=punchy", "AgX Blender Punchy", "reinhard:key=0.5 white=2",
     "reinhard_local:key=1", "camera_response:file=a\\:b.rf:curve=red", "drago:bias=0.7\nbias=0.8", "agx_blendr"],
    ["1001-1100", "1-9x2", "1,5,10-20", "-5--1", "20-10x3"],
    ["out.#.exr", "shot.%04d.exr", "a@b/shot.@@@@.exr", "shot.####.%d.exr"],
    ["0.18 0.18 0.18\n4,2,0.5 # comment\n\n", "nan inf -1e-400", "+1\t1e999\r 2,"],
    [json.dumps(CACHE, separators=(",", ":")), "{}"],
    [b"tonewright numbers 1\nk\n2 %016x\n" % SUM + NUMBERS],
    ["shot.exr.tonewright?op=hable&look=a&set.white=4", "a.tonewright?exposure=1&unpremult=yes&statistics=picture"],
    ["\N{BYTE ORDER MARK}file=a.exr\n# comment\nop = hable\nset.white=4\nreference_white=203\n", "file=x.tonewright\n"],
]
for kind, texts in enumerate(TEXTS):
    for number, text in enumerate(texts):
        data = text if isinstance(text, bytes) else text.encode()
        (folder_of("text") / f"{kind}_{number}").write_bytes(bytes([kind]) + data)

CONFIG = """ocio_profile_version: 2
environment: {SHOT: a}
search_path: [luts, tonewright]
roles: {aces_interchange: ap0, cie_xyz_d65_interchange: xyz, scene_linear: ap0}
file_rules:
  - !<Rule> {name: Default, colorspace: ap0}
displays:
  "sRGB":
    # Comment
    - !<View> {name: 'It''s', view_transform: vt, display_colorspace: sRGB, looks: +lk}
    - !<View> {name: Raw, colorspace: ap0}
active_displays: [sRGB]
active_views: It's, Raw
looks:
  - !<Look> {name: lk, process_space: ap0, transform: !<CDLTransform> {slope: [2, 1, 1]}}
view_transforms:
  - !<ViewTransform>
    name: vt
    description: |
      Two

      lines
    from_scene_reference: !<GroupTransform>
      children:
        - !<LookTransform> {src: ap0, dst: ap0, looks: "-lk|$SHOT"}
        - !<FileTransform> {src: $SHOT.cube}
display_colorspaces:
  - !<ColorSpace> {name: xyz}
  - !<ColorSpace> {name: sRGB, aliases: [s], from_display_reference: !<ExponentTransform> {value: 2.4, direction: inverse}}
colorspaces:
  - !<ColorSpace>
    name: ap0
    to_scene_reference: !<ColorSpaceTransform> {src: b, dst: ap0}
  - !<ColorSpace> {name: b, isdata: true}
"""
RECORD = """options:
  views: ["a"]
  displays: []
  looks: ["b"]
  operators:
    - name: "n"
      operator: "agx_blender:look=punchy"
  exposures: [1, -0.5]
files: ["c.spi3d"]
added:
  - before: "2\\n"
    text: "\\n  - a"
  - before: "a"
    text: ", b"
"""
for kind, text in enumerate((CONFIG, CONFIG, RECORD)):
    (folder_of("config") / str(kind)).write_bytes(bytes([kind]) + text.encode())
(folder_of("config") / "windows").write_bytes(b"\1" + ("\N{BYTE ORDER MARK}" + CONFIG).replace("\n", "\r\n").encode())
(folder_of("config") / "flow").write_bytes(b'\1{a: [b, "c"], d: {e: [], f: [g]}, h: "i", # j\n}')

(folder_of("config") / "utf16").write_bytes(b"\1" + ('a: "' + 20 * "\N{CJK UNIFIED IDEOGRAPH-4E00}" + '"\nb: [c]\n').encode("utf-16"))
(folder_of("config") / "cycle").write_bytes(b"\0" + CONFIG.replace("!<CDLTransform> {slope: [2, 1, 1]}",
                                                                   "&a !<GroupTransform> {children: [*a]}").encode())

for size in range(5):
    for channels in (2, 3, 66, 131):
        (folder_of("picture") / f"{size}_{channels}").write_bytes(bytes([size, 0, 0, channels]) + struct.pack("<3f", 0, 0.5, 2))


def profile(space, version, tags):
    """ICC.1:2022, 7: an input profile with these tags."""
    place, table, contents = 132 + 12 * len(tags), struct.pack(">I", len(tags)), b""
    for name, tag in tags:
        table += name + struct.pack(">2I", place + len(contents), len(tag))
        contents += tag.ljust((len(tag) + 3) // 4 * 4, b"\0")
    header = struct.pack(">I4xI", place + len(contents), version) + b"scnr" + space + b"XYZ " + bytes(12) + b"acsp" + bytes(28)
    header += struct.pack(">3I", 0xF6D6, 0x10000, 0xD32D)
    return header.ljust(128, b"\0") + table + contents


def xyz(*numbers):
    return b"XYZ " + bytes(4) + struct.pack(">3i", *(round(65536 * number) for number in numbers))


def curves(curve):
    return [(b"rTRC", curve), (b"gTRC", curve), (b"bTRC", curve)]


COLORANTS = [(b"rXYZ", xyz(0.61, 0.31, 0.02)), (b"gXYZ", xyz(0.21, 0.63, 0.06)), (b"bXYZ", xyz(0.15, 0.06, 0.745))]
GAMMA = b"curv" + struct.pack(">4xIH", 1, 563)
SAMPLED = b"curv" + struct.pack(">4xI5H", 5, 0, 4096, 16384, 36864, 65535)
PARAMETRIC = b"para" + struct.pack(">4xHxx5i", 3, 157286, 62119, 3417, 5073, 2651)
PROFILES = {"gamma": profile(b"RGB ", 0x02400000, COLORANTS + curves(GAMMA)),
            "sampled": profile(b"RGB ", 0x02400000, COLORANTS + curves(SAMPLED)),
            "parametric": profile(b"RGB ", 0x04300000, COLORANTS + curves(PARAMETRIC)),
            "cicp": profile(b"RGB ", 0x04400000, COLORANTS + curves(GAMMA) + [(b"cicp", b"cicp" + bytes(4) + b"\x09\x10\0\1")]),
            "gray": profile(b"GRAY", 0x02400000, [(b"kTRC", SAMPLED), (b"desc", b"desc" + struct.pack(">4xI", 5) + b"Gray\0")])}
for kind in ("mft1", "mft2", "mAB "):
    PROFILES[kind.strip()] = profile(b"RGB ", 0x02400000 if kind.startswith("mft") else 0x04300000,
                                     [(b"A2B0", device_link(kind)[144:])])
# ICC.1:2022, 10.16: curves, a matrix, a table.
segment = b"parf" + struct.pack(">4xHxx4f", 0, 2, 1, 0, 0)
curve = b"curf" + struct.pack(">4xHxx", 1) + segment
place = 12 + 8 * 3
elements = [b"cvst" + struct.pack(">4x2H", 3, 3) + struct.pack(">2I", place, len(curve)) * 3 + curve,
            b"matf" + struct.pack(">4x2H12f", 3, 3, 0.6, 0.2, 0.1, 0.3, 0.6, 0.1, 0, 0.1, 0.7, 0, 0, 0),
            b"clut" + struct.pack(">4x2H", 3, 3) + bytes([2] * 3 + [0] * 13)
            + struct.pack(">24f", *(node >> axis & 1 for node in range(8) for axis in (2, 1, 0)))]
places, contents = b"", b""
for element in elements:
    places += struct.pack(">2I", 16 + 8 * len(elements) + len(contents), len(element))
    contents += element
mpet = b"mpet" + struct.pack(">4x2HI", 3, 3, len(elements)) + places + contents
PROFILES["mpet"] = profile(b"RGB ", 0x04300000, [(b"A2B0", device_link("mft2")[144:]), (b"D2B1", mpet)])
for name, text in PROFILES.items():
    (folder_of("icc") / name).write_bytes(bytes([name == "gray"]) + text)
