# SPDX-License-Identifier: Apache-2.0
"""three.js in Chromium: its LUTCubeLoader and LUTPass with a .cube of `tonewright bake`, on WebGL 2 without a GPU.

    python3 -m pytest tests/parity/clients/test_threejs.py --tonewright build/release/bin/tonewright

three.js and what drives the browser come from npm, into the build folder.
"""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from lut_client import FLOAT32, HEIGHT, WIDTH, Client
from lut_tables import trilinear
from pictures import need_program, run, skip

PACKAGES = ["three@0.187.0", "playwright-core@1.65.1"]


def npm_modules(build):
    """Their folder; installed on the first run."""
    folder = build / "npm"
    modules = folder / "node_modules"
    wanted = folder / "packages.txt"
    if not wanted.is_file() or wanted.read_text().split() != PACKAGES:
        folder.mkdir(exist_ok=True)
        done = subprocess.run(["npm", "install", "--prefix", str(folder), "--no-audit", "--no-fund", *PACKAGES],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            skip(f"npm cannot install {' '.join(PACKAGES)} ({(done.stderr.strip().splitlines() or ['no reason'])[-1]})")
        wanted.write_text("\n".join(PACKAGES))
    return modules


@pytest.mark.parametrize("client", [Client("Chromium", "chromium", "chromium", "chromium --version")], ids=str)
def test_cube(test):
    need_program("node", "nodejs")
    need_program("npm", "npm")
    cube, table, stated = test.cube("threejs")
    codes = np.concatenate([test.codes, np.ones((HEIGHT, WIDTH, 1), np.float32)], axis=-1)
    codes.astype("<f4").tofile(test.scratch / "codes.raw")
    outs = {kind: test.scratch / f"{kind}.raw" for kind in ("FloatType", "UnsignedByteType")}
    job = {"width": WIDTH, "height": HEIGHT, "codes": str(test.scratch / "codes.raw"),
           "pictures": [{"cube": str(cube), "type": kind, "out": str(out)} for kind, out in outs.items()]}
    (test.scratch / "job.json").write_text(json.dumps(job))
    script = Path(__file__).with_name("threejs.mjs")
    said = run("node", script, npm_modules(test.command.parent.parent), shutil.which("chromium"),
               test.scratch / "job.json").strip()
    print(said)
    test.version = said.split(",")[0] + "," + said.split(",")[-1]
    shown = {kind: np.fromfile(out, "<f4").reshape(HEIGHT, WIDTH, 4)[..., :3] for kind, out in outs.items()}
    test.compare(".cube 33, setType(FloatType)", shown["FloatType"], trilinear(table, test.flat), stated, FLOAT32,
                 clips=False)
    # The loader's default is a table of bytes, which it cuts off instead of rounding: up to a code of 8 bits too dark.
    bytes_ = np.floor(table * 255) / 255
    test.compare(".cube 33, as it is: bytes", shown["UnsignedByteType"], trilinear(bytes_, test.flat), stated + 1 / 255,
                 FLOAT32, clips=False)
