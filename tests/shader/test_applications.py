# SPDX-License-Identifier: Apache-2.0
"""Whole files that `tonewright shader --for APPLICATION` writes, drawn without the application.

A stand-in takes the place of what each application puts around the file: a module of Bevy, an include of Unity, the
Custom node of Unreal, the kernel of Resolve. Bevy, Unity and Unreal draw a picture on Dawn, Resolve's runs on pocl; all
with a slider for exposure, against `tonewright eval`. Files with a 3D LUT, and with tables of numbers, are drawn with the
texture that other readers find in the file beside them: ktx-parse (three.js), OpenImageIO, OpenColorIO; Nuke's kernel runs as
C++.

    python3 -m pytest tests/shader/test_applications.py --tonewright build/release/bin/tonewright [--screenshots FOLDER]
"""

import base64
import pathlib
import re
import subprocess

import numpy as np
import OpenImageIO
import PyOpenColorIO
from dawn import Dawn, spirv_of
from executed import reference
from lut_encodings import srgb_encode
from opencl import OpenCl, device
from pictures import read_rgb, share_of
from test_c_and_dctl import BLINK

SIZE = (320, 180)
STOPS = 0.5
# Within 2e-6 as a function, except where the terms of a polynomial cancel, and PQ curves and matrices amplify rounding (see
# docs/shaders.md, "Errors").
BOUNDS = {"hable": 2e-6, "khronos_neutral": 2e-6, "agx_threejs": 6e-5, "agx_blender": 1e-5, "aces_13": 1e-5, "aces_20": 4e-5,
          "gt7": 3.5e-3}
# A node in half floats is 2^-12 off, which a power of 2.4 and sRGB's curve enlarge a little.
HALF_NODES = 1.2 * 2**-12
# Operators with a texture: options, its size, the type of its numbers, and the bound. Tables have the 32-bit floats of the arrays
# in the text, so the bound is that of the text. The fitted curve of uchimura has a table for each coefficient; its header says 9e-8, and
# SwiftShader rounds as for other functions.
TEXTURES = {"agx_blender": ([], (57, 57, 57), "<f2", HALF_NODES), "aces_20": ([], (361, 2), "<f4", BOUNDS["aces_20"]),
            "uchimura": (["--curves", "fitted"], None, "<f4", BOUNDS["hable"])}

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
            "fragment": {"source": str(path), "entryPoint": "fragment",
                         "constants": {"exposure": STOPS} if "override exposure" in text else {}}}


def hlsl(text: str, vertex: str, fragment: str, function: str, folder: pathlib.Path) -> dict:
    path = folder / f"{function}.hlsl"
    path.write_text(text)
    stages = {stage: {"source": str(spirv_of(path, stage, entry, f"-I{folder}")), "entryPoint": entry}
              for stage, entry in (("vert", vertex), ("frag", fragment))}
    bindings = ["picture", "sampler"] + ([[STOPS]] if "exposure;" in text else [])
    return {"vertex": stages["vert"], "fragment": stages["frag"], "bindings": bindings}


def unity(text: str, function: str, folder: pathlib.Path) -> dict:
    if "_exposure" in text:
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
    for texture in re.findall(r"// (\w+) is another input of the node: a Texture Object", text):
        kind = found(rf"(Texture\dD) {texture}\)", text)
        material = material.replace("float exposure;", f"{kind} {texture};").replace(", float exposure", "").replace(
            ", exposure", "")
    return hlsl(material, "Vert", "Fragment", function, folder)


def resolve(text: str, function: str, picture: np.ndarray) -> np.ndarray:
    """The result of transform(), which also gets the position of the pixel."""
    call = f"transform({SIZE[0]}, {SIZE[1]}, i / 3 % {SIZE[0]}, i / 3 / {SIZE[0]}, a[i], a[i + 1], a[i + 2])"
    return OpenCl({function: f"#define SLIDER {STOPS}f\n{text}"}, {function: call}).run(function, picture)


# Readers of the files beside a text: the texels of a texture of that size and type.

