# SPDX-License-Identifier: Apache-2.0
"""Modules for JavaScript renderers, from the text of `tonewright shader --language glsl-es`.

Stands in for `--for babylon`, `playcanvas`, `cesium` and `postprocessing` until src/shader/wrapper.cpp has them: the
same patterns. `@textures` are the lines of `texture`, `@data` those of DATA, per 3D LUT: @name, @edge, @data.
"""
import base64
import dataclasses
import pathlib
import re

import numpy as np


@dataclasses.dataclass
class Wrapper:
    before: str
    after: str
    argument: str  # per argument: @name, @help, @value
    argument_in_call: str
    uniform: str = ""  # per argument, in JavaScript
    texture: str = ""  # per 3D LUT, in JavaScript
    declaration: str = "uniform highp sampler3D {name};\n"
    fetch: str = "texelFetch({name}, ivec3({x}, {y}, {z}), 0)"


# After the module's last line, and only if there is a 3D LUT.
HALVES = ("\n// Half floats, RGBA, x running fastest.\n"
          "const halves = (text) => new Uint16Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);\n")
DATA = "const @name_data = '@data';\n"

WRAPPERS = {
    "babylon": Wrapper(
        before="import { ShaderStore } from '@babylonjs/core/Engines/shaderStore.js';\n"
               "import { ImageProcessingConfiguration } from "
               "'@babylonjs/core/Materials/imageProcessingConfiguration.js';\n"
               "import '@babylonjs/core/Shaders/ShadersInclude/imageProcessingFunctions.js';\n"
               "@[import { Constants } from '@babylonjs/core/Engines/constants.js';\n"
               "import { RawTexture3D } from '@babylonjs/core/Materials/Textures/rawTexture3D.js';\n@]"
               "\n"
               "// Call it before materials are compiled. Takes the place of TONEMAPPING_ACES on the whole page.\n"
               "export function use_@function(scene) {\n"
               "    const store = ShaderStore.IncludesShadersStore;\n"
               "    store.imageProcessingFunctions = store.imageProcessingFunctions.replace(\n"
               "        /(vec3 ACESFitted|\\/\\/ Tonewright)[^]*?(?=\\n#endif)/, code);\n"
               "    const settings = scene.imageProcessingConfiguration;\n"
               "    settings.toneMappingType = ImageProcessingConfiguration.TONEMAPPING_ACES;\n"
               "    settings.toneMappingEnabled = true;\n"
               "@textures"
               "}\n\n"
               "const code = /* glsl */`// Tonewright\n",
        after="@arguments\n"
              "vec3 ACESFitted(vec3 color) {\n"
              "    vec3 shown = @function(color@call);\n"
              "    return max(shown, vec3(0.0)); // Babylon.js encodes it with a power\n"
              "}\n"
              "`.trimEnd();\n",
        argument="const float @name_value = @value; // @help\n",
        argument_in_call="@name_value",
        texture="    // The 3D LUT has the place of the color grading texture, at the weight 0.\n"
                "    const grid = new RawTexture3D(halves(@name_data), @edge, @edge, @edge, "
                "Constants.TEXTUREFORMAT_RGBA, scene, false,\n"
                "        false, Constants.TEXTURE_NEAREST_SAMPLINGMODE, Constants.TEXTURETYPE_HALF_FLOAT);\n"
                "    grid.level = 0;\n"
                "    settings.colorGradingTexture = grid;\n"
                "    settings.colorGradingEnabled = true;\n",
        declaration="",
        fetch="texelFetch(txColorTransform, ivec3({x}, {y}, {z}), 0)"),
    "playcanvas": Wrapper(
        before="import { SHADERLANGUAGE_GLSL, ShaderChunks@[, ADDRESS_CLAMP_TO_EDGE, FILTER_NEAREST, "
               "PIXELFORMAT_RGBA16F, Texture@] } from 'playcanvas';\n\n"
               "// Call it before materials are compiled, then: camera.toneMapping = TONEMAP_ACES2.\n"
               "export function use_@function(device) {\n"
               "    ShaderChunks.get(device, SHADERLANGUAGE_GLSL).set('tonemappingAces2PS', code);\n"
               "@uniforms"
               "@textures"
               "}\n\n"
               "const code = /* glsl */`\n",
        after="@arguments\n"
              "vec3 toneMap(vec3 color) {\n"
              "    vec3 shown = @function(getExposure() * color@call);\n"
              "    return max(shown, vec3(0.0)); // PlayCanvas encodes it with a power\n"
              "}\n"
              "`;\n",
        argument="uniform float tw_@name; // @help\n",
        argument_in_call="tw_@name",
        uniform="    device.scope.resolve('tw_@name').setValue(@value);\n",
        texture="    device.scope.resolve('@name').setValue(new Texture(device, {\n"
                "        name: '@name', width: @edge, height: @edge, depth: @edge, volume: true, mipmaps: false,\n"
                "        format: PIXELFORMAT_RGBA16F, levels: [halves(@name_data)], minFilter: FILTER_NEAREST, "
                "magFilter: FILTER_NEAREST,\n"
                "        addressU: ADDRESS_CLAMP_TO_EDGE, addressV: ADDRESS_CLAMP_TO_EDGE, addressW: "
                "ADDRESS_CLAMP_TO_EDGE,\n"
                "    }));\n"),
    "cesium": Wrapper(
        before="import { PostProcessStage, PostProcessStageLibrary, Tonemapper@[, PixelDatatype, Sampler, Texture3D@] } "
               "from '@cesium/engine';\n\n"
               "// Takes the place of Tonemapper.ACES in this scene, and works with scene.highDynamicRange = true.\n"
               "export function use_@function(scene) {\n"
               "@textures"
               "    const stage = new PostProcessStage({\n"
               "        name: 'czm_aces',\n"
               "        fragmentShader: code,\n"
               "        uniforms: {\n"
               "            exposure: 1,\n"
               "@uniforms"
               "        },\n"
               "    });\n"
               "    const own = PostProcessStageLibrary.createAcesTonemappingStage;\n"
               "    PostProcessStageLibrary.createAcesTonemappingStage = () => stage;\n"
               "    scene.postProcessStages.tonemapper = Tonemapper.REINHARD; // only a change asks for a stage\n"
               "    scene.postProcessStages.tonemapper = Tonemapper.ACES;\n"
               "    PostProcessStageLibrary.createAcesTonemappingStage = own;\n"
               "    return stage;\n"
               "}\n\n"
               "const code = /* glsl */`\n",
        after="@arguments\n"
              "uniform highp sampler2D colorTexture;\n"
              "uniform float exposure;\n"
              "in vec2 v_textureCoordinates;\n\n"
              "void main() {\n"
              "    vec4 color = texture(colorTexture, v_textureCoordinates);\n"
              "    vec3 shown = @function(exposure * color.rgb@call);\n"
              "    out_FragColor = vec4(czm_inverseGamma(max(shown, vec3(0.0))), color.a);\n"
              "}\n"
              "`;\n",
        argument="uniform float tw_@name; // @help\n",
        argument_in_call="tw_@name",
        uniform="            tw_@name: @value,\n",
        texture="    const @name = new Texture3D({\n"
                "        context: scene.context, pixelDatatype: PixelDatatype.HALF_FLOAT, sampler: Sampler.NEAREST, flipY: "
                "false,\n"
                "        source: { width: @edge, height: @edge, depth: @edge, arrayBufferView: halves(@name_data) },\n"
                "    });\n"),
    "postprocessing": Wrapper(
        before="import { Uniform@[, Data3DTexture, HalfFloatType@] } from 'three';\n"
               "import { BlendFunction, Effect } from 'postprocessing';\n\n"
               "// An effect after bloom; effects that take the displayed picture, such as noise, go after it.\n"
               "export class @function_Effect extends Effect {\n"
               "    constructor() {\n"
               "        const uniforms = new Map();\n"
               "@uniforms"
               "@textures"
               "        super('@function', code, { blendFunction: BlendFunction.SRC, uniforms });\n"
               "    }\n"
               "}\n\n"
               "const code = /* glsl */`\n",
        after="@arguments\n"
              "uniform float toneMappingExposure; // three.js sets it\n\n"
              "void mainImage(const in vec4 color, const in vec2 uv, out vec4 result) {\n"
              "    vec3 shown = @function(toneMappingExposure * color.rgb@call);\n"
              "    result = vec4(max(shown, vec3(0.0)), color.a); // three.js encodes it with a power\n"
              "}\n"
              "`;\n",
        argument="uniform float @name; // @help\n",
        argument_in_call="@name",
        uniform="        uniforms.set('@name', new Uniform(@value));\n",
        texture="        const @name = new Data3DTexture(halves(@name_data), @edge, @edge, @edge);\n"
                "        @name.type = HalfFloatType;\n"
                "        @name.needsUpdate = true;\n"
                "        uniforms.set('@name', new Uniform(@name));\n"),
}


