# SPDX-License-Identifier: Apache-2.0
"""Executes the tone mappers of other programs: their own GLSL and WGSL in Chromium, their JavaScript in node, ffmpeg and OpenCV.

Shader source is taken from the installed npm packages when a test runs. Nothing of it is committed. An engine's function returns
the tone mappers of the table of `tonewright list --engines` by name.
"""
import concurrent.futures
import contextlib
import fcntl
import json
import pathlib
import re
import subprocess
import tempfile
from dataclasses import dataclass
from typing import Callable

import numpy as np
from browser import run_page
from pictures import need_program, skip

SHADER_PAGE = pathlib.Path(__file__).resolve().parents[1] / "shader/functions.html"
WIDTH = 1024  # the page takes whole rows


def colors() -> np.ndarray:
    """22 grays from 0 to 100, 20 colors, and 200 random ones up to 95."""
    grays = np.concatenate([[0], np.geomspace(1e-3, 100, 21)])
    listed = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1), (4, 0, 0), (0, 4, 0), (0, 0, 4), (2, 1, 0.5),
              (0.5, 1, 8), (0.18, 0.09, 0.02), (0.02, 0.18, 0.05), (0.4, 0.25, 0.18), (0.8, 0.6, 0.5), (16, 8, 1), (1, 16, 4),
              (2, 3, 60), (90, 5, 0.01), (0.001, 0.002, 0.003)]
    random = 10 ** np.random.default_rng(46).uniform(-3, np.log10(95), (200, 3))
    return np.concatenate([np.repeat(grays[:, None], 3, 1), listed, random]).astype(np.float32)


# --------------------------------------------------------------------------------------------------
# Source text


