# SPDX-License-Identifier: Apache-2.0
"""Files of `tonewright shader` for JavaScript renderers, in a page in Chromium, against `tonewright eval`.

Modules for Babylon.js, PlayCanvas, CesiumJS and postprocessing. Each renderer draws a picture with the colors of
executed.colors() to its 8-bit canvas, and a room, with the module and with the example of docs/shaders.md.

    python3 -m pytest tests/shader/test_web_hosts.py --tonewright build/release/bin/tonewright [--screenshots FOLDER]
"""

import json
import pathlib
import re
import subprocess

import numpy as np
import pytest
from browser import run_page
from executed import IS_FULL, colors, npm_modules, reference
from pictures import PROJECT, need_program

HERE = pathlib.Path(__file__).parent
HOSTS = HERE / "web_hosts"
DOCUMENTATION = PROJECT / "docs/shaders.md"
PACKAGES = ["@babylonjs/core@9.35.0", "playcanvas@2.23.3", "@cesium/engine@26.3.0", "postprocessing@6.39.6", "three@0.187.0"]
WIDTH, HEIGHT = 64, 47
OPERATORS = ["agx_blender", "khronos_neutral", "aces_20", "aces_13", "gt7"]
DEFAULTS = {"exposure": 0.0, "white": 11.2}
VALUES = {"exposure": 1.0, "white": 4.0}
# Of a canvas: half a code of 8 bits, and what SwiftShader's rounding is off.
HALF_A_CODE = 0.5 / 255 + 1e-4
# Texels are half floats, 2^-12 off. AgX's LUT has code values of a power of 2.4, which these displays raise to 2.4/2.2 or less.
HALF_FLOATS = 1.1 * 2.0**-12
# `shader` warns that gt7 is 1.3e-3 off in float, in code values of sRGB. Near black these rise 12.92 times as fast as light,
# and code values of gamma 2.2 are (x + 1.3e-3 / 12.92)^(1/2.2) - x^(1/2.2) off: 3.7e-3 for x = 1.2e-4, at code 4.
GT7 = 3.7e-3
FULL_LIGHT, LIMIT_OF_PBR = 65504.0, 30.0

IMPORTS = {
    "babylon": {"@babylonjs/core/": "@babylonjs/core/"},
    "playcanvas": {"playcanvas": "playcanvas/build/playcanvas.mjs"},
    "cesium": {"@cesium/engine": "@cesium/engine/index.js", "@spz-loader/core": "@spz-loader/core/dist/index.js",
               "@tweenjs/tween.js": "@tweenjs/tween.js/dist/tween.esm.js", "dompurify": "dompurify/dist/purify.es.mjs",
               "earcut": "earcut/src/earcut.js", "jsep": "jsep/dist/jsep.js", "kdbush": "kdbush/index.js",
               "ktx-parse": "ktx-parse/dist/ktx-parse.esm.js", "meshoptimizer": "meshoptimizer/index.js",
               "rbush": "rbush/index.js", "quickselect": "quickselect/index.js",
               "topojson-client": "topojson-client/src/index.js", "@cesium/wasm-splats": "@cesium/wasm-splats/wasm_splats.js"},
    "postprocessing": {"three": "three/build/three.module.js", "three/addons/": "three/examples/jsm/",
                       "postprocessing": "postprocessing/build/index.js"},
}
# Packages of Cesium that are no ES modules, and those that these pictures do not need: KML, archives, Draco.
COMMON = {"bitmap-sdf": "bitmap-sdf/index.js", "grapheme-splitter": "grapheme-splitter/index.js", "lerc": "lerc/LercDecode.js",
          "mersenne-twister": "mersenne-twister/src/mersenne-twister.js", "urijs": "urijs/src/URI.js"}
LEFT_OUT = ["autolinker", "draco3d/draco_decoder_nodejs.js", "pako/browser/inflate", "protobufjs/dist/minimal/protobuf.js",
            "@zip.js/zip.js/lib/zip-core.js"]
NAMES = ["inflate", "configure", "BlobReader", "BlobWriter", "Data64URIWriter", "TextReader", "TextWriter", "ZipReader", "ZipWriter"]
STUB = "export default class {}\n" + "".join(f"export const {name} = () => undefined;\n" for name in NAMES)
COMMON_MODULE = "const module = {{ exports: {{}} }}, exports = module.exports, require = () => undefined;\n{}\nexport default module.exports;\n"


def module_text(command: str, host: str, operator: str, folder: pathlib.Path, arguments: tuple, tables: str) -> str:
    path = folder / f"{operator}.js"
    options = (["--uniforms", ",".join(arguments)] if arguments else []) + (["--tables", tables] if tables else [])
    subprocess.run([command, "shader", operator, "--for", host, "-o", path, "-q", *options], check=True)
    return path.read_text()


