#!/usr/bin/env python3
"""Files of `tonewright shader` for three.js, in a page in Chromium, against `tonewright eval`.

Modules of `--for threejs` and `--for threejs-tsl`; with TONEWRIGHT_TEST_ALL=1 the npm package, too: packed, installed, and
imported by the examples of its README. The pixels are those of a picture with the colors of executed.colors(), and of a
room that three.js renders.

Usage: test_threejs.py TONEWRIGHT [--picture FILE.png]
--picture keeps what the page shows of the room.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from browser import run_page
from executed import IS_FULL, colors, npm_modules, reference, skip

HERE = pathlib.Path(__file__).parent
WIDTH, HEIGHT = 64, 47  # a multiple of 64 has rows without padding in WebGPU
OPERATORS = ["agx_threejs", "aces_20", "khronos_neutral", "agx_blender:formula", "hable"]
# three.js encodes with the power 0.41666 for 1/2.4, up to 6.2e-6 off; these texts are up to 4.2e-5 off on llvmpipe.
FLOATS = 6.2e-6 + 4.2e-5
# Of a canvas: half a code of 8 bits, and what SwiftShader's rounding is off.
HALF_A_CODE = 0.5 / 255 + 1e-4


class Checks:
    failed = 0

    def check(self, what: str, is_ok: bool) -> None:
        self.failed += not is_ok
        print(f"{'ok  ' if is_ok else 'FAIL'} {what}")

    def compare(self, what: str, got: np.ndarray, right: np.ndarray, bound: float) -> None:
        error = np.abs(got.astype(float) - right).max()
        self.check(f"{what:60} {error:.2g}, bound {bound:.2g}", bool(error <= bound))  # false for NaN


def run(*arguments, folder: pathlib.Path) -> str:
    return subprocess.run([str(a) for a in arguments], cwd=folder, check=True, capture_output=True, text=True).stdout


def install_package(tonewright: str, folder: pathlib.Path) -> pathlib.Path:
    """Where npm puts the package that the tool writes."""
    run(f"{tonewright}_tools", "npm", "-o", folder / "package", "-q", folder=folder)
    tarball = folder / run("npm", "pack", "--silent", "./package", folder=folder).strip()
    page = folder / "page"
    page.mkdir()
    (page / "package.json").write_text("{}")
    run("npm", "install", "--offline", "--no-audit", "--no-fund", "--omit=peer", tarball, folder=page)
    return page / "node_modules/tonewright-shaders"


def main(tonewright: str, picture: str) -> int:
    for program, package in (("node", "nodejs"), ("npm", "npm")):
        if not shutil.which(program):
            skip(f"{program} is missing (Debian: {package})")
    tonewright = str(pathlib.Path(tonewright).resolve())
    modules = npm_modules(tonewright)
    checks = Checks()
    rgb = np.zeros((WIDTH * HEIGHT, 3), np.float32)
    rgb[:len(colors())] = colors()
    # three.js multiplies what it writes to a target by a matrix with zeros: infinities become NaN there.
    rgb = np.clip(rgb, np.float32(-65504), np.float32(65504))
    rgba = np.concatenate([rgb, np.ones((len(rgb), 1), np.float32)], axis=1)
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        files = {"/three/": modules / "three", "/light": rgba.tobytes(), "/modules/": folder}
        job = {"width": WIDTH, "height": HEIGHT, "webgl": [], "webgpu": [], "hasExamples": IS_FULL}
        for operator in OPERATORS:
            name = operator.replace(":", "_")
            run(tonewright, "shader", operator, "--for", "threejs", "-o", name + ".js", "-q", folder=folder)
            run(tonewright, "shader", operator, "--for", "threejs-tsl", "-o", name + ".tsl.js", "-q", folder=folder)
            job["webgl"].append({"module": f"/modules/{name}.js", "name": "use_tw_" + name, "hasRoom": operator == OPERATORS[0],
                                 "hasTables": "float[" in (folder / f"{name}.js").read_text()})
            job["webgpu"].append({"module": f"/modules/{name}.tsl.js", "name": "tw_" + name})
        imports = {"three": "/three/build/three.module.js", "three/webgpu": "/three/build/three.webgpu.js",
                   "three/tsl": "/three/build/three.tsl.js", "three/addons/": "/three/examples/jsm/"}
        if IS_FULL:
            package = install_package(tonewright, folder)
            examples = re.findall(r"```js\n(.*?)```", (package / "README.md").read_text(), re.S)
            for number, (example, made) in enumerate(zip(examples, ("renderer", "renderer", "material"), strict=True)):
                files[f"/example/{number}.js"] = f"{example}export {{ {made} }};\n".encode()
            files["/package/"] = package
            exports = json.loads((package / "package.json").read_text())["exports"]
            imports |= {"tonewright-shaders" + name[1:]: "/package" + entry["default"][1:] for name, entry in exports.items()}
            job["webgl"].append({"example": "/example/0.js", "name": "npm"})
            job["webgpu"].append({"module": "tonewright-shaders/tsl", "name": "agx_blender_formula"})
        files["/job.json"] = json.dumps(job).encode()
        page = (HERE / "threejs.html").read_text().replace("IMPORTMAP", json.dumps({"imports": imports}))
        posted = run_page(page, files)

    def pixels(what: str, kind=np.float32) -> np.ndarray:
        return np.frombuffer(posted[what], kind).reshape(-1, 4)[:, :3] / (255 if kind == np.uint8 else 1)

    def upside_down(what: str) -> np.ndarray:
        return np.clip(pixels(what).reshape(HEIGHT, WIDTH, 3)[::-1].reshape(-1, 3), 0, 1)

    print(posted["finished"].decode())
    for operator, gl, gpu in zip([*OPERATORS, "agx_blender:formula"], job["webgl"], job["webgpu"]):
        what = f"{operator}, {'--for' if 'module' in gl else 'npm'}"
        right = reference(tonewright, operator, rgb)
        checks.compare(f"{what}, WebGLRenderer, canvas", pixels(f"webgl/{gl['name']}/canvas", np.uint8), right, HALF_A_CODE)
        if not gl.get("hasTables"):
            checks.compare(f"{what}, OutputPass, floats", np.clip(pixels(f"webgl/{gl['name']}/target"), 0, 1), right, FLOATS)
        # Materials of WebGPURenderer show no negative light.
        right = reference(tonewright, operator, np.maximum(rgb, 0))
        checks.compare(f"{what}, WebGPURenderer, floats", upside_down(f"webgpu/{gpu['name']}/target"), right, FLOATS)
    if IS_FULL:
        # By default the intermediate picture has half floats, which are 2^-11 of the light off. A code value of AgX rises by
        # less than 0.5 where light grows by a factor of e.
        checks.compare(f"{what}, WebGPURenderer, half floats", upside_down("webgpu/example"), right, 0.5 * 2**-11 + FLOATS)
        # 2e-6: what operators without PQ have to be within.
        checks.compare("agx_blender, npm, a pass, light", pixels("pass"), reference(tonewright, "agx_blender", rgb, "--display", "linear"), 2e-6)
    room = pixels("room/canvas", np.uint8)
    checks.compare(f"{OPERATORS[0]}, a room, canvas", room, reference(tonewright, OPERATORS[0], pixels("room/light")), HALF_A_CODE)
    checks.check("the room is a picture", room.std() > 0.1 and len(np.unique(room, axis=0)) > 1000)
    if picture:
        pathlib.Path(picture).write_bytes(posted["room/png"])
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[3] if sys.argv[2:3] == ["--picture"] else ""))