def ktx2(path: pathlib.Path, size: tuple, kind: str, modules: pathlib.Path) -> np.ndarray:
    script = f"""import {{ readFileSync, writeFileSync }} from 'fs';
const {{ read }} = await import({str(modules / "three/examples/jsm/libs/ktx-parse.module.js")!r});
const file = read(new Uint8Array(readFileSync({str(path)!r})));
if (file.vkFormat !== {97 if kind == "<f2" else 109} || file.supercompressionScheme !== 0 || file.levels.length !== 1) throw new Error('another format');
writeFileSync({str(path.with_suffix(".texels"))!r}, file.levels[0].levelData);
console.log(file.pixelWidth, file.pixelHeight, file.pixelDepth, file.keyValue.KTXwriter);"""
    said = subprocess.run(["node", "--input-type=module", "-e", script], check=True, capture_output=True, text=True).stdout.split()
    assert said[:4] == [*(str(edge) for edge in (*size, 0)[:3]), "Tonewright"], said
    return np.fromfile(path.with_suffix(".texels"), kind)


def exr(path: pathlib.Path, size: tuple, kind: str, _) -> np.ndarray:
    picture, spec = OpenImageIO.ImageBuf(str(path)), OpenImageIO.ImageBuf(str(path)).spec()
    expected = (size[0], int(np.prod(size[1:])), "half" if kind == "<f2" else "float")
    assert (spec.width, spec.height, str(spec.format)) == expected, picture.geterror()
    return picture.get_pixels(OpenImageIO.FLOAT).astype(kind).ravel()


def script(path: pathlib.Path, size: tuple, kind: str, _) -> np.ndarray:
    text = path.read_text()
    made = {"<f2": "new Texture3D({}, {}, {}, TextureFormat.RGBAHalf,", "<f4": "new Texture2D({}, {}, TextureFormat.RGBAFloat,"}
    assert made[kind].format(*size) in text, "the texture of the script"
    return np.frombuffer(base64.b64decode(found(r'Data = "(.*?)"', text)), kind)


def cube(path: pathlib.Path) -> np.ndarray:
    """The colors of a 3D LUT, red fastest, at its nodes."""
    lut = PyOpenColorIO.Config.CreateRaw().getProcessor(PyOpenColorIO.FileTransform(str(path))).getDefaultCPUProcessor()
    place = np.arange(57, dtype=np.float32) / 56
    b, g, r = np.meshgrid(place, place, place, indexing="ij")
    rgb = np.ascontiguousarray(np.stack([r, g, b], -1).reshape(-1, 3))
    lut.applyRGB(rgb)
    return rgb


def resolve_with_lut(text: str, folder: pathlib.Path, picture: np.ndarray) -> np.ndarray:
    """transform() with an array in place of Resolve's LUT; only nodes may be read."""
    name, file = re.search(r"DEFINE_LUT\((\w+), (\S+)\)", text).groups()
    table = ",".join(f"{x:.9e}f" for x in cube(folder / file).ravel())
    stand_in = f"""__constant float table[{3 * 57**3}] = {{ {table} }};
static inline float3 at_node(float x, float y, float z) {{
    float3 place = (float3)(56 * x, 56 * y, 56 * z);
    if (any(fabs(place - rint(place)) > 1e-4f)) return (float3)(NAN);
    int i = 3 * ((int)rint(place.x) + 57 * ((int)rint(place.y) + 57 * (int)rint(place.z)));
    return (float3)(table[i], table[i + 1], table[i + 2]);
}}
#define APPLY_LUT(x, y, z, lut) at_node(x, y, z)
"""
    return resolve(stand_in + re.sub(r"DEFINE_LUT.*\n", "", text), "with_lut", picture)