def example_of(title: str) -> str:
    section = re.search(rf"### {re.escape(title)}\n(.*?)(?=\n### |\Z)", DOCUMENTATION.read_text(), re.S)[1]
    return re.search(r"```js\n(.*?)```", section, re.S)[1]


@pytest.mark.parametrize("host, title, display", [
    ("babylon", "Babylon.js", "g22"), ("playcanvas", "PlayCanvas", "g22"), ("postprocessing", "postprocessing", "srgb"),
    ("cesium", "CesiumJS", "g22")])
def test_page(request, report, command, scratch, host, title, display):
    need_program("npm", "npm")
    modules = npm_modules(command, "npm-web-hosts", PACKAGES)
    rgb = np.zeros((WIDTH * HEIGHT, 3), np.float32)
    rgb[:len(colors())] = colors()
    # Materials show no negative light. Cesium and postprocessing hold light in half floats; all get what these can hold.
    rgb = np.clip(rgb, 0, FULL_LIGHT).astype(np.float16).astype(np.float32)
    rgba = np.concatenate([rgb, np.ones((len(rgb), 1), np.float32)], axis=1)
    job = {"width": WIDTH, "height": HEIGHT, "modules": []}
    files = {"/npm/": modules, "/light": rgba.tobytes(), "/host.js": HOSTS / f"{host}.js",
             "/three_room.js": HERE / "three_room.js"}
    expected = {}

    def add(operator: str, what: str, light: np.ndarray, *options: str, arguments: tuple = (), tables: str = "",
            **settings) -> None:
        """Draws it, and expects what eval says of the light with the options."""
        url = f"/modules/{what}.js"
        files[url] = module_text(command, host, operator, scratch, arguments, tables).encode()
        name = f"tw_{operator}_Effect" if host == "postprocessing" else f"use_tw_{operator}"
        job["modules"].append({"module": url, "name": name, "what": what} | settings)
        expected[what] = reference(command, operator, light, "--display", display, *options)

    for operator in OPERATORS if IS_FULL else OPERATORS[:3]:
        add(operator, operator, rgb)
    # The same numbers as in the arrays, in a texture of 32-bit floats.
    add("aces_20", "aces_20_in_a_texture", rgb, tables="texture")
    if host in ("babylon", "playcanvas"):
        limit = LIMIT_OF_PBR if host == "babylon" else FULL_LIGHT
        add("agx_blender", "agx_blender_in_a_pipeline", np.minimum(rgb, limit), isPipeline=True)
    if host == "babylon":  # arguments are constants
        add("hable", "hable_with_arguments", rgb, arguments=tuple(VALUES))
    else:
        add("hable", "hable_with_arguments", rgb, "--exposure", "1", "--set", "white=4", arguments=tuple(VALUES), values=VALUES)
    files["/example/agx.js"] = files["/modules/agx_blender.js"]
    export = "export { composer };\n" if host == "postprocessing" else ""
    files["/example/example.js"] = (example_of(title) + export).encode()
    imports = {name: f"/npm/{path}" for name, path in IMPORTS[host].items()}
    if host == "cesium":
        files["/left_out.js"] = STUB.encode()
        imports |= dict.fromkeys(LEFT_OUT, "/left_out.js")
        for name, path in COMMON.items():
            imports[name] = f"/common/{name}.js"
            files[imports[name]] = COMMON_MODULE.format((modules / path).read_text()).encode()
    files["/job.json"] = json.dumps(job).encode()
    page = (HERE / "web_hosts.html").read_text().replace("IMPORTMAP", json.dumps({"imports": imports}))
    posted = run_page(page, files)
    print(posted["finished"].decode())

    def pixels(what: str) -> np.ndarray:
        return np.frombuffer(posted[f"{what}/canvas"], np.uint8).reshape(-1, 4)[:, :3] / 255

    for what, right in expected.items():
        bound = HALF_A_CODE + (HALF_FLOATS if "agx" in what else GT7 if what == "gt7" else 0)
        report.compare(f"{what}, {title}, canvas", pixels(what), np.clip(right, 0, 1), bound)
    room = pixels("room")
    report.check(f"{title}: the room is a picture", room.std() > 0.1 and len(np.unique(room, axis=0)) > 500)
    report.check(f"{title}: the example draws the same room", (room == pixels("example")).all())
    if pictures := request.config.getoption("--screenshots"):
        (pictures / f"{host}.png").write_bytes(posted["example/png"])
