# SPDX-License-Identifier: Apache-2.0
"""WGSL and HLSL that `tonewright shader` writes, run on Dawn and SwiftShader against `tonewright eval`.

HLSL goes through glslangValidator to SPIR-V and through naga to WGSL. All operators, presets and looks with
TONEWRIGHT_TEST_ALL=1, and a million hostile colors through ten of them; else a dozen.

    python3 -m pytest tests/shader/test_wgsl_and_hlsl.py --tonewright build/release/bin/tonewright
"""

import pathlib
import re
import subprocess

import numpy as np
from dawn import Dawn, spirv_of

MAIN = {
    "wgsl": """
@group(1) @binding(0) var<storage, read> colors: array<f32>;
@group(1) @binding(1) var<storage, read_write> shown: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = 3u * id.x;
    let c = FUNCTION(vec3<f32>(colors[i], colors[i + 1u], colors[i + 2u]));
    shown[i] = c.r;
    shown[i + 1u] = c.g;
    shown[i + 2u] = c.b;
}
""",
    "hlsl": """
[[vk::binding(0, 1)]] StructuredBuffer<float> colors;
[[vk::binding(1, 1)]] RWStructuredBuffer<float> shown;
[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID) {
    uint i = 3 * id.x;
    float3 c = FUNCTION(float3(colors[i], colors[i + 1], colors[i + 2]));
    shown[i] = c.r;
    shown[i + 1] = c.g;
    shown[i + 2] = c.b;
}
""",
}


def textures_of(text_file: pathlib.Path) -> list:
    """Those of the text's comments, and for WGSL how they say that the file is loaded."""
    found = re.findall(r"^// (\w+): (\d+) x (\d+) x (\d+) texels.*\n(?:// To load its file:\n)?((?://.*\n)*)", text_file.read_text(), re.MULTILINE)
    return [{"file": str(text_file.parent / f"{name}.rgba32f"), "size": [int(n) for n in size],
             "loader": lines.replace("// ", "") if text_file.suffix == ".wgsl" else ""} for name, *size, lines in found]


def with_textures(tonewright: str, language: str, rows: list, shaders: pathlib.Path, folder: pathlib.Path) -> list:
    """Those of the functions whose tables are arrays, written into the folder with their tables as textures."""
    result = []
    for row in rows:
        if "_values[" not in (shaders / row["path"]).read_text():
            continue
        path = pathlib.Path("textures") / row["path"]
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([tonewright, "shader", row["operator"], "--language", language, "--display", "srgb", "--tables", "texture",
                        "-o", str(folder / path), "-q"], check=True)
        result.append(row | {"path": str(path)})
    return result


def step_of(language: str, row: dict, shaders: pathlib.Path, rgb: np.ndarray, folder: pathlib.Path) -> dict:
    """The input of run_on_dawn.mjs for this function."""
    text_file = shaders / row["path"]
    program = folder / f"{row['path'].replace('/', '_')}.main.{language}"
    program.write_text(text_file.read_text() + MAIN[language].replace("FUNCTION", row["function"]))
    colors = folder / f"{len(rgb)}.colors"
    rgb.tofile(colors)
    source = spirv_of(program, "comp", "main") if language == "hlsl" else program
    return {"source": str(source), "textures": textures_of(text_file), "input": str(colors), "out": f"{program}.out"}


def test_functions(comparison, command, shaders, scratch, errors_file):
    dawn = Dawn(command)
    for language in MAIN:
        rows = comparison.rows[language]
        textured = with_textures(command, language, rows, shaders, scratch)
        steps = [step_of(language, row, at, comparison.colors_of(row), scratch)
                 for at, some in ((shaders, rows), (scratch, textured)) for row in some]
        adapter = dawn.run(steps)
        for row, step in zip(rows + textured, steps):
            shown = np.fromfile(step["out"], np.float32).reshape(-1, 3)
            comparison.add(language, f"{adapter} from {language}", row, shown, is_as_written=True)
    comparison.finish(adapter, errors_file)
