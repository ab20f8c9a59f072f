# SPDX-License-Identifier: Apache-2.0
"""Good files for the fuzz targets to begin with, in a folder for each target.

    /usr/bin/python3 tests/fuzz/seeds.py build/fuzz/seeds [LINK.icc...]

LUT files stand behind the byte that chooses the format. Device links come from `tonewright bake --format icc`. Formulas and
some shaders are the texts of the unit tests.
"""

import re
import shutil
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "cli"))
from test_lut_files import GOOD, RAW  # noqa: E402
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


folder = folder_of("lut_file")
for name, text in GOOD.items():
    (folder / name).write_bytes(bytes([FORMATS.index(name.rsplit(".", 1)[1])]) + text.encode())
(folder / "cube.raw").write_bytes(bytes([len(FORMATS)]) + RAW)
for path in map(Path, sys.argv[2:]):
    (folder / path.name).write_bytes(bytes([len(FORMATS) + 1]) + path.read_bytes())

for name, dxgi, texels in (("rgb9e5", 67, shared_exponent(nodes(2))[0]),
                           ("rgba16f", 10, nodes(2).repeat(2, 1)[:, :4].astype("<f2").tobytes()),
                           ("rgba32f", 2, nodes(2).repeat(2, 1)[:, :4].astype("<f4").tobytes())):
    write_dds(folder_of("dds") / f"{name}.dds", 2, dxgi, texels)

UNIT = TESTS / "unit" / "formula"
write_texts("formula", strings_of(UNIT / "formula_test.cpp"))
write_texts("glsl", [text for text in strings_of(UNIT / "glsl_test.cpp") if "(" in text])
for path in (TESTS / "data" / "glsl").iterdir():
    shutil.copy(path, folder_of("glsl"))
write_texts("definition", [text for source in (TESTS / "unit" / "definition").glob("*.cpp") for text in strings_of(source)
                           if "=" in text])
for path in (TESTS.parent / "docs" / "examples").glob("*.tone"):
    shutil.copy(path, folder_of("definition"))
