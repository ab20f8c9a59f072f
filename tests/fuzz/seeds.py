# SPDX-License-Identifier: Apache-2.0
"""Good LUT files for fuzz_lut_file to begin with: one of each format, behind the byte that chooses it.

    /usr/bin/python3 tests/fuzz/seeds.py build/fuzz/seeds
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from test_lut_files import GOOD, RAW  # noqa: E402

# The order of kFormats in src/lut/lut_text.cpp; then .raw, .icc.
FORMATS = ["cube", "clf", "ctf", "spi1d", "spi3d", "csp", "3dl", "lut", "itx", "cub", "vf", "m3d", "mga", "spimtx", "cc", "ccc",
           "cdl"]

folder = Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
for name, text in GOOD.items():
    (folder / name).write_bytes(bytes([FORMATS.index(name.rsplit(".", 1)[1])]) + text.encode())
(folder / "cube.raw").write_bytes(bytes([len(FORMATS)]) + RAW)
for path in map(Path, sys.argv[2:]):  # device links of `tonewright bake --format icc`
    (folder / path.name).write_bytes(bytes([len(FORMATS) + 1]) + path.read_bytes())
