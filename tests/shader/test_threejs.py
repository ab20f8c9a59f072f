# SPDX-License-Identifier: Apache-2.0
"""Files of `tonewright shader` for three.js, in a page in Chromium, against `tonewright eval`.

Modules of `--for threejs` and `--for threejs-tsl`; with TONEWRIGHT_TEST_ALL=1 the npm package, too: packed, installed, and
imported by the examples of its README. The pixels are those of a picture with the colors of executed.colors(), and of a
room that three.js renders.

    python3 -m pytest tests/shader/test_threejs.py --tonewright build/release/bin/tonewright [--screenshots FOLDER]
"""

import json
import pathlib
import re
import subprocess

import numpy as np
from browser import run_page
from executed import IS_FULL, bound_in_application, colors, npm_modules, reference
from pictures import need_program

HERE = pathlib.Path(__file__).parent
WIDTH, HEIGHT = 64, 47  # a multiple of 64 has rows without padding in WebGPU
# AgX Punchy has two 3D LUTs.
OPERATORS = ["agx_threejs", "agx_blender", "agx_blender:look=punchy", "aces_20", "khronos_neutral", "gt7", "aces_13"]
# The tables of aces_20 as arrays, and in a texture of 32-bit floats: the same numbers, so the bound is the same.
FILES = [(operator, "") for operator in OPERATORS] + [("aces_20", "texture")]
# Of a canvas: half a code of 8 bits, and what SwiftShader's rounding is off.
HALF_A_CODE = 0.5 / 255 + 1e-4


def name_of(operator: str) -> str:
    return operator.replace(":look=", "_").replace(":", "_")


def bound_of(operator: str) -> float:
    # three.js encodes with the power 0.41666 for 1/2.4.
    return 6.2e-6 + bound_in_application(operator.split(":")[0])


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


def test_page(request, report, command, scratch):
    need_program("node", "nodejs")
    need_program("npm", "npm")
    modules = npm_modules(command)
    rgb = np.zeros((WIDTH * HEIGHT, 3), np.float32)
    rgb[:len(colors())] = colors()
    # three.js multiplies what it writes to a target by a matrix with zeros: infinities become NaN there.
    rgb = np.clip(rgb, np.float32(-65504), np.float32(65504))
    rgba = np.concatenate([rgb, np.ones((len(rgb), 1), np.float32)], axis=1)
    files = {"/three/": modules / "three", "/light": rgba.tobytes(), "/modules/": scratch, "/three_room.js": HERE / "three_room.js"}
    job = {"width": WIDTH, "height": HEIGHT, "webgl": [], "webgpu": [], "hasExamples": IS_FULL}
    for operator, tables in FILES:
        name = name_of(operator)
        file, options = name + tables, ["--tables", tables] if tables else []
        run(command, "shader", operator, "--for", "threejs", "-o", file + ".js", "-q", *options, folder=scratch)
        run(command, "shader", operator, "--for", "threejs-tsl", "-o", file + ".tsl.js", "-q", *options, folder=scratch)
        has_arrays = "float[" in (scratch / f"{file}.js").read_text()
        report.check(f"{file}: arrays of constants", has_arrays == (operator == "aces_20" and not tables))
        job["webgl"].append({"module": f"/modules/{file}.js", "name": "use_tw_" + name, "what": file,
                             "hasRoom": operator == OPERATORS[0], "hasArrays": has_arrays})
        # WebGPURenderer falls back to WebGL 2 where there is no WebGPU.
        for backend in "WebGPU", "WebGL":
            job["webgpu"].append({"module": f"/modules/{file}.tsl.js", "name": "tw_" + name, "backend": backend})
    imports = {"three": "/three/build/three.module.js", "three/webgpu": "/three/build/three.webgpu.js",
               "three/tsl": "/three/build/three.tsl.js", "three/addons/": "/three/examples/jsm/"}
    if IS_FULL:
        package = install_package(command, scratch)
        examples = re.findall(r"```js\n(.*?)```", (package / "README.md").read_text(), re.S)
        for number, (example, made) in enumerate(zip(examples, ("renderer", "renderer", "material"), strict=True)):
            files[f"/example/{number}.js"] = f"{example}export {{ {made} }};\n".encode()
        files["/package/"] = package
        exports = json.loads((package / "package.json").read_text())["exports"]
        imports |= {"tonewright-shaders" + name[1:]: "/package" + entry["default"][1:] for name, entry in exports.items()}
        job["webgl"].append({"example": "/example/0.js", "what": "npm"})
        job["webgpu"].append({"module": "tonewright-shaders/tsl", "name": "agx_blender", "backend": "WebGPU"})
    files["/job.json"] = json.dumps(job).encode()
    page = (HERE / "threejs.html").read_text().replace("IMPORTMAP", json.dumps({"imports": imports}))
    posted = run_page(page, files)

    def pixels(what: str, kind=np.float32) -> np.ndarray:
        return np.frombuffer(posted[what], kind).reshape(-1, 4)[:, :3] / (255 if kind == np.uint8 else 1)

    def upside_down(what: str) -> np.ndarray:
        return np.clip(pixels(what).reshape(HEIGHT, WIDTH, 3)[::-1].reshape(-1, 3), 0, 1)

    print(posted["finished"].decode())
    operators = [*(operator for operator, _ in FILES), "agx_blender"]
    for operator, gl in zip(operators, job["webgl"]):
        what = f"{gl['what']}, {'--for' if 'module' in gl else 'npm'}"
        light = rgb
        right, floats = reference(command, operator, light), bound_of(operator)
        report.compare(f"{what}, WebGLRenderer, canvas", pixels(f"webgl/{gl['what']}/canvas", np.uint8), right, HALF_A_CODE + floats)
        if not gl.get("hasArrays"):
            report.compare(f"{what}, OutputPass, floats", np.clip(pixels(f"webgl/{gl['what']}/target"), 0, 1), right, floats)
    for gpu in job["webgpu"]:
        operator = next(o for o in [*OPERATORS, "agx_blender"] if name_of(o) == gpu["name"].removeprefix("tw_"))
        # Materials of WebGPURenderer show no negative light.
        right = reference(command, operator, np.maximum(rgb, 0))
        target = f"webgpu/{gpu['module']}/{gpu['backend']}/target"
        shown = upside_down(target) if gpu["backend"] == "WebGPU" else np.clip(pixels(target), 0, 1)
        report.compare(f"{operator}, {gpu['module']}, {gpu['backend']}", shown, right, bound_of(operator))
    if IS_FULL:
        # By default the intermediate picture has half floats, which are 2^-11 of the light off. A code value of AgX rises by
        # less than 0.5 where light grows by a factor of e.
        report.compare("agx_blender, npm, WebGPURenderer, half floats", upside_down("webgpu/example"), right, 0.5 * 2**-11 + bound_of(operator))
        # 2e-6: what operators without PQ have to be within.
        report.compare("agx_blender, npm, a pass, light", pixels("pass"), reference(command, "agx_blender", rgb, "--display", "linear"), 2e-6)
    room = pixels("room/canvas", np.uint8)
    report.compare(f"{OPERATORS[0]}, a room, canvas", room, reference(command, OPERATORS[0], pixels("room/light")), HALF_A_CODE)
    report.check("the room is a picture", room.std() > 0.1 and len(np.unique(room, axis=0)) > 1000)
    if pictures := request.config.getoption("--screenshots"):
        (pictures / "room.png").write_bytes(posted["room/png"])
