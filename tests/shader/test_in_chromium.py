# SPDX-License-Identifier: Apache-2.0
"""GLSL ES and WGSL that `tonewright shader` writes, run in Chromium on WebGL 2 and WebGPU against `tonewright eval`.

All operators, presets and looks with TONEWRIGHT_TEST_ALL=1, and a million hostile colors through ten of them; else a
dozen. Chromium draws with SwiftShader.

    python3 -m pytest tests/shader/test_in_chromium.py --tonewright build/release/bin/tonewright
"""

import json
import pathlib

import numpy as np
from browser import run_page
from test_wgsl_and_hlsl import textures_of

# Language -> its key in the record, and a program around a function.
PROGRAMS = {
    "glsl-es": ("glsl-es", """#version 300 es
TEXT
uniform highp sampler2D colors;
out vec4 shown;
void main() { shown = vec4(FUNCTION(texelFetch(colors, ivec2(gl_FragCoord.xy), 0).rgb), 1.0); }
"""),
    "wgsl": ("wgsl (Chromium)", """TEXT
@group(1) @binding(0) var<storage, read> colors: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> shown: array<vec4<f32>>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    shown[id.x] = vec4<f32>(FUNCTION(colors[id.x].rgb), 1.0);
}
"""),
}
PAGE = pathlib.Path(__file__).with_name("functions.html").read_text()
WIDTH = 1024  # the page takes whole rows


def rows_of(rgb: np.ndarray) -> bytes:
    """RGBA, the last row filled up with black."""
    rgba = np.zeros((-(-len(rgb) // WIDTH) * WIDTH, 4), np.float32)
    rgba[:len(rgb), :3] = rgb
    return rgba.tobytes()


def test_functions(comparison, shaders, errors_file):
    for language, (key, program) in PROGRAMS.items():
        rows = comparison.rows[language]
        files = {"/shaders/": shaders / language}
        functions = []
        for row in rows:
            name = row["function"]
            text_file = shaders / row["path"]
            rgb = comparison.colors_of(row)
            files[f"/colors/{len(rgb)}"] = rows_of(rgb)
            files["/source/" + name] = program.replace("TEXT", text_file.read_text()).replace("FUNCTION", name).encode()
            textures = [{"name": pathlib.Path(t["file"]).stem, "size": t["size"],
                         "url": "/shaders/" + pathlib.Path(t["file"]).name} for t in textures_of(text_file)]
            functions.append({"source": "/source/" + name, "textures": textures, "colors": f"/colors/{len(rgb)}", "out": name})
        files["/job.json"] = json.dumps({"language": language, "functions": functions}).encode()
        posted = run_page(PAGE, files)
        about = posted["finished"].decode()
        for row in rows:
            got = np.frombuffer(posted[row["function"]], np.float32).reshape(-1, 4)[:len(comparison.colors_of(row)), :3]
            comparison.add(key, f"{about} from {language}", row, got, is_as_written=True)
    comparison.finish("Chromium, SwiftShader", errors_file)
