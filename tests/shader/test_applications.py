# SPDX-License-Identifier: Apache-2.0
"""Whole files that `tonewright shader --for APPLICATION` writes, drawn without the application.

A stand-in takes the place of what each application puts around the file: a module of Bevy, an include of Unity, the
Custom node of Unreal, the kernel of Resolve. Bevy, Unity and Unreal draw a picture on Dawn, Resolve's runs on pocl; all
with a slider for exposure, against `tonewright eval`.

    python3 -m pytest tests/shader/test_applications.py --tonewright build/release/bin/tonewright [--screenshots FOLDER]
"""

import pathlib
import re
import subprocess

import numpy as np
from dawn import Dawn, spirv_of
from executed import reference
from lut_encodings import srgb_encode
from opencl import OpenCl, device
from pictures import read_rgb

SIZE = (320, 180)
STOPS = 0.5
# Within 2e-6 as a function, except where the terms of a polynomial cancel (see docs/shaders.md).
BOUNDS = {"hable": 2e-6, "khronos_neutral": 2e-6, "agx_threejs": 6e-5}

# Bevy's module of that name: the corners of one triangle around the picture.
BEVY = """
struct FullscreenVertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}
@vertex fn vertex(@builtin(vertex_index) index: u32) -> FullscreenVertexOutput {
    let uv = 2.0 * vec2<f32>(f32(index >> 1u), f32(index & 1u));
    return FullscreenVertexOutput(vec4<f32>(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0), uv);
}
"""
# The names that the file takes of Unity's includes. Blit.hlsl takes names of Core.hlsl.
UNITY = {
    "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl": """
#define TEXTURE2D_X Texture2D
#define SAMPLE_TEXTURE2D_X(picture, sampling, place) picture.Sample(sampling, place)
#define UNITY_SETUP_STEREO_EYE_INDEX_POST_VERTEX(input)
""",
    "Packages/com.unity.render-pipelines.core/Runtime/Utilities/Blit.hlsl": """
[[vk::binding(0)]] TEXTURE2D_X _BlitTexture;
[[vk::binding(1)]] SamplerState sampler_LinearClamp;
struct Varyings {
    float4 positionCS : SV_POSITION;
    float2 texcoord : TEXCOORD0;
};
Varyings Vert(uint index : SV_VertexID) {
    float2 uv = 2.0 * float2(index >> 1, index & 1);
    Varyings output;
    output.positionCS = float4(2.0 * uv - 1.0, 0.0, 1.0);  // as Vulkan has it, from the top
    output.texcoord = uv;
    return output;
}
""",
}
# A material of Unreal calls the Custom node as a function of its inputs.
UNREAL = "".join(UNITY.values()) + """
#include "INCLUDE"
float exposure;
float3 CustomExpression0(float4 color, float exposure) {
CODE
}
float4 Fragment(Varyings input) : SV_Target {
    return float4(CustomExpression0(_BlitTexture.Sample(sampler_LinearClamp, input.texcoord), exposure), 1.0);
}
"""


def found(pattern: str, text: str) -> str:
    match = re.search(pattern, text, re.S)
    assert match, f"{pattern} is not in the file"
    return match[1]


def bevy(text: str, function: str, folder: pathlib.Path) -> dict:
    text, path = re.sub("#define_import_path .*", "", text), folder / f"{function}.wgsl"
    text, count = re.subn("#import bevy_core_pipeline::fullscreen_vertex_shader::FullscreenVertexOutput", BEVY, text)
    assert count == 1, "the file does not import FullscreenVertexOutput"
    path.write_text(text)
    return {"vertex": {"source": str(path), "entryPoint": "vertex"}, "bindings": ["picture", "sampler"],
            "fragment": {"source": str(path), "entryPoint": "fragment", "constants": {"exposure": STOPS}}}


def hlsl(text: str, vertex: str, fragment: str, function: str, folder: pathlib.Path) -> dict:
    path = folder / f"{function}.hlsl"
    path.write_text(text)
    stages = {stage: {"source": str(spirv_of(path, stage, entry, f"-I{folder}")), "entryPoint": entry}
              for stage, entry in (("vert", vertex), ("frag", fragment))}
    return {"vertex": stages["vert"], "fragment": stages["frag"], "bindings": ["picture", "sampler", [STOPS]]}