def module_of(host: str, text: str, folder: pathlib.Path, arguments: list = ()) -> str:
    """text: of `tonewright shader --language glsl-es`, with the files of its 3D LUTs in the folder.
    arguments: (name, help, value)."""
    wrapper = WRAPPERS[host]
    function = re.findall(r"^vec3 (\w+)\(", text, re.M)[-1]
    # Babylon.js writes `precision highp float` at the beginning, unless it stands anywhere in the text. All have it there.
    text = text.replace("\nprecision highp float;\nprecision highp int;\n", "")
    grids = re.findall(r"^// (\w+): (\d+) x \2 x \2 texels", text, re.M)
    for name, _ in grids:
        text = re.sub(rf"// {name}: .*?\nuniform highp sampler3D {name};\n",
                      lambda _, name=name: wrapper.declaration.format(name=name), text, flags=re.S)
        text = re.sub(rf"texelFetch\({name}, ivec3\((.*?), (.*?), (.*?)\), 0\)",
                      lambda m, name=name: wrapper.fetch.format(name=name, x=m[1], y=m[2], z=m[3]), text)

    def each(pattern: str) -> str:
        lines = ""
        for name, help_text, value in arguments:
            lines += pattern.replace("@name", name).replace("@help", help_text).replace("@value", str(float(value)))
        return lines

    def of_grids(pattern: str) -> str:
        lines = ""
        for name, edge in grids:
            data = np.fromfile(folder / f"{name}.rgba32f", np.float32).astype(np.float16).tobytes()
            lines += pattern.replace("@name", name).replace("@edge", edge).replace("@data", base64.b64encode(data).decode())
        return lines

    uniforms = each(wrapper.uniform)
    if host == "cesium":
        uniforms += of_grids("            @name: () => @name,\n")

    def filled(pattern: str) -> str:
        pattern = re.sub(r"@\[(.*?)@\]", r"\1" if grids else "", pattern, flags=re.S)
        call = "".join(", " + wrapper.argument_in_call.replace("@name", name) for name, *_ in arguments)
        pattern = pattern.replace("@textures", of_grids(wrapper.texture)).replace("@uniforms", uniforms)
        return pattern.replace("@arguments", each(wrapper.argument)).replace("@function", function).replace("@call", call)

    end = HALVES + of_grids(DATA) if grids else ""
    return filled(wrapper.before) + text + filled(wrapper.after) + end