def nuke_with_lut(text: str, folder: pathlib.Path, picture: np.ndarray) -> np.ndarray:
    """The kernel as C++, whose second input is the picture beside it. Rows of Nuke begin at the bottom."""
    name = found(r"Image<eRead, eAccessRandom, eEdgeClamped> (\w+);", text)
    kernel = found(r"kernel (\w+) :", text)
    texels = exr(folder / f"{name}.exr", (57, 57, 57), "<f2", None).astype("<f4")
    program = f"""{BLINK}
#include <cstdio>
#include <vector>
static std::vector<float> texels({len(texels)});
template <> struct Image<eRead, eAccessRandom, eEdgeClamped> {{
    float4 operator()(int x, int y) const {{
        const float* t = &texels[4 * (x + 57 * (57 * 57 - 1 - y))];
        return float4(t[0], t[1], t[2], t[3]);
    }}
}};
{text}
int main(int, char** argv) {{
    FILE* file = std::fopen(argv[1], "rb");
    if (std::fread(texels.data(), 4, texels.size(), file) != texels.size()) return 1;
    float c[3];
    {kernel} k;
    k.define();
    while (std::fread(c, 4, 3, stdin) == 3) {{
        k.src() = float4(c[0], c[1], c[2], 1);
        k.process();
        const float shown[3] = {{k.dst().x, k.dst().y, k.dst().z}};
        std::fwrite(shown, 4, 3, stdout);
    }}
}}
"""
    (folder / "nuke.cpp").write_text(program)
    subprocess.run(["g++", "-O2", "-Wall", "-Wextra", "-Werror", "nuke.cpp", "-o", "nuke"], cwd=folder, check=True)
    texels.tofile(folder / "nuke.texels")
    done = subprocess.run([folder / "nuke", folder / "nuke.texels"], input=picture.astype("<f4").tobytes(), capture_output=True, check=True)
    return np.frombuffer(done.stdout, "<f4").reshape(-1, 3)


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
        for operator in share_of(BOUNDS, 3):
            function = f"{application}_{operator}"
            text = subprocess.run([command, "shader", operator, "--for", application, "--uniforms", "exposure", "--tables",
                                   "formula"],
                                  check=True, capture_output=True, text=True).stdout
            out = scratch / f"{function}.out"
            if prepare:
                steps.append(prepare(text, function, scratch) | {"picture": str(scratch / "scene.half"), "size": SIZE,
                                                                 "out": str(out)})
            else:
                shown = resolve(text, function, scene)
                np.concatenate([shown, np.ones((len(shown), 1), np.float32)], 1).tofile(out)
            drawn[application, operator] = out, display
    # Without a slider: the binding after the picture and its sampler is the texture.
    for application, prepare, display, read in (("bevy", bevy, "linear", ktx2), ("unity", unity, "linear", script),
                                                ("unreal", unreal, "srgb", exr)):
        for operator, (options, known_size, kind, _) in TEXTURES.items():
            folder = scratch / f"{application}_{operator}_texture"
            folder.mkdir()
            file, out, texels = folder / "file.txt", folder / "out", folder / "texels"
            subprocess.run([command, "shader", operator, "--for", application, "--tables", "texture", "-o", str(file), "-q", *options],
                           check=True)
            (beside,) = folder.glob("tw_*")
            size = tuple(map(int, found(r"// tw_\w+: ([\dx ]+) texels", file.read_text()).split(" x ")))
            assert size == (known_size or size), size
            read(beside, size, kind, dawn.modules).tofile(texels)
            step = prepare(file.read_text(), f"{application}_{operator}_texture", folder)
            texture = {"texels": str(texels), "size": size, "format": "rgba16float" if kind == "<f2" else "rgba32float"}
            step["bindings"] = ["picture", "sampler", texture]
            steps.append(step | {"picture": str(scratch / "scene.half"), "size": SIZE, "out": str(out)})
            drawn[application, f"{operator}, a texture"] = out, display
    subprocess.run([command, "shader", "agx_blender", "--for", "resolve", "--tables", "texture", "-o", "lut.dctl", "-q"], check=True, cwd=scratch)
    shown = resolve_with_lut((scratch / "lut.dctl").read_text(), scratch, scene)
    np.concatenate([shown, np.ones((len(shown), 1), np.float32)], 1).tofile(scratch / "lut.out")
    drawn["resolve", "agx_blender, a texture"] = scratch / "lut.out", "rec1886"
    subprocess.run([command, "shader", "agx_blender", "--for", "nuke", "--tables", "texture", "-o", "lut.rpp", "-q"], check=True, cwd=scratch)
    shown = nuke_with_lut((scratch / "lut.rpp").read_text(), scratch, scene)
    np.concatenate([shown, np.ones((len(shown), 1), np.float32)], 1).tofile(scratch / "nuke.out")
    drawn["nuke", "agx_blender, a texture"] = scratch / "nuke.out", "linear"
    print(f"{dawn.run(steps)}, pocl")
    for (application, operator), (out, display) in drawn.items():
        shown = np.fromfile(out, np.float32).reshape(-1, 4)[:, :3].astype(float)
        stops, bound = (0, TEXTURES[operator.split(",")[0]][3]) if "texture" in operator else (STOPS, BOUNDS[operator])
        expected = reference(command, operator.split(",")[0], scene, "--display", display, "--exposure", str(stops))
        to_light = {"linear": lambda x: x, "srgb": None, "rec1886": lambda x: x**2.4}[display]
        codes = [srgb_encode(np.clip(to_light(x), 0, None)) if to_light else x for x in (shown, expected)]
        error = np.abs(codes[0] - codes[1]).max()
        report.bound(f"{application} {operator}", error, bound)
        report.check(f"{application} {operator}: it is a picture", codes[1].std() > 0.1)
        if pictures:
            write_png(codes[0], pictures / f"{application}_{operator}.png")