def unity(text: str, function: str, folder: pathlib.Path) -> dict:
    assert found(r'_exposure\("exposure", Range\((.*?)\)\)', text) == "-8.0, 8.0", "the slider of exposure"
    program = found(r"HLSLPROGRAM\n(.*?)ENDHLSL", text)
    for name, stand_in in UNITY.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(stand_in)
    vertex, fragment = (found(rf"#pragma {stage} (\w+)", program) for stage in ("vertex", "fragment"))
    return hlsl(program, vertex, fragment, function, folder)


def unreal(text: str, function: str, folder: pathlib.Path) -> dict:
    include = found(r"Include File Paths: /(\S+)", text)
    (folder / include).parent.mkdir(parents=True, exist_ok=True)
    (folder / include).write_text(text.removeprefix("#pragma once\n"))  # glslang warns of it
    material = UNREAL.replace("INCLUDE", include).replace("CODE", found(r"Code: (.*?)\n", text))
    return hlsl(material, "Vert", "Fragment", function, folder)


def resolve(text: str, function: str, picture: np.ndarray) -> np.ndarray:
    """The result of transform(), which also gets the position of the pixel."""
    call = f"transform({SIZE[0]}, {SIZE[1]}, i / 3 % {SIZE[0]}, i / 3 / {SIZE[0]}, a[i], a[i + 1], a[i + 2])"
    return OpenCl({function: f"#define SLIDER {STOPS}f\n{text}"}, {function: call}).run(function, picture)


def write_png(codes: np.ndarray, path: pathlib.Path) -> None:
    header = f"P6 {SIZE[0]} {SIZE[1]} 255\n".encode()
    path.with_suffix(".ppm").write_bytes(header + np.round(255 * np.clip(codes, 0, 1)).astype(np.uint8).tobytes())
    subprocess.run(["oiiotool", str(path.with_suffix(".ppm")), "-o", str(path)], check=True)


def test_files(request, report, command, scratch):
    pictures = request.config.getoption("--screenshots")
    dawn = Dawn(command)
    device()
    subprocess.run([command, "chart", "-o", str(scratch / "chart.exr"), "--width", str(SIZE[0]), "--height",
                    str(SIZE[1]), "-d", "half", "-q"], check=True)
    scene = read_rgb(scratch / "chart.exr", scratch).reshape(-1, 3).astype(np.float32)
    np.concatenate([scene, np.ones((len(scene), 1))], 1).astype(np.float16).tofile(scratch / "scene.half")
    drawn, steps = {}, []
    # Application -> how to draw its file, and what takes its values to code values of sRGB.
    for application, prepare, display in (("bevy", bevy, "linear"), ("unity", unity, "linear"),
                                          ("unreal", unreal, "srgb"), ("resolve", None, "rec1886")):
        for operator in BOUNDS:
            function = f"{application}_{operator}"
            text = subprocess.run([command, "shader", operator, "--for", application, "--uniforms", "exposure"],
                                  check=True, capture_output=True, text=True).stdout
            out = scratch / f"{function}.out"
            if prepare:
                steps.append(prepare(text, function, scratch) | {"picture": str(scratch / "scene.half"), "size": SIZE,
                                                                 "out": str(out)})
            else:
                shown = resolve(text, function, scene)
                np.concatenate([shown, np.ones((len(shown), 1), np.float32)], 1).tofile(out)
            drawn[application, operator] = out, display
    print(f"{dawn.run(steps)}, pocl")
    for (application, operator), (out, display) in drawn.items():
        shown = np.fromfile(out, np.float32).reshape(-1, 4)[:, :3].astype(float)
        expected = reference(command, operator, scene, "--display", display, "--exposure", str(STOPS))
        to_light = {"linear": lambda x: x, "srgb": None, "rec1886": lambda x: x**2.4}[display]
        codes = [srgb_encode(np.clip(to_light(x), 0, None)) if to_light else x for x in (shown, expected)]
        error = np.abs(codes[0] - codes[1]).max()
        report.bound(f"{application} {operator}", error, BOUNDS[operator])
        report.check(f"{application} {operator}: it is a picture", codes[1].std() > 0.1)
        if pictures:
            write_png(codes[0], pictures / f"{application}_{operator}.png")
