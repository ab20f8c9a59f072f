#!/usr/bin/env python3
"""WGSL and HLSL that `tonewright shader` writes, run on Dawn and SwiftShader against `tonewright eval`.

HLSL goes through glslangValidator to SPIR-V and through naga to WGSL. All operators, presets and looks with
TONEWRIGHT_TEST_ALL=1, and then a million hostile colors through ten of them; else a dozen.

Usage: test_wgsl_and_hlsl.py TONEWRIGHT [--record FILE]
--record merges the largest errors into a JSON file: language -> function -> error.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

import numpy as np

from executed import IS_FULL, Comparison, hostile_colors, npm_modules, skip, start, write_shaders

HERE = pathlib.Path(__file__).parent
SWIFTSHADER = pathlib.Path("/usr/lib/chromium/vk_swiftshader_icd.json")
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
    found = re.findall(r"^// (\w+): (\d+) x (\d+) x (\d+) texels.*\n((?://.*\n)*)", text_file.read_text(), re.MULTILINE)
    return [{"folder": str(text_file.parent), "name": name, "size": [int(n) for n in size],
             "loader": lines.replace("// ", "") if text_file.suffix == ".wgsl" else ""} for name, *size, lines in found]


def with_textures(tonewright: str, language: str, rows: list, folder: pathlib.Path) -> list:
    """The functions whose tables are arrays, with their tables as textures."""
    result = []
    for row in rows:
        if "_values[" not in (folder / row["path"]).read_text():
            continue
        path = pathlib.Path("textures") / row["path"]
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([tonewright, "shader", row["operator"], "--language", language, "--display", "srgb", "--tables", "texture",
                        "-o", str(folder / path), "-q"], check=True)
        result.append(row | {"path": str(path)})
    return result


def programs(language: str, rows: list, folder: pathlib.Path) -> list:
    """What run_on_dawn.mjs takes of each function."""
    functions = []
    for row in rows:
        text_file = folder / row["path"]
        program = folder / f"{row['path'].replace('/', '_')}.main.{language}"
        program.write_text(text_file.read_text() + MAIN[language].replace("FUNCTION", row["function"]))
        if language == "hlsl":
            spirv = program.with_suffix(".spv")
            subprocess.run(["glslangValidator", "-D", "-V", "--quiet", "--auto-map-bindings", "-S", "comp", "-e", "main",
                            str(program), "-o", str(spirv)], check=True)
            program = spirv
        functions.append({"source": str(program), "textures": textures_of(text_file),
                          "out": str(program) + ".out"})
    return functions


def run(functions: list, rgb: np.ndarray, modules: pathlib.Path, folder: pathlib.Path) -> str:
    """Writes the files `out`; returns what ran them."""
    rgb.tofile(folder / "colors.raw")
    (folder / "job.json").write_text(json.dumps({"input": str(folder / "colors.raw"), "functions": functions}))
    done = subprocess.run(["node", str(HERE / "run_on_dawn.mjs"), str(modules), str(folder / "job.json")],
                          env=os.environ | {"VK_ICD_FILENAMES": str(SWIFTSHADER)}, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"run_on_dawn.mjs: {done.stderr.strip()}")
    return done.stdout.strip()


def shown(function: dict) -> np.ndarray:
    return np.fromfile(function["out"], np.float32).reshape(-1, 3)


def main(tonewright: str, record_file: str) -> int:
    for program, package in (("node", "nodejs"), ("npm", "npm"), ("glslangValidator", "glslang-tools")):
        if not shutil.which(program):
            skip(f"{program} is missing (Debian: {package})")
    if not SWIFTSHADER.is_file():
        skip("SwiftShader is missing (Debian: chromium-common)")
    modules = npm_modules(tonewright)
    comparison = Comparison(tonewright)
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        rows = write_shaders(tonewright, folder)
        for language in ("wgsl", "hlsl"):
            rows[language] += with_textures(tonewright, language, rows[language], folder)
            functions = programs(language, rows[language], folder)
            adapter = run(functions, comparison.rgb, modules, folder)
            for row, function in zip(rows[language], functions):
                comparison.add(language, f"{adapter} from {language}", row, shown(function), is_as_written=True)
            hostile = functions[::len(functions) // 10][:10] if IS_FULL else functions[:2]
            rgb = hostile_colors(1_000_000 if IS_FULL else 20_000)
            run(hostile, rgb, modules, folder)
            for function in hostile:
                finite = np.isfinite(shown(function)).all(axis=1)
                if not finite.all():
                    comparison.failures.append(f"{function['source']}: not finite for {rgb[~finite][0]}")
    return comparison.report(adapter, record_file)


if __name__ == "__main__":
    start(main)
