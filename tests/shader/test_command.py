# SPDX-License-Identifier: Apache-2.0
"""`tonewright shader` as a user meets it: languages, applications, files, warnings, wrong usage.

    python3 -m pytest tests/shader/test_command.py --tonewright build/release/bin/tonewright
"""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
from executed import reference

OK, USAGE, FILE = 0, 2, 3  # exit codes


def call(command, *arguments):
    """(exit code, standard output, standard error)"""
    done = subprocess.run([command, "shader", *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_standard_output(report, command):
    code, plain, _ = call(command, "hable", "--language", "glsl")
    report.check("-o - is the standard output", call(command, "hable", "--language", "glsl", "-o", "-")[:2] == (code, plain)
                 and "vec3 tw_hable(" in plain and not Path("-").exists())


def test_refusals(report, command, scratch):
    rows = "".join(f"{r / 16} {g / 16} {b / 16}\n" for b in range(17) for g in range(17) for r in range(17))
    (scratch / "lut.cube").write_text("LUT_3D_SIZE 17\n" + rows)
    for arguments, code, words in [
        (["hable"], USAGE, "shader: --language and --for are missing; expected one of them"),
        (["hable", "-o", "x.h"], USAGE, "missing; expected --language dctl, blinkscript or c"),
        (["hable", "-o", "x.txt"], USAGE, "missing; expected one of them"),
        (["hable", "--language", "hlsl", "-o", "x.glsl"], USAGE, "file is x.glsl; expected .hlsl: the language is hlsl"),
        (["hable", "--for", "threejs", "-o", "x.glsl"], USAGE, "file is x.glsl; expected .js: three.js (WebGL) reads it"),
        (["hable", "--language", "c", "--for", "mpv"], USAGE, "shader: --language and --for are given"),
        (["--language", "c"], USAGE, "shader: OPERATOR is missing"),
        (["hable", "--language", "glls"], USAGE, "did you mean glsl?"),
        (["hable", "--for", "three"], USAGE, "did you mean threejs"),
        (["hable", "--language", "c", "--uniforms", "whit"], USAGE, "did you mean white?"),
        (["hable", "--language", "c", "--uniforms", "white,white"], USAGE, "white twice"),
        (["hable_piecewise", "--language", "c", "--uniforms", "toe_length"], USAGE, "--uniforms is toe_length"),
        (["reinhard_local", "--language", "c"], USAGE, "reinhard_local"),
        (["reinhard_jodie", "--language", "c", "--inverse"], USAGE, "reinhard_jodie has no inverse: stage "),
        (["lut.cube", "--language", "dctl"], USAGE, "reads a 3D LUT of 17^3 nodes without a formula; expected a language with textures"),
        (["lut.cube", "--for", "shadertoy"], USAGE, "or a LUT for the application"),
        (["lut.cube", "--language", "glsl", "--tables", "formula"], USAGE, "without a formula; expected another kind of --tables"),
        (["agx_blender", "--language", "glsl"], USAGE, "nodes.rgba32f; expected -o FILE"),
        (["agx_blender", "--for", "shadertoy", "--tables", "texture"], USAGE, "expected --tables formula: no texture is possible there"),
        (["--all", scratch / "npm", "--npm"], USAGE, "no option --npm; `tonewright shader --help-all` lists all; use build/release/bin/tonewright_tools npm -o FOLDER"),
        (["--all", "/dev/null"], FILE, "/dev/null"),
        (["camera_response", "--language", "c", "--tables", "texture"], USAGE, "tables is texture; expected array"),
        (["agx_blender", "--language", "wgsl", "--tables", "array"], USAGE, "expected --tables formula or texture: an array should hold at most 4096"),
        (["hable", "--for", "nuk"], USAGE, "did you mean nuke?"),
        (["hable", "--language", "c", "--curves", "fit"], USAGE, "did you mean fitted?"),
        (["drago", "--language", "c", "--uniforms", "log_avrage"], USAGE, "did you mean log_average?"),
        (["--all", scratch / "all", "--uniforms", "exposure"], USAGE, "shader: --all is given"),
        (["hable", "--language", "c", "--tables", "textures"], USAGE, "did you mean texture?"),
        (["hable", "--language", "c", "-o", scratch / "no" / "x.h"], FILE, "write: "),
        (["hable", "--language", "c", "-o", "/dev/null"], FILE, "/dev/null"),
    ]:
        got, out, err = call(command, *(scratch / a if a == "lut.cube" else a for a in arguments))
        what = " ".join(map(str, arguments))
        report.check(what, (got, out) == (code, "") and words in err and err.count("\n") == 1 + err.count("warning: "), f"{got} {out} {err}")


def test_files(report, command, scratch):
    path = scratch / "hable.h"
    code, out, err = call(command, "hable", "--language", "c", "-o", path)
    report.check("-o says what it wrote", (code, out) == (OK, "") and "tw_hable(), in float within" in err, err)
    code, text, err = call(command, "hable", "--language", "c")
    report.check("without -o: standard output", (code, text, err) == (OK, path.read_text(), ""), err)
    # The extension decides, and contradicts nothing.
    for name, language, begin in [("a.glsl", "", "vec3 tw_"), ("a.wgsl", "", "fn tw_"), ("a.metal", "", "inline float3 tw_"),
                                  ("b.glsl", "glsl-es", "vec3 tw_"), ("a.dctl", "dctl", "__DEVICE__"), ("a.c", "c", "static"),
                                  ("a.txt", "hlsl", "float3 tw_")]:
        code, _, err = call(command, "hable", "-o", scratch / name, *(["--language", language] if language else []))
        report.check(f"-o {name} {language}", code == OK and f"\n{begin}" in (scratch / name).read_text(), err)
    # Blender's AgX: 57^3 nodes, the last of them the whitest.
    code, _, err = call(command, "agx_blender", "--language", "glsl", "-o", scratch / "agx.glsl")
    textures = sorted(scratch.glob("*.rgba32f"))
    report.check("textures beside the text", code == OK and textures and all(t.name in err for t in textures), err)
    for texture in textures:
        texels = np.fromfile(texture, "<f4").reshape(-1, 4)
        edge = round(len(texels) ** (1 / 3))
        report.check(f"{texture.name} is a cube of RGBA", edge**3 == len(texels) and (texels[:, 3] == 1).all())
        report.check(f"{texture.name} is what the text reads", texture.stem in (scratch / "agx.glsl").read_text())
    tables = {}
    for kind in "array", "texture":
        code, _, err = call(command, "camera_response", "--language", "glsl-es", "--tables", kind, "-o", scratch / f"{kind}.glsl")
        tables[kind] = (scratch / f"{kind}.glsl").read_text()
    texels = np.fromfile(scratch / "tw_camera_response_curve_table_values.rgba32f", "<f4").reshape(-1, 4)
    numbers = [float(x) for x in tables["array"].split("float[1024](")[1].split(")")[0].split(",")]
    report.check("--tables texture holds what --tables array does", code == OK and np.array_equal(texels[:, 0], np.float32(numbers)), err)
    report.check("and says how it is loaded", "gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA32F, 256, 4, 1, 0," in tables["texture"])
    for operator, words in [("gt7", "warning: tw_gt7 is up to"), ("drago", "measures each picture, which a shader cannot do")]:
        code, text, err = call(command, operator, "--language", "c")
        report.check(f"{operator} warns", code == OK and words in err and f"tw_{operator}(" in text, err)
    # Khronos PBR Neutral takes 0.04 from colors whose smallest channel is 0.08 or more, and nothing else from dark ones.
    code, text, _ = call(command, "khronos_neutral", "--language", "c", "--inverse")
    report.check("--inverse", code == OK and "tw_khronos_neutral_inverse(const float in[3], float out[3])" in text, text)
    source = scratch / "inverse.c"
    source.write_text(text + '#include <stdio.h>\nint main(void) { float a[3] = {0.26f, 0.16f, 0.06f}, b[3];'
                      ' tw_khronos_neutral_inverse(a, b); printf("%g %g %g", b[0], b[1], b[2]); return 0; }\n')
    subprocess.run(["gcc", source, "-o", scratch / "inverse", "-lm"], check=True)
    numbers = [float(x) for x in subprocess.run([scratch / "inverse"], capture_output=True, check=True).stdout.split()]
    report.check("the inverse brings light back", np.allclose(numbers, [0.3, 0.2, 0.1], atol=1e-6), numbers)


# What obs-shaderfilter puts before the file; HLSL has no annotations of effects.
OBS = """Texture2D image;
SamplerState textureSampler;
struct VertData { float2 uv : TEXCOORD0; };
#define TARGET SV_Target
"""
# The part of Filament's headers that a tone mapper takes.
FILAMENT = {"filament/ToneMapper.h": "namespace filament { struct ToneMapper { virtual ~ToneMapper() = default;\n"
                                     "virtual math::float3 operator()(math::float3 c) const noexcept = 0; }; }\n",
            "math/vec3.h": "#pragma once\nnamespace filament { namespace math { struct float3 { float x, y, z; }; } }\n"}


def test_filament(report, command, scratch):
    """Its class, compiled against a stand-in, takes and gives linear Rec.2020."""
    for name, text in FILAMENT.items():
        (scratch / name).parent.mkdir(exist_ok=True)
        (scratch / name).write_text(text)
    for operator, arguments, bound in (("agx_blender", [], 1e-5), ("hable", ["--uniforms", "white"], 1e-6)):
        code, _, err = call(command, operator, "--for", "filament", *arguments, "-o", scratch / "mapper.h")
        report.check(f"{operator}: it is written", code == OK, err)
        (scratch / "main.cpp").write_text(f"""#include <math/vec3.h>
#include "mapper.h"
#include <cstdio>
int main() {{
    const tw_{operator}_ToneMapper mapper;
    float r, g, b;
    while (std::scanf("%f %f %f", &r, &g, &b) == 3) {{
        const auto c = mapper({{r, g, b}});
        std::printf("%.9g %.9g %.9g\\n", c.x, c.y, c.z);
    }}
}}
""")
        subprocess.run(["g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", f"-I{scratch}", scratch / "main.cpp", "-o", scratch / "main"],
                       check=True)
        scene = np.concatenate([np.repeat(0.18 * 2.0 ** np.arange(-10, 10), 3).reshape(-1, 3),
                                2.0 ** np.random.default_rng(2).uniform(-8, 6, (200, 3)), np.eye(3) * 4]).astype(np.float32)
        text = "\n".join(" ".join(f"{x:.9g}" for x in row) for row in scene)
        shown = subprocess.run([scratch / "main"], input=text, check=True, capture_output=True, text=True).stdout
        right = reference(command, operator, scene, "--input", "lin_rec2020", "--display", "linear")
        to_rec2020 = np.array([[0.627403896, 0.329283038, 0.043313066], [0.069097289, 0.919540395, 0.011362316],
                               [0.016391439, 0.088013308, 0.895595253]])  # ITU-R BT.2087
        report.bound(operator, np.abs(np.array(shown.split(), float).reshape(-1, 3) - right @ to_rec2020.T).max(), bound)


def test_applications(report, command, scratch):
    code, listing, _ = call(command, "--list")
    applications = [line.split()[0] for line in re.split("applications.*\n", listing)[1].splitlines()]
    report.check("--list names them", code == OK and {"threejs", "bevy", "godot", "mpv", "resolve"} <= set(applications))
    texts = {}
    for application in applications:
        path = scratch / f"file.{application}"
        code, _, err = call(command, "hable", "--for", application, "--uniforms", "exposure,white", "-o", path)
        texts[application] = path.read_text()
        report.check(f"--for {application}", code == OK and "tw_hable" in texts[application] and
                     not {"@function", "@call", "@arguments", "@declarations"} & set(texts[application].split()), err)
    report.check("sliders of mpv", "//!PARAM white" in texts["mpv"])
    report.check("sliders of Resolve", "DEFINE_UI_PARAMS(white, white, DCTLUI_SLIDER_FLOAT, 11.2f, 0.1f, 65504.0f, 0.01)" in texts["resolve"])
    report.check("knobs of Nuke", 'defineParam(white, "white", 11.2f);' in texts["nuke"] and texts["nuke"].startswith("// Hable"))
    report.check("the first lines of Godot", texts["godot"].startswith("@tool\nextends CompositorEffect\n"))
    report.check("sliders of Godot", "@export_range(0.1, 65504.0) var white := 11.2" in texts["godot"])
    if not shutil.which("glslangValidator"):
        print("skipped: files for Godot, mpv, Shadertoy and GStreamer were not validated: glslangValidator is not installed")
        return
    no_parameters = "\n".join(line for line in texts["mpv"].split("//!HOOK")[1].splitlines()[1:] if not line.startswith("//!"))
    for name, stage, options, text in [
        ("godot", "comp", ["-V", "-o", "/dev/null"], texts["godot"].split('"""')[1].replace("\\", "")),
        ("gstreamer", "frag", [], texts["gstreamer"]),
        ("obs", "frag", ["-D", "-V", "-o", "/dev/null", "-e", "entry"], OBS + re.sub(r"<.*?>(?= = )", "", texts["obs"], flags=re.S)
         + "float4 entry(float2 uv : TEXCOORD0) : SV_Target { VertData v; v.uv = uv; return mainImage(v); }\n"),
        ("shadertoy", "frag", [], "#version 300 es\nprecision highp float;\nuniform sampler2D iChannel0;\nuniform vec3 iResolution;\n"
         "out vec4 o;\n" + texts["shadertoy"] + "void main() { mainImage(o, gl_FragCoord.xy); }\n"),
        ("mpv", "frag", [], "#version 330\nuniform float exposure, white;\nvec4 HOOKED_texOff(float x) { return vec4(x); }\n"
         "out vec4 o;\n" + no_parameters + "\nvoid main() { o = hook(); }\n"),
    ]:
        path = scratch / f"{name}.{stage}"
        path.write_text(text)
        done = subprocess.run(["glslangValidator", *options, path], capture_output=True, text=True, check=False)
        report.check(f"glslangValidator takes the file for {name}", done.returncode == 0, done.stdout)