def read(path: pathlib.Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace")


def template(text: str, after: str = "") -> str:
    """The first JavaScript template literal after a text."""
    begin = text.index("`", text.index(after) + len(after)) + 1
    return text[begin:text.index("`", begin)]


def around(text: str, inside: str) -> str:
    """The template literal that has this text in it."""
    at = text.index(inside)
    return text[text.rindex("`", 0, at) + 1:text.index("`", at)]


def literal(text: str, name: str) -> str:
    """The JavaScript string of a variable."""
    return json.loads(re.search(rf'\bvar {name} = ("(?:[^"\\]|\\.)*")', text)[1])


def block_end(text: str, begin: int) -> int:
    """The end of the braces that open first."""
    depth, at = 0, text.index("{", begin)
    while True:
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        at += 1
        if depth == 0:
            return at


def function(text: str, name: str) -> str:
    """A definition in GLSL or WGSL."""
    found = re.search(rf"(?:\bfn|\b(?:void|float|vec[234]))\s+{name}\s*\([^)]*\)[^;{{]*{{", text)
    if not found:
        raise LookupError(f"no function {name}")
    return text[found.start():block_end(text, found.start())] + "\n"


def library(text: str, values: dict | None = None) -> str:
    """A fragment shader as a library: without main(), inputs and outputs; uniforms that `values` names are constants."""
    for name, value in (values or {}).items():
        text = re.sub(rf"uniform\s+(?:(?:low|medium|high)p\s+)?(\w+)\s+{name}\s*;", rf"const \1 {name} = {value};", text)
    text = re.sub(r"^\s*(?:uniform|varying|in|out)\b[^;{}()]*;", "", text, flags=re.M)
    while main := re.search(r"\bvoid\s+main\s*\(", text):
        text = text[:main.start()] + text[block_end(text, main.start()):]
    return text


def main_of(text: str, values: dict) -> str:
    """A fragment shader as `vec3 engine(vec3)`: the sampled color goes in, the written one comes out."""
    main = re.search(r"\bvoid\s+main\s*\(", text)
    body = text[main.start():block_end(text, main.start())]
    body = re.sub(r"\b(?:gl_FragColor|out_FragColor)\b", "engine_out", body)
    body = re.sub(r"\bvoid\s+main\s*\([^)]*\)", "void engine_main()", body)
    body = re.sub(r"\btexture(?:2D)?\s*\([^()]*\)", "engine_in", body)
    return ("vec4 engine_in, engine_out;\n" + library(text, values) + body +
            "\nvec3 engine(vec3 c) { engine_in = vec4(c, 1.0); engine_main(); return engine_out.rgb; }\n")


@dataclass
class Shader:
    """call: an expression of the color `c`."""
    text: str
    call: str
    language: str = "glsl-es"

    def program(self) -> str:
        if self.language == "wgsl":
            return f"""{self.text}
@group(1) @binding(0) var<storage, read> colors: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> shown: array<vec4<f32>>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
    let c = colors[id.x].rgb;
    shown[id.x] = vec4<f32>({self.call}, 1.0);
}}
"""
        return f"""#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D colors;
out vec4 shown;
{self.text}
void main() {{ vec3 c = texelFetch(colors, ivec2(gl_FragCoord.xy), 0).rgb; shown = vec4({self.call}, 1.0); }}
"""


# A name of the table -> a shader, or a function of colors.
ToneMappers = dict[str, Shader | Callable[[np.ndarray], np.ndarray]]
EXPOSURE = {"toneMappingExposure": "1.0", "exposure": "1.0"}
CHUNKS = "src/renderers/shaders/ShaderChunk"


def three_chunk(package: pathlib.Path, name: str = "tonemapping_pars_fragment") -> str:
    return library(template(read(package / CHUNKS / f"{name}.glsl.js")), EXPOSURE)


def named(text: str, calls: dict) -> ToneMappers:
    return {name: Shader(text, call) for name, call in calls.items()}


# --------------------------------------------------------------------------------------------------
# Engines


def three(package):
    names = ["Linear", "Reinhard", "Cineon", "ACESFilmic", "AgX", "Neutral"]
    return named(three_chunk(package), {f"{name}ToneMapping": f"{name}ToneMapping(c)" for name in names})


def three_agx(package):
    return named(three_chunk(package), {"AgXToneMapping": "AgXToneMapping(c)"})


def babylon(package):
    includes = package / "Shaders/ShadersInclude"
    # Its engine defines this by an option, which is off.
    text = "#define USE_EXACT_SRGB_CONVERSIONS 0\n" + "\n".join(
        template(read(includes / f"{name}.js")) for name in ("helperFunctions", "imageProcessingFunctions"))
    modes = {"no tone mapping": 0, "TONEMAPPING_STANDARD": 1, "TONEMAPPING_ACES": 2, "TONEMAPPING_KHR_PBR_NEUTRAL": 3}
    call = "applyImageProcessing(vec4(c, 1.0)).rgb"
    found = {name: Shader(f"#define TONEMAPPING {mode}\n{text}", call) for name, mode in modes.items()}
    found["contrast 1.5, no tone mapping"] = Shader(
        f"#define TONEMAPPING 0\n#define CONTRAST\nconst float contrast = 1.5;\n{text}", call)
    pixel = main_of(template(read(package / "Shaders/tonemap.fragment.js")), {"_ExposureAdjustment": "1.0"})
    for name, define in {"Reinhard": "REINHARD", "Hable": "HABLE", "HejiDawson": "OPTIMIZED_HEJIDAWSON",
                         "Photographic": "PHOTOGRAPHIC"}.items():
        found[f"TonemapPostProcess {name}"] = Shader(f"#define {define}_TONEMAPPING\n{pixel}", "engine(c)")
    return found


def playcanvas_chunk(package: pathlib.Path, name: str) -> Shader:
    """In the folder of the chunks, which moved between releases."""
    file = next(path for path in sorted(package.glob(f"build/playcanvas*/**/tonemapping{name}.js"))
                if "wgsl" not in path.parts and not re.search(r"\.(?:dbg|prf|min)\.", str(path)))
    text = template(read(file))
    return Shader("float getExposure() { return 1.0; }\n" + library(text, EXPOSURE), "toneMap(c)")


def playcanvas(package):
    return {f"TONEMAP_{name.upper()}": playcanvas_chunk(package, name)
            for name in ("Linear", "Filmic", "Hejl", "Aces", "Aces2", "Neutral")}


def playcanvas_aces2(package):
    return {"TONEMAP_ACES2": playcanvas_chunk(package, "Aces2")}


def cesium(package):
    shaders = package / "Source/Shaders"
    builtin = "#define czm_inverseGamma(x) (x)\n" + "".join(
        read(shaders / f"Builtin/Functions/{name}.glsl")
        for name in ("branchFreeTernary", "acesTonemapping", "pbrNeutralTonemapping"))

    def stage(name, white=1):
        text = read(shaders / f"PostProcessStages/{name}.glsl")
        return Shader(builtin + main_of(text, {"exposure": "1.0", "white": f"vec3({white}.0)"}), "engine(c)")

    return {"REINHARD": stage("ReinhardTonemapping"), "MODIFIED_REINHARD": stage("ModifiedReinhardTonemapping"),
            "MODIFIED_REINHARD, white 4": stage("ModifiedReinhardTonemapping", 4), "FILMIC": stage("FilmicTonemapping"),
            "ACES": stage("AcesTonemappingStage"), "PBR_NEUTRAL": stage("PbrNeutralTonemapping")}


def postprocessing(package, three_package):
    text = template(read(package / "build/index.js"), "var tone_mapping_default = ")
    # three.js writes this function into every program.
    module = (three_package / "build/three.module.js").resolve().as_uri()
    weights = node(f"import {{ ColorManagement, Vector3 }} from '{module}';\n"
                   "console.log(ColorManagement.getLuminanceCoefficients(new Vector3()).toArray().map((x) => x.toFixed(4)).join());")
    luminance = f"float luminance(const in vec3 rgb) {{ const vec3 weights = vec3({weights.strip()}); return dot(weights, rgb); }}\n"
    text = text.replace("#include <tonemapping_pars_fragment>", luminance + three_chunk(three_package))
    # The luminance of the adaptive mode is what the picture measures; here it is 1.
    text = "float unpackRGBAToFloat(vec4 texel) { return 1.0; }\n#define texture2D(sampler, place) vec4(1.0)\n" + library(
        text, {"whitePoint": "4.0", "middleGrey": "0.6", "averageLuminance": "1.0"})
    text += "\nvec3 engine(vec3 c) { vec4 shown; mainImage(vec4(c, 1.0), vec2(0.0), shown); return shown.rgb; }\n"
    modes = {"LINEAR": (0, "Linear"), "REINHARD": (1, "Reinhard"), "REINHARD2": (2, "Linear"), "REINHARD2_ADAPTIVE": (3, "Linear"),
             "UNCHARTED2": (4, "Linear"), "CINEON": (6, "Cineon"), "ACES_FILMIC": (7, "ACESFilmic"), "AGX": (8, "AgX"),
             "NEUTRAL": (9, "Neutral")}
    return {name: Shader(f"#define TONE_MAPPING_MODE {mode}\n#define toneMapping(texel) {curve}ToneMapping(texel)\n{text}", "engine(c)")
            for name, (mode, curve) in modes.items()}


def model_viewer(package, three_package):
    """Its names are three.js's, and anything else is Neutral."""
    names = dict(re.findall(r"\['(\w+)', (\w+ToneMapping)\]", read(package / "lib/features/environment.js")))
    default = re.search(r": (\w+ToneMapping);", read(package / "lib/features/environment.js"))[1]
    names = {"neutral": default} | {name: curve for name, curve in names.items() if curve != "NoToneMapping"}
    return named(three_chunk(three_package), {name: f"{curve}(c)" for name, curve in names.items()})


def model_viewer_3(package):
    text = template(read(package / "lib/three-components/Renderer.js"), "{ return color; }'")
    return named("const float toneMappingExposure = 1.0;\n" + text, {"commerce": "CustomToneMapping(c)"})


def gainmap_js(package):
    text = "#define saturate(x) clamp(x, 0.0, 1.0)\n" + library(around(read(package / "dist/encode.js"), "ACESFilmicToneMapping( vec3"),
                                                               EXPOSURE)
    text = re.sub(r"#ifndef saturate.*?#endif", "", text, flags=re.S)
    names = ["Linear", "Reinhard", "Cineon", "ACESFilmic", "AgX", "Neutral"]
    return named(text, {f"{name}ToneMapping": f"{name}ToneMapping(c)" for name in names})


def luma_effects(package):
    text = template(read(package / "dist/passes/postprocessing/image-adjust-filters/tone-mapping.js"), "const fs =")
    text = re.sub(r"\\\n", "", text)

    def with_maximum(maximum):
        values = f"struct Values {{ float exposure; float maximumLuminance; }};\nconst Values toneMapping = Values(1.0, {maximum}.0);\n"
        return Shader(values + re.sub(r"layout\(std140\)[^}]*}\s*\w+;", "", text),
                      "toneMapping_filterColor_ext(vec4(c, 1.0), vec2(1.0), vec2(0.0)).rgb")

    return {"toneMapping": with_maximum(1), "toneMapping, maximumLuminance 4": with_maximum(4)}


def luma_shadertools(package):
    text = read(package / "dist/modules/lighting/pbr-material/pbr-material-glsl.js")
    text = "".join(function(text, name) for name in
                   ("maxComponent", "encodeLinearSRGB", "toneMapKhronosPBRNeutral", "applySceneColorManagement"))
    scene = "#define USE_SCENE_COLOR_MANAGEMENT\nstruct Scene { float exposure; int toneMapMode; int outputEncoding; };\n"
    return {f"toneMapMode {mode}": Shader(f"{scene}const Scene pbrScene = Scene(1.0, {mode}, 0);\n{text}", "applySceneColorManagement(c)")
            for mode in (1, 2, 3)}


def galacean(package):
    text = read(package / "dist/module.js")

    def included(name):
        return re.sub(r"#include <(\w+)>", lambda found: included(found[1]), literal(text, name)) + "\n"

    common = re.search(r"#define PI .*", literal(text, "common"))[0] + "\n" + literal(text, "PostCommon").replace("#include <common>", "") + "\n"
    return {"Neutral": Shader(included("NeutralTonemapping"), "neutralTonemap(c)"),
            "ACES": Shader(common + included("ACESTonemapping"), "ACESTonemap(c)")}


def orillusion(package):
    text = read(package / "dist/orillusion.es.max.js")
    return {name: Shader(function(text, name), f"{name}(c, 1.0)", "wgsl") for name in ("ACESToneMapping", "CEToneMapping")}


def claygl(package):
    text = read(package / "src/shader/source/compositor/hdr.glsl")
    return named(function(text, "ACESToneMapping"), {"ACESToneMapping": "ACESToneMapping(c)"})


def x3dom(package):
    text = read(package / "x3dom.js").replace("\\n", "\n")
    names = ["tonemapReinhard", "uncharted2Tonemap", "tonemapUncharted2", "tonemapeFilmic"]
    return named("".join(function(text, name) for name in names),
                 {"reinhard": "tonemapReinhard(c)", "uncharted": "tonemapUncharted2(c)", "filmic": "tonemapeFilmic(c)"})


def lygia(package):
    def included(path):
        return re.sub(r'#include "([^"]+)"', lambda found: included(path.parent / found[1]), read(path)) + "\n"

    names = ["ACES", "Filmic", "Linear", "Reinhard", "ReinhardJodie", "Uncharted", "Uncharted2", "Unreal", "Debug"]
    return {f"tonemap{name}": Shader(included(package / f"color/tonemap/{name[0].lower() + name[1:] if name != 'ACES' else 'aces'}.glsl"),
                                     f"tonemap{name}(c)") for name in names}


def glsl_tone_map(package):
    names = ["aces", "filmic", "lottes", "reinhard", "reinhard2", "uchimura", "uncharted2", "unreal"]
    return {name: Shader(re.sub(r"#pragma.*", "", read(package / f"{name}.glsl")), f"{name}(c)") for name in names}


def three_stdlib(package, three_package):
    text = template(read(package / "shaders/ToneMapShader.js"), "fragmentShader:")
    common = function(template(read(three_package / CHUNKS / "common.glsl.js")), "linearToRelativeLuminance")
    values = {"middleGrey": "0.6", "minLuminance": "0.01", "maxLuminance": "16.0", "averageLuminance": "1.0"}
    return named(common + library(text.replace("#include <common>", ""), values), {"ToneMapShader": "ToneMap(c)"})


def mapbox(package):
    text = read(package / "dist/mapbox-gl-dev.js")
    at = text.index("vec3 uncharted2_tonemap(")
    constants = text[text.rindex("const float A=", 0, at):at]
    scale = re.compile(r"float white_scale=[\d.]+;").search(text, at)[0]
    color = re.compile(r"color=(uncharted2_tonemap\(.*?\*white_scale);").search(text, at)[1]
    body = f"vec3 engine(vec3 color) {{ float u_luminance = 1.0; {scale} return {color}; }}\n"
    return named(constants + function(text[at:], "uncharted2_tonemap") + body, {"sky, uncharted2_tonemap": "engine(c)"})


def nanogl_pbr(package):
    text = function(read(package / "glsl/includes/tonemap.glsl"), "ToneMapTB")
    return named(text + "vec3 engine(vec3 c) { ToneMapTB(c); return c; }\n", {"GAMMA_TB": "engine(c)"})


def ray_tracing_renderer(package):
    text = library(template(read(package / "src/renderer/glsl/toneMap.frag")))
    text = re.sub(r"#ifdef EDGE_PRESERVING_UPSCALE.*?#endif", "", text, flags=re.S)
    names = {"Reinhard": "reinhard", "Uncharted2": "uncharted2", "Cineon": "cineon", "ACESFilmic": "acesFilmic"}
    return named("#define WHITE_POINT 5.0\n" + text, {f"{name}ToneMapping": f"{call}(c)" for name, call in names.items()})


def needle(package, three_package):
    """The engine patches the shader chunk of its three.js; its own code does so here."""
    patch = re.sub(r"^(?:import|export) .*? from .*$|^export ", "", read(package / "lib/engine/engine_tonemapping.js"), flags=re.M)
    module = (three_package / "build/three.module.js").resolve().as_uri()
    script = f"import {{ ShaderChunk as chunks }} from '{module}';\nconst ShaderChunk = {{ ...chunks }};\nconst isDevEnvironment = () => true;\n"
    patched = node(script + patch + "\nconsole.log(ShaderChunk.tonemapping_pars_fragment);")
    return named(library(patched, EXPOSURE), {"AgXToneMapping": "AgXToneMapping(c)", "NeutralToneMapping": "NeutralToneMapping(c)"})


def hdrify(package):
    module = (package / "dist/tonemapping/mappers.js").resolve().as_uri()

    def mapper(name):
        def run(rgb):
            values = json.dumps(rgb.astype(float).ravel().tolist())
            text = node(f"import {{ getToneMapping }} from '{module}';\nconst rgb = new Float32Array({values});\n"
                        f"getToneMapping('{name}')(rgb, rgb, rgb.length / 3);\nconsole.log(JSON.stringify(Array.from(rgb)));")
            return np.array(json.loads(text)).reshape(-1, 3)
        return run

    return {name: mapper(name) for name in ("aces", "reinhard", "neutral", "agx")}


def node(script: str) -> str:
    """What a module prints."""
    need_program("node", "nodejs")
    done = subprocess.run(["node", "--input-type=module", "-"], input=script, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return done.stdout


def ffmpeg():
    """The filter tonemap with a peak of 100, so that all colors fit; `desat` needs a matrix on the frame."""
    def with_filter(options):
        def run(rgb):
            need_program("ffmpeg", "ffmpeg")
            planes = rgb[:, [1, 2, 0]].T.astype("<f4")  # gbrpf32le
            picture = ["-f", "rawvideo", "-pix_fmt", "gbrpf32le"]
            done = subprocess.run(
                ["ffmpeg", "-v", "error", *picture, "-s", f"{len(rgb)}x1", "-i", "-", "-vf",
                 f"setparams=color_trc=linear:colorspace=bt709,{options}:peak=100", *picture, "-"],
                input=planes.tobytes(), capture_output=True, check=False)
            if done.returncode:
                raise RuntimeError(done.stderr.decode())
            return np.frombuffer(done.stdout, "<f4").reshape(3, -1).T[:, [2, 0, 1]]
        return run

    curves = ["none", "linear", "gamma", "clip", "reinhard", "hable", "mobius"]
    return {f"tonemap={curve}{desat}": with_filter(f"tonemap={curve}{desat}") for desat in ("", ":desat=0") for curve in curves}


def opencv():
    """Module cv2. It takes the first channel for red, so pictures in its own order have the weights of red and blue swapped."""
    try:
        import cv2
    except ImportError:
        skip("the Python module cv2 is missing (Debian: python3-opencv)")

    def with_operator(operator):
        return lambda rgb: operator.process(np.ascontiguousarray(rgb[None, :, ::-1]))[0, :, ::-1]

    return {"createTonemap": with_operator(cv2.createTonemap(1.0)),
            "createTonemapReinhard": with_operator(cv2.createTonemapReinhard(1.0, 0.0, 1.0, 0.0)),
            "createTonemapDrago": with_operator(cv2.createTonemapDrago(1.0, 1.0, 0.85))}


def opencv_settings(name: str, rgb: np.ndarray) -> dict:
    """What OpenCV measures in the picture, for the operator's parameters; those of the result are missing."""
    largest = float(rgb.max())
    if name == "createTonemap":
        return {"divisor": largest}
    gray = rgb.astype(float) @ [0.114, 0.587, 0.299] / largest  # the smallest channel is 0
    logs = np.log(np.maximum(gray, 1e-4))
    if name == "createTonemapReinhard":
        key = (logs.max() - logs.mean()) / (logs.max() - logs.min())
        return {"maximum": largest, "contrast": 0.3 + 0.7 * key**1.4, "light_adaptation": 1}
    return {"maximum": largest, "maximum_gray": gray.max() * largest, "log_average": np.exp(logs.mean()) * largest}


@dataclass
class Engine:
    """Packages of npm, the program's first; `version` is that of the table's rows."""
    program: str
    version: str
    packages: list[str]
    tone_mappers: Callable[..., ToneMappers]
    is_light: bool = False  # a few small packages, for every run of the tests
    # Name, colors -> parameters that the program measures in the picture.
    settings: Callable[[str, np.ndarray], dict] | None = None

    @property
    def title(self) -> str:
        return f"{self.program} {self.version}"


ENGINES = [
    Engine("three.js", "0.187.0", ["three@0.187.0"], three, is_light=True),
    Engine("three.js", "0.161.0", ["three@0.161.0"], three_agx),
    Engine("three.js", "0.160.0", ["three@0.160.0"], three_agx),
    Engine("Babylon.js", "9.35.0", ["@babylonjs/core@9.35.0"], babylon),
    Engine("PlayCanvas", "2.23.3", ["playcanvas@2.23.3"], playcanvas),
    Engine("PlayCanvas", "1.60.0", ["playcanvas@1.60.0"], playcanvas_aces2),
    Engine("CesiumJS", "1.140", ["@cesium/engine@26.3.0"], cesium),
    Engine("postprocessing", "6.39.6", ["postprocessing@6.39.6", "three@0.187.0"], postprocessing, is_light=True),
    Engine("model-viewer", "4.4.0", ["@google/model-viewer@4.4.0", "three@0.183.0"], model_viewer),
    Engine("model-viewer", "3.4.0", ["@google/model-viewer@3.4.0"], model_viewer_3),
    Engine("gainmap-js", "3.7.3", ["@monogrid/gainmap-js@3.7.3"], gainmap_js, is_light=True),
    Engine("luma.gl", "9.4.2", ["@luma.gl/effects@9.4.2"], luma_effects),
    Engine("luma.gl", "9.4.2", ["@luma.gl/shadertools@9.4.2"], luma_shadertools),
    Engine("Galacean", "1.6.13", ["@galacean/engine-core@1.6.13"], galacean),
    Engine("Orillusion", "0.9.2", ["@orillusion/core@0.9.2"], orillusion),
    Engine("ClayGL", "1.3.0", ["claygl@1.3.0"], claygl),
    Engine("X3DOM", "1.8.3", ["x3dom@1.8.3"], x3dom),
    Engine("LYGIA", "1.4.1", ["lygia@1.4.1"], lygia, is_light=True),
    Engine("glsl-tone-map", "2.0.1", ["glsl-tone-map@2.0.1"], glsl_tone_map, is_light=True),
    Engine("three-stdlib", "2.36.1", ["three-stdlib@2.36.1", "three@0.122.0"], three_stdlib),
    Engine("Mapbox GL JS", "3.32.0", ["mapbox-gl@3.32.0"], mapbox),
    Engine("nanogl-pbr", "3.0.0-beta.16", ["nanogl-pbr@3.0.0-beta.16"], nanogl_pbr, is_light=True),
    Engine("ray-tracing-renderer", "0.10.15", ["ray-tracing-renderer@0.10.15"], ray_tracing_renderer, is_light=True),
    Engine("Needle Engine", "4.16.5", ["@needle-tools/engine@4.16.5", "@needle-tools/three@0.169.19"], needle),
    Engine("hdrify", "1.2.1", ["hdrify@1.2.1"], hdrify, is_light=True),
    Engine("ffmpeg", "5.1.9", [], ffmpeg, is_light=True),
    Engine("OpenCV", "4.6.0", [], opencv, settings=opencv_settings),
]


# --------------------------------------------------------------------------------------------------
# Packages


def fetch(package: str, folder: pathlib.Path) -> pathlib.Path:
    """The files of an npm package, without its dependencies: `name@version`, or `name@latest`.

    Unpacked into the folder, unless they are there. Raises RuntimeError where npm cannot load the package.
    """
    place = folder / package.replace("/", "+")
    if (place / "package.json").is_file():
        return place
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as work:
        options = ["--silent", "--ignore-scripts", "--fetch-retries=1", "--fetch-retry-mintimeout=1000"]
        done = subprocess.run(["npm", "pack", *options, "--pack-destination", work, package], capture_output=True, text=True,
                              check=False)
        archives = list(pathlib.Path(work).glob("*.tgz"))
        if done.returncode or not archives:
            raise RuntimeError((done.stderr.strip().splitlines() or ["no reason"])[0])
        subprocess.run(["tar", "xzf", archives[0], "-C", work], check=True)
        unpacked = next(path for path in pathlib.Path(work).iterdir() if path.is_dir())
        with contextlib.suppress(OSError):  # another process was faster
            unpacked.rename(place)
    return place


def packages_of(engines: list[Engine], folder: pathlib.Path) -> dict[str, pathlib.Path]:
    """The packages of the engines, by name and version; skips the test where npm cannot load one."""
    wanted = sorted({package for engine in engines for package in engine.packages})
    if wanted:
        need_program("npm", "npm")
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "w") as lock, concurrent.futures.ThreadPoolExecutor(4) as pool:  # tests run at the same time
        fcntl.flock(lock, fcntl.LOCK_EX)
        try:
            return dict(zip(wanted, pool.map(lambda package: fetch(package, folder), wanted), strict=True))
        except RuntimeError as error:
            return skip(f"npm cannot load the packages of engines ({error})")


# --------------------------------------------------------------------------------------------------
# Execution


def execute(tone_mappers: dict, rgb: np.ndarray) -> dict:
    """What each of them makes of the colors: any key -> shader or function, the same key -> colors."""
    shown = {key: mapper(rgb) for key, mapper in tone_mappers.items() if not isinstance(mapper, Shader)}
    row = np.zeros((-(-len(rgb) // WIDTH) * WIDTH, 4), np.float32)
    row[:len(rgb), :3] = rgb
    shaders = {key: mapper for key, mapper in tone_mappers.items() if isinstance(mapper, Shader)}
    for language in sorted({shader.language for shader in shaders.values()}):
        files, functions, keys = {"/colors": row.tobytes()}, [], []
        for key, shader in shaders.items():
            if shader.language != language:
                continue
            name = f"f{len(keys)}"
            files["/source/" + name] = shader.program().encode()
            functions.append({"source": "/source/" + name, "textures": [], "colors": "/colors", "out": name})
            keys.append(key)
        files["/job.json"] = json.dumps({"language": language, "functions": functions}).encode()
        posted = run_page(read(SHADER_PAGE), files)
        for number, key in enumerate(keys):
            shown[key] = np.frombuffer(posted[f"f{number}"], np.float32).reshape(-1, 4)[:len(rgb), :3]
    return shown


def tone_mappers_of(engine: Engine, packages: dict) -> ToneMappers:
    return engine.tone_mappers(*(packages[package] for package in engine.packages))
