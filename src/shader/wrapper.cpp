// SPDX-License-Identifier: Apache-2.0
#include "shader/wrapper.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/strings.h"
#include "shader/texture_form.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Text around the functions. In the patterns `@function` is the last function, `@call` are the
/// arguments after its color, each with a comma before it, `@names` their names, `@arguments` the
/// lines of `argument` and
/// `@declarations` those of `declaration`. Text between `@[` and `@]` is left out if there are no
/// arguments, and text between `@(` and `@)` if there are no textures; `@g(` and `@g)` are for
/// those of 3D LUTs, `@t(` and `@t)` for those of tables. `@header` is replaced by the comments of
/// the text, `@grids` and `@bindings` by the lines of the TextureForm, and `@other` by the
/// functions in the second language, `@numbers` by what reads the data of web pages.
struct Wrapper {
    const char* id;
    const char* before;
    const char* after;
    /// One per argument: @name, @help, @value, @min, @max.
    const char* argument;
    /// Name of an argument in the call of the function.
    const char* argument_in_call = "@name";
    const char* declaration = "";
    /// Prefix of each line of the functions.
    const char* indent = "";
};

constexpr Wrapper kWrappers[] = {
    {"threejs",
     "import { @(DataTexture, @)@t(FloatType, @t)@g(HalfFloatType, @g)@(Material, @)ShaderChunk@(, "
     "ShaderLib@) } from 'three';\n\n"
     "// Call it before materials are compiled, then: renderer.toneMapping = "
     "CustomToneMapping.\n"
     "export function use_@function() {\n"
     "@("
     "    const uniforms = {};\n"
     "    for (const [name, [width, height, type, Numbers, data]] of Object.entries(textures)) {\n"
     "        const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));\n"
     "        const texture = new DataTexture(new Numbers(bytes.buffer), width, height);\n"
     "        texture.type = type;\n"
     "        texture.clone = () => texture; // all materials share it\n"
     "        texture.needsUpdate = true;\n"
     "        uniforms[name] = { value: texture };\n"
     "    }\n"
     "    for (const shader of Object.values(ShaderLib)) Object.assign(shader.uniforms, "
     "uniforms);\n"
     "    // For materials with shaders of their own, such as that of OutputPass. Textures of "
     "their "
     "own stay.\n"
     "    Material.prototype.onBeforeCompile = (shader) => Object.assign(shader.uniforms, {\n"
     "        ...uniforms, ...shader.uniforms,\n"
     "    });\n"
     "@)"
     "    // three.js ends with its own CustomToneMapping, or with that of an earlier call.\n"
     "    ShaderChunk.tonemapping_pars_fragment = "
     "ShaderChunk.tonemapping_pars_fragment.replace(\n"
     "        /(vec3 CustomToneMapping|\\/\\/ Tonewright)[^]*/, code);\n"
     "}\n\n"
     "const code = /* glsl */`// Tonewright\n",
     "@arguments\n"
     "vec3 CustomToneMapping(vec3 color) {\n"
     "    vec3 shown = @function(toneMappingExposure * color@call);\n"
     "    return max(shown, vec3(0.0)); // three.js encodes it with a power\n"
     "}\n"
     "`;\n"
     "@(\n// Width, height and RGBA (base64): nodes of 3D LUTs in half floats, tables in 32-bit "
     "floats.\n"
     "const textures = {\n@grids};\n@)",
     "const float @name_value = @value; // @help"
     "\n",
     "@name_value"},
    // A function of WGSL or GLSL finds a texture by the name that its node has; the first node is
    // an argument, so that three.js declares the texture.
    {"threejs-tsl",
     "@g(import { Data3DTexture, HalfFloatType } from 'three/webgpu';\n@g)"
     "@t(import { DataTexture, FloatType } from 'three/webgpu';\n@t)"
     "import { Fn, glsl, glslFn@t(, ivec2@t)@g(, ivec3@g)@t(, texture@t)@g(, texture3D@g), wgsl, "
     "wgslFn } from 'three/tsl';\n\n"
     "const functions = wgsl(`\n",
     "`);\n\n"
     "// The same for WebGPURenderer without WebGPU.\n"
     "const functionsInGlsl = glsl(`@other`);\n\n"
     "@g("
     "// Nodes of a 3D LUT in half floats.\n"
     "const gridOf = (bytes, size) => {\n"
     "    const grid = new Data3DTexture(new Uint16Array(bytes), ...size);\n"
     "    grid.type = HalfFloatType;\n"
     "    grid.needsUpdate = true;\n"
     "    return texture3D(grid).load(ivec3(0));\n"
     "};\n@g)"
     "@t("
     "// Tables in 32-bit floats.\n"
     "const tablesOf = (bytes, size) => {\n"
     "    const tables = new DataTexture(new Float32Array(bytes), ...size);\n"
     "    tables.type = FloatType;\n"
     "    tables.needsUpdate = true;\n"
     "    return texture(tables).load(ivec2(0));\n"
     "};\n@t)"
     "@("
     "// Size and RGBA (base64).\n"
     "const textures = {\n@grids};\n"
     "const nodes = Object.entries(textures).map(([name, [nodeOf, size, data]]) => {\n"
     "    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));\n"
     "    return nodeOf(bytes.buffer, size).setName(name);\n"
     "});\n"
     "const bound = nodes.map((_, i) => ` + 0.0 * node_${i}.rgb`).join('');\n\n"
     "@)"
     "const inWgsl = wgslFn(`\n"
     "fn @function_exposed(color: vec3<f32>, exposure: f32@(${nodes.map((_, i) => `, node_${i}: "
     "vec4<f32>`).join('')}@)) -> vec3<f32> {\n"
     "@arguments"
     "    let shown = @function(color * exposure@call)@(${bound}@);\n"
     "    return max(shown, vec3<f32>(0.0)); // three.js encodes it with a power\n"
     "}\n"
     "`, [functions]);\n"
     "const inGlsl = glslFn(`\n"
     "vec3 @function_exposed(vec3 color, float exposure@(${nodes.map((_, i) => `, vec4 "
     "node_${i}`).join('')}@)) {\n"
     "@declarations"
     "    vec3 shown = @function(color * exposure@call)@(${bound}@);\n"
     "    return max(shown, vec3(0.0));\n"
     "}\n"
     "`, [functionsInGlsl]);\n\n"
     "// renderer.library.addToneMapping(@function, CustomToneMapping);\n"
     "export const @function = Fn(([color, exposure], { renderer }) =>\n"
     "    (renderer.backend.isWebGPUBackend ? inWgsl : inGlsl)(color, exposure@(, ...nodes@)));\n",
     "    let @name_value = @value; // @help\n", "@name_value",
     "    float @name_value = @value; // @help\n"},
    {"bevy", "#define_import_path tonewright::@function\n\n",
     "\n#import bevy_core_pipeline::fullscreen_vertex_shader::FullscreenVertexOutput\n\n"
     "@group(0) @binding(0) var screen_texture: texture_2d<f32>;\n"
     "@group(0) @binding(1) var texture_sampler: sampler;\n"
     "@arguments\n"
     "@fragment\n"
     "fn fragment(in: FullscreenVertexOutput) -> @location(0) vec4<f32> {\n"
     "    let color = textureSample(screen_texture, texture_sampler, in.uv);\n"
     "    return vec4<f32>(@function(color.rgb@call), color.a);\n"
     "}\n",
     "override @name: f32 = @value; // @help\n"},
    {"godot",
     "@tool\n"
     "extends CompositorEffect\n"
     "# Tone mapping by Tonewright. Add this script to the Compositor of a WorldEnvironment or a "
     "camera.\n\n"
     "@arguments@[\n@]"
     "const CODE := \"\"\"#version 450\n\n"
     "layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;\n"
     "layout(rgba16f, set = 0, binding = 0) uniform image2D color_image;\n"
     "layout(push_constant, std430) uniform Parameters {\n"
     "    vec2 raster_size;\n"
     "    vec2 reserved;\n"
     "@declarations"
     "} parameters;\n\n",
     "\nvoid main() {\n"
     "    ivec2 place = ivec2(gl_GlobalInvocationID.xy);\n"
     "    if (any(greaterThanEqual(place, ivec2(parameters.raster_size)))) return;\n"
     "    vec4 color = imageLoad(color_image, place);\n"
     "    imageStore(color_image, place, vec4(@function(color.rgb@call), color.a));\n"
     "}\n"
     "\"\"\"\n\n"
     "@("
     "# Size and RGBA (base64): nodes of 3D LUTs in half floats; tables, of depth 1, in 32-bit "
     "floats.\n"
     "const TEXTURES := [\n@grids]\n\n"
     "@)"
     "var _device: RenderingDevice\n"
     "var _shader: RID\n"
     "var _pipeline: RID\n"
     "@(var _sampler: RID\n"
     "var _textures: Array[RID]\n@)"
     "\n\n"
     "func _init() -> void:\n"
     "\teffect_callback_type = EFFECT_CALLBACK_TYPE_POST_TRANSPARENT\n"
     "\tRenderingServer.call_on_render_thread(_make)\n\n\n"
     "func _notification(what: int) -> void:\n"
     "\tif what == NOTIFICATION_PREDELETE and _device:\n"
     "\t\tfor rid: RID in [_shader@(, _sampler@)]@( + _textures@):\n"
     "\t\t\tif rid.is_valid():\n"
     "\t\t\t\t_device.free_rid(rid)\n\n\n"
     "func _make() -> void:\n"
     "\t_device = RenderingServer.get_rendering_device()\n"
     "\tif not _device:\n"
     "\t\tpush_error(\"@function needs the renderer Forward+ or Mobile\")\n"
     "\t\treturn\n"
     "\tvar source := RDShaderSource.new()\n"
     "\tsource.source_compute = CODE\n"
     "\tvar spirv := _device.shader_compile_spirv_from_source(source)\n"
     "\tif spirv.compile_error_compute:\n"
     "\t\tpush_error(spirv.compile_error_compute)\n"
     "\t\treturn\n"
     "\t_shader = _device.shader_create_from_spirv(spirv)\n"
     "\t_pipeline = _device.compute_pipeline_create(_shader)\n"
     "@("
     "\t_sampler = _device.sampler_create(RDSamplerState.new())\n"
     "\tfor texture: Array in TEXTURES:\n"
     "\t\tvar format := RDTextureFormat.new()\n"
     "@g("
     "\t\tformat.texture_type = RenderingDevice.TEXTURE_TYPE_3D\n"
     "\t\tformat.format = RenderingDevice.DATA_FORMAT_R16G16B16A16_SFLOAT\n"
     "@g)"
     "@t("
     "\t\tif texture[2] == 1:\n"
     "\t\t\tformat.texture_type = RenderingDevice.TEXTURE_TYPE_2D\n"
     "\t\t\tformat.format = RenderingDevice.DATA_FORMAT_R32G32B32A32_SFLOAT\n"
     "@t)"
     "\t\tformat.width = texture[0]\n"
     "\t\tformat.height = texture[1]\n"
     "\t\tformat.depth = texture[2]\n"
     "\t\tformat.usage_bits = RenderingDevice.TEXTURE_USAGE_SAMPLING_BIT\n"
     "\t\t_textures.append(_device.texture_create(format, RDTextureView.new(), "
     "[Marshalls.base64_to_raw(texture[3])]))\n"
     "@)"
     "\n\n"
     "func _render_callback(_type: int, data: RenderData) -> void:\n"
     "\tvar buffers := data.get_render_scene_buffers() as RenderSceneBuffersRD\n"
     "\tif not buffers or not _pipeline.is_valid():\n"
     "\t\treturn\n"
     "\tvar size := buffers.get_internal_size()\n"
     "\tvar numbers := PackedFloat32Array([size.x, size.y, 0.0, 0.0@names])\n"
     "\tnumbers.resize((numbers.size() + 3) / 4 * 4)\n"
     "\tvar constants := numbers.to_byte_array()\n"
     "\tfor view in buffers.get_view_count():\n"
     "\t\tvar uniforms: Array[RDUniform] = []\n"
     "\t\tvar image := RDUniform.new()\n"
     "\t\timage.uniform_type = RenderingDevice.UNIFORM_TYPE_IMAGE\n"
     "\t\timage.add_id(buffers.get_color_layer(view))\n"
     "\t\tuniforms.append(image)\n"
     "@("
     "\t\tfor texture in _textures:\n"
     "\t\t\tvar nodes := RDUniform.new()\n"
     "\t\t\tnodes.uniform_type = RenderingDevice.UNIFORM_TYPE_SAMPLER_WITH_TEXTURE\n"
     "\t\t\tnodes.binding = uniforms.size()\n"
     "\t\t\tnodes.add_id(_sampler)\n"
     "\t\t\tnodes.add_id(texture)\n"
     "\t\t\tuniforms.append(nodes)\n"
     "@)"
     "\t\tvar list := _device.compute_list_begin()\n"
     "\t\t_device.compute_list_bind_compute_pipeline(list, _pipeline)\n"
     "\t\t_device.compute_list_bind_uniform_set(list, UniformSetCacheRD.get_cache(_shader, 0, "
     "uniforms), 0)\n"
     "\t\t_device.compute_list_set_push_constant(list, constants, constants.size())\n"
     "\t\t_device.compute_list_dispatch(list, (size.x + 7) / 8, (size.y + 7) / 8, 1)\n"
     "\t\t_device.compute_list_end()\n",
     "@export_range(@min, @max) var @name := @value # @help\n", "parameters.@name",
     "    float @name;\n"},
    {"unity",
     "Shader \"Tonewright/@function\" {\n"
     "Properties {\n"
     "@arguments@grids"
     "}\n"
     "SubShader {\n"
     "Tags { \"RenderType\" = \"Opaque\" \"RenderPipeline\" = \"UniversalPipeline\" }\n"
     "ZTest Always ZWrite Off Cull Off\n"
     "Pass {\n"
     "HLSLPROGRAM\n"
     "#pragma vertex Vert\n"
     "#pragma fragment Fragment\n"
     "#include "
     "\"Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl\"\n"
     "#include \"Packages/com.unity.render-pipelines.core/Runtime/Utilities/Blit.hlsl\"\n\n",
     "\n@declarations"
     "float4 Fragment(Varyings input) : SV_Target {\n"
     "    UNITY_SETUP_STEREO_EYE_INDEX_POST_VERTEX(input);\n"
     "    float4 color = SAMPLE_TEXTURE2D_X(_BlitTexture, sampler_LinearClamp, input.texcoord);\n"
     "    return float4(@function(color.rgb@call), color.a);\n"
     "}\n"
     "ENDHLSL\n"
     "}\n"
     "}\n"
     "}\n",
     "    _@name(\"@name\", Range(@min, @max)) = @value\n", "_@name", "float _@name;\n"},
    {"unreal", "#pragma once\n\n",
     "\n// A Custom node with the input color:\n"
     "//   Include File Paths: /Project/Tonewright/@function.ush\n"
     "//   Code: return @function(color.rgb@call);\n"
     "@arguments@grids",
     "// @name is another input of the node: @help, @value\n"},
    {"mpv",
     "@arguments@grids"
     "//!HOOK MAIN\n"
     "//!BIND HOOKED\n"
     "@bindings"
     "//!DESC Tonewright @function\n\n",
     "\nvec4 hook() {\n"
     "    vec4 color = HOOKED_texOff(0);\n"
     "    return vec4(@function(color.rgb@call), color.a);\n"
     "}\n",
     "//!PARAM @name\n"
     "//!DESC @help\n"
     "//!TYPE float\n"
     "//!MINIMUM @min\n"
     "//!MAXIMUM @max\n"
     "@value\n\n"},
    {"reshade",
     "#include \"ReShade.fxh\"\n\n"
     "@arguments\n",
     "\nfloat4 @function_pass(float4 position : SV_Position, float2 place : TEXCOORD) : "
     "SV_Target {\n"
     "    float4 color = tex2D(ReShade::BackBuffer, place);\n"
     "    return float4(@function(color.rgb@call), color.a);\n"
     "}\n\n"
     "technique @function_technique {\n"
     "    pass {\n"
     "        VertexShader = PostProcessVS;\n"
     "        PixelShader = @function_pass;\n"
     "    }\n"
     "}\n",
     "uniform float @name < ui_type = \"slider\"; ui_min = @min; ui_max = @max; ui_tooltip = "
     "\"@help\"; > = @value;\n"},
    {"resolve", "@arguments",
     "\n__DEVICE__ float3 transform(int p_Width, int p_Height, int p_X, int p_Y, float p_R, "
     "float p_G, float p_B) {\n"
     "    return @function(make_float3(p_R, p_G, p_B)@call);\n"
     "}\n",
     "DEFINE_UI_PARAMS(@name, @name, DCTLUI_SLIDER_FLOAT, @value, @min, @max, 0.01)\n"},
    {"nuke",
     "@header\n"
     "kernel @function_kernel : ImageComputationKernel<ePixelWise> {\n"
     "    Image<eRead, eAccessPoint, eEdgeClamped> src;\n"
     "    Image<eWrite> dst;\n"
     "@grids"
     "@[\n"
     "param:\n"
     "@declarations\n"
     "    void define() {\n"
     "@arguments"
     "    }\n@]",
     "\n    void process() {\n"
     "        float4 color = src();\n"
     "        float3 shown = @function(float3(color.x, color.y, color.z)@call);\n"
     "        dst() = float4(shown.x, shown.y, shown.z, color.w);\n"
     "    }\n"
     "};\n",
     "        defineParam(@name, \"@name\", @value);\n", "@name", "    float @name;  // @help\n",
     "    "},
    // Each takes the place of a tone mapper of its own, because only there light is not yet
    // clipped.
    {"babylon",
     "import { ShaderStore } from '@babylonjs/core/Engines/shaderStore.js';\n"
     "import { ImageProcessingConfiguration } from "
     "'@babylonjs/core/Materials/imageProcessingConfiguration.js';\n"
     "import '@babylonjs/core/Shaders/ShadersInclude/imageProcessingFunctions.js';\n"
     "@(import { Constants } from '@babylonjs/core/Engines/constants.js';\n"
     "import { RawTexture3D } from '@babylonjs/core/Materials/Textures/rawTexture3D.js';\n@)"
     "\n"
     "// Call it before materials are compiled. It takes the place of TONEMAPPING_ACES on the "
     "whole "
     "page.\n"
     "export function use_@function(scene) {\n"
     "    const store = ShaderStore.IncludesShadersStore;\n"
     "    store.imageProcessingFunctions = store.imageProcessingFunctions.replace(\n"
     "        /(vec3 ACESFitted|\\/\\/ Tonewright)[^]*?(?=\\n#endif)/, code);\n"
     "    const settings = scene.imageProcessingConfiguration;\n"
     "    settings.toneMappingType = ImageProcessingConfiguration.TONEMAPPING_ACES;\n"
     "    settings.toneMappingEnabled = true;\n"
     "@grids"
     "}\n\n"
     "const code = /* glsl */`// Tonewright\n",
     "@arguments\n"
     "vec3 ACESFitted(vec3 color) {\n"
     "    vec3 shown = @function(color@call);\n"
     "    return max(shown, vec3(0.0)); // Babylon.js encodes it with a power\n"
     "}\n"
     "`.trimEnd();\n@numbers",
     "const float @name_value = @value; // @help\n", "@name_value"},
    {"playcanvas",
     "import { SHADERLANGUAGE_GLSL, ShaderChunks@(, ADDRESS_CLAMP_TO_EDGE, FILTER_NEAREST@)@g(, "
     "PIXELFORMAT_RGBA16F@g)@t(, PIXELFORMAT_RGBA32F@t)@(, Texture@) } from 'playcanvas';\n\n"
     "// Call it before materials are compiled, then: camera.toneMapping = TONEMAP_ACES2.\n"
     "export function use_@function(device) {\n"
     "    ShaderChunks.get(device, SHADERLANGUAGE_GLSL).set('tonemappingAces2PS', code);\n"
     "@declarations"
     "@grids"
     "}\n\n"
     "const code = /* glsl */`\n",
     "@arguments\n"
     "vec3 toneMap(vec3 color) {\n"
     "    vec3 shown = @function(getExposure() * color@call);\n"
     "    return max(shown, vec3(0.0)); // PlayCanvas encodes it with a power\n"
     "}\n"
     "`;\n@numbers",
     "uniform float tw_@name; // @help\n", "tw_@name",
     "    device.scope.resolve('tw_@name').setValue(@value);\n"},
    {"cesium",
     "import { PostProcessStage, PostProcessStageLibrary, Tonemapper@(, PixelDatatype, "
     "Sampler@)@t(, Texture@t)@g(, Texture3D@g) } from '@cesium/engine';\n\n"
     "// It takes the place of Tonemapper.ACES in this scene, and works with "
     "scene.highDynamicRange = true.\n"
     "export function use_@function(scene) {\n"
     "    const uniforms = { exposure: 1 };\n"
     "@declarations"
     "@grids"
     "    const stage = new PostProcessStage({ name: 'czm_aces', fragmentShader: code, uniforms "
     "});\n"
     "    const own = PostProcessStageLibrary.createAcesTonemappingStage;\n"
     "    PostProcessStageLibrary.createAcesTonemappingStage = () => stage;\n"
     "    scene.postProcessStages.tonemapper = Tonemapper.REINHARD; // only a change asks for a "
     "stage\n"
     "    scene.postProcessStages.tonemapper = Tonemapper.ACES;\n"
     "    PostProcessStageLibrary.createAcesTonemappingStage = own;\n"
     "    return stage;\n"
     "}\n\n"
     "const code = /* glsl */`\n",
     "@arguments\n"
     "uniform highp sampler2D colorTexture;\n"
     "uniform float exposure;\n"
     "in vec2 v_textureCoordinates;\n\n"
     "void main() {\n"
     "    vec4 color = texture(colorTexture, v_textureCoordinates);\n"
     "    vec3 shown = @function(exposure * color.rgb@call);\n"
     "    out_FragColor = vec4(czm_inverseGamma(max(shown, vec3(0.0))), color.a);\n"
     "}\n"
     "`;\n@numbers",
     "uniform float tw_@name; // @help\n", "tw_@name", "    uniforms.tw_@name = @value;\n"},
    {"postprocessing",
     "import { Uniform@g(, Data3DTexture, HalfFloatType@g)@t(, DataTexture, FloatType@t) } from "
     "'three';\n"
     "import { BlendFunction, Effect } from 'postprocessing';\n\n"
     "// An effect after bloom; effects on the displayed picture, such as noise, go after it.\n"
     "export class @function_Effect extends Effect {\n"
     "    constructor() {\n"
     "        const uniforms = new Map();\n"
     "@declarations"
     "@grids"
     "        super('@function', code, { blendFunction: BlendFunction.SRC, uniforms });\n"
     "    }\n"
     "}\n\n"
     "const code = /* glsl */`\n",
     "@arguments\n"
     "uniform float toneMappingExposure; // three.js sets it\n\n"
     "void mainImage(const in vec4 color, const in vec2 uv, out vec4 result) {\n"
     "    vec3 shown = @function(toneMappingExposure * color.rgb@call);\n"
     "    result = vec4(max(shown, vec3(0.0)), color.a); // three.js encodes it with a power\n"
     "}\n"
     "`;\n@numbers",
     "uniform float @name; // @help\n", "@name",
     "        uniforms.set('@name', new Uniform(@value));\n"},
    {"filament", "#pragma once\n\n#include <filament/ToneMapper.h>\n#include <math/vec3.h>\n\n",
     "\n/// ColorGrading::Builder().toneMapper(&...), with luminanceScaling and gamutMapping off.\n"
     "struct @function_ToneMapper final : filament::ToneMapper {\n"
     "@arguments@[\n@]"
     "    filament::math::float3 operator()(filament::math::float3 color) const noexcept override "
     "{\n"
     "        const float scene[3] = {color.x, color.y, color.z};\n"
     "        float c[3];\n"
     "        @function(scene@call, c);\n"
     "        // Linear Rec.709 to linear Rec.2020.\n"
     "        return {0.6274039f * c[0] + 0.32928303f * c[1] + 0.043313067f * c[2],\n"
     "                0.06909729f * c[0] + 0.9195404f * c[1] + 0.011362316f * c[2],\n"
     "                0.016391438f * c[0] + 0.08801331f * c[1] + 0.89559525f * c[2]};\n"
     "    }\n"
     "};\n",
     "    float @name = @value;  // @help\n"},
    {"obs", "@arguments\n",
     "\n// OBS passes the picture as code values of sRGB, in 8 bits.\n"
     "float tw_light(float code) {\n"
     "    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);\n"
     "}\n\n"
     "float4 mainImage(VertData v_in) : TARGET\n"
     "{\n"
     "    float4 color = image.Sample(textureSampler, v_in.uv);\n"
     "    float3 light = float3(tw_light(color.r), tw_light(color.g), tw_light(color.b));\n"
     "    return float4(@function(light@call), color.a);\n"
     "}\n",
     "// @help\n"
     "uniform float @name<\n"
     "    string label = \"@name\";\n"
     "    string widget_type = \"slider\";\n"
     "    float minimum = @min;\n"
     "    float maximum = @max;\n"
     "    float step = 0.01;\n"
     "> = @value;\n"},
    {"shadertoy", "",
     "\nvoid mainImage(out vec4 result, in vec2 place) {\n"
     "@arguments"
     "    vec4 color = texture(iChannel0, place / iResolution.xy);\n"
     "    result = vec4(@function(color.rgb@call), 1.0);\n"
     "}\n",
     "    float @name = @value; // @help\n"},
    // GStreamer's vertex shader is GLSL ES 1.00, and both must have one version. Arrays of
    // constants need 3.00, and so another vertex shader.
    {"gstreamer with arrays",
     "#version 300 es\n"
     "precision highp float;\n"
     "precision highp int;\n"
     "in vec2 v_texcoord;\n"
     "uniform sampler2D tex;\n"
     "@arguments"
     "out vec4 result;\n\n",
     "\nvoid main() {\n"
     "    vec4 color = texture(tex, v_texcoord);\n"
     "    result = vec4(@function(color.rgb@call), color.a);\n"
     "}\n",
     "uniform float @name; // @help (@value)\n"},
    {"gstreamer",
     "#version 100\n"
     "#ifdef GL_ES\n"
     "precision highp float;\n"
     "precision highp int;\n"
     "#endif\n"
     "varying vec2 v_texcoord;\n"
     "uniform sampler2D tex;\n"
     "@arguments\n",
     "\nvoid main() {\n"
     "    vec4 color = texture2D(tex, v_texcoord);\n"
     "    gl_FragColor = vec4(@function(color.rgb@call), color.a);\n"
     "}\n",
     "uniform float @name; // @help (@value)\n"},
};

constexpr const char* kHalves =
    "\n// Nodes of 3D LUTs: RGBA in half floats (base64).\n"
    "const halves = (text) => new Uint16Array(Uint8Array.from(atob(text), (c) => "
    "c.charCodeAt(0)).buffer);\n";
constexpr const char* kFloats =
    "\n// Tables: RGBA in 32-bit floats (base64).\n"
    "const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => "
    "c.charCodeAt(0)).buffer);\n";

bool needs_vertex_shader(const ShaderApplication& application, const Shader& shader) {
    return application.id == "gstreamer" && shader.text.find(" = float[") != std::string::npos;
}
constexpr const char* kVertexShader =
    "#version 300 es\nin vec4 a_position;\nin vec2 a_texcoord;\nout vec2 v_texcoord;\n\n"
    "void main() {\n    gl_Position = a_position;\n    v_texcoord = a_texcoord;\n}\n";

const Wrapper& wrapper_of(const ShaderApplication& application, const Shader& shader) {
    const std::string id =
        application.id + (needs_vertex_shader(application, shader) ? " with arrays" : "");
    return *std::find_if(std::begin(kWrappers), std::end(kWrappers),
                         [&](const Wrapper& w) { return w.id == id; });
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    for (std::size_t at = text.find(what); at != std::string::npos;
         at = text.find(what, at + with.size()))
        text.replace(at, what.size(), with);
    return text;
}

/// Text for a string of the application's language: a template of JavaScript, or a string of
/// GDScript. Comments may hold any character.
std::string in_literal(const ShaderApplication& application, std::string text) {
    const std::string_view special = application.extension == ".js"   ? "\\`$"
                                     : application.extension == ".gd" ? "\\\""
                                                                      : "";
    if (application.extension == ".frag") std::replace(text.begin(), text.end(), '"', '\'');
    if (special.empty()) return text;
    std::string quoted;
    for (const char c : text) {
        if (special.find(c) != std::string_view::npos) quoted += '\\';
        quoted += c;
    }
    return quoted;
}

/// Removes the marks, and the text between them unless it is wanted.
std::string only_if(bool is_wanted, std::string text, std::string_view begin,
                    std::string_view end) {
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
        const std::size_t last = text.find(end, at);
        const std::string inner =
            is_wanted ? text.substr(at + begin.size(), last - at - begin.size()) : std::string();
        text.replace(at, last + end.size() - at, inner);
        at += inner.size();
    }
    return text;
}

std::string of_argument(const std::string& pattern, const ShaderArgument& argument,
                        const LanguageFacts& language) {
    std::string text = replaced(pattern, "@name", argument.name);
    text = replaced(text, "@help", argument.help);
    text = replaced(text, "@value", float_literal(argument.value, language));
    text = replaced(text, "@min", float_literal(argument.min, language));
    return replaced(text, "@max", float_literal(argument.max, language));
}

}  // namespace

const std::vector<ShaderApplication>& shader_applications() {
    static const std::vector<ShaderApplication> applications = {
        {"threejs", "three.js (WebGL)", ".js", ShaderLanguage::glsl_es, "linear",
         "Call use_...() before the first material is compiled, and set renderer.toneMapping to "
         "CustomToneMapping, instead of a tone mapping of three.js. renderer.toneMappingExposure "
         "is a factor before the curve.",
         true},
        {"threejs-tsl", "three.js (WebGPU)", ".js", ShaderLanguage::wgsl, "linear",
         "Call renderer.library.addToneMapping(..., CustomToneMapping), and set "
         "renderer.toneMapping to CustomToneMapping, instead of a tone mapping of three.js. "
         "renderer.toneMappingExposure is a factor before the curve.",
         true},
        {"postprocessing", "postprocessing (three.js)", ".js", ShaderLanguage::glsl_es, "linear",
         "Add new ..._Effect() to an EffectPass of a composer in half floats, instead of "
         "ToneMappingEffect, with renderer.toneMapping NoToneMapping. "
         "renderer.toneMappingExposure is a factor before the curve.",
         true},
        {"babylon", "Babylon.js", ".js", ShaderLanguage::glsl_es, "linear",
         "Call use_...(scene) before the first material is compiled; it takes the place of "
         "TONEMAPPING_ACES. The exposure of imageProcessingConfiguration is a factor before the "
         "curve. Babylon.js encodes by the power 1/2.2, as a display of gamma 2.2.",
         true},
        {"playcanvas", "PlayCanvas", ".js", ShaderLanguage::glsl_es, "linear",
         "Call use_...(device) before the first material is compiled, and set toneMapping to "
         "TONEMAP_ACES2, whose place it takes. app.scene.exposure is a factor before the curve. "
         "PlayCanvas encodes by the power 1/2.2, as a display of gamma 2.2.",
         true},
        {"cesium", "CesiumJS", ".js", ShaderLanguage::glsl_es, "linear",
         "Call use_...(scene) with scene.highDynamicRange on; it takes the place of "
         "Tonemapper.ACES. postProcessStages.exposure is a factor before the curve. CesiumJS "
         "encodes by the power 1/2.2, as a display of gamma 2.2.",
         true},
        {"filament", "Filament", ".h", ShaderLanguage::c, "linear",
         "Hand its class to ColorGrading::Builder::toneMapper(), instead of a tone mapper of "
         "Filament, with luminanceScaling and gamutMapping off. Exposure comes before it. "
         "Filament shows a 3D LUT of it, and encodes.",
         true, "lin_rec2020"},
        {"obs", "OBS (obs-shaderfilter)", ".shader", ShaderLanguage::hlsl, "srgb",
         "A filter User-defined shader. OBS passes pictures of 8 bits from 0 to 1, which are "
         "already tone mapped; exposure is an argument."},
        {"bevy", "Bevy", ".wgsl", ShaderLanguage::wgsl, "linear",
         "A full-screen material with Tonemapping::None on the camera. Exposure comes before it. "
         "Bevy encodes its picture.",
         true},
        {"godot", "Godot 4", ".gd", ShaderLanguage::glsl, "linear",
         "Add the script to the Compositor of a WorldEnvironment or a camera, and set the "
         "Environment's tone mapper to Linear, with exposure and white 1. Godot encodes its "
         "picture.",
         true},
        {"unity", "Unity (URP)", ".shader", ShaderLanguage::hlsl, "linear",
         "A Full Screen Pass Renderer Feature after post-processing, with Tonemapping None and "
         "HDR on. Exposure comes before it. URP encodes its picture.",
         true},
        {"unreal", "Unreal Engine", ".ush", ShaderLanguage::hlsl, "srgb",
         "A post-process material at `Replacing the Tonemapper` with a Custom node. Unreal's "
         "exposure comes before it; its result is not encoded again, and bloom and vignette are "
         "left out there."},
        {"mpv", "mpv", ".glsl", ShaderLanguage::glsl, "srgb",
         "mpv --vo=gpu --vf=format=gamma=srgb --glsl-shader=FILE on scene-linear pictures (EXR), "
         "which mpv does not tone map then; sliders need mpv 0.36."},
        {"reshade", "ReShade", ".fx", ShaderLanguage::hlsl, "linear",
         "For games that pass scRGB (scene-linear) to ReShade, with their own tone mapping off; "
         "in other games the picture is already tone mapped."},
        {"resolve", "DaVinci Resolve (DCTL)", ".dctl", ShaderLanguage::dctl, "rec1886",
         "Copy it into the LUT folder; a DCTL effect on a node whose input is scene-linear, "
         "without tone mapping before or after it."},
        {"nuke", "Nuke (BlinkScript)", ".rpp", ShaderLanguage::blink, "linear",
         "The Kernel File of a BlinkScript node on scene-linear RGBA; the Viewer and the Write "
         "node encode what it returns, with sRGB."},
        {"shadertoy", "Shadertoy", ".glsl", ShaderLanguage::glsl_es, "srgb",
         "Paste it into Image; iChannel0 holds the scene-linear picture."},
        {"gstreamer", "GStreamer glshader", ".frag", ShaderLanguage::glsl_es, "srgb",
         "glshader fragment=\"\\\"$(cat FILE)\\\"\" on scene-linear frames, and with a file "
         "tonewright.vert beside it also vertex=\"\\\"$(cat tonewright.vert)\\\"\"; uniforms by "
         "its property `uniforms`. Frames hold 0 to 1: write the file with an exposure that "
         "undoes the scale of brighter scenes."},
    };
    return applications;
}

const ShaderApplication& find_shader_application(std::string_view name) {
    std::vector<std::string> ids;
    for (const ShaderApplication& application : shader_applications())
        ids.push_back(application.id);
    return shader_applications()[find_choice("application", name, ids)];
}

std::optional<ShaderLanguage> second_language(const ShaderApplication& application) {
    if (application.id == "threejs-tsl") return ShaderLanguage::glsl_es;
    return std::nullopt;
}

Shader wrap(const ShaderApplication& application, Shader shader,
            const std::vector<ShaderArgument>& arguments, const std::string& other) {
    const Wrapper& wrapper = wrapper_of(application, shader);
    const LanguageFacts& language = facts_of(application.language);
    std::string lines;
    std::string declarations;
    std::string call;
    std::string names;
    for (const ShaderArgument& argument : arguments) {
        lines += of_argument(wrapper.argument, argument, language);
        declarations += of_argument(wrapper.declaration, argument, language);
        call += ", " + of_argument(wrapper.argument_in_call, argument, language);
        names += ", " + argument.name;
    }
    std::string grids;
    std::string bindings;
    const auto& textures = shader.textures;
    const bool has_tables = std::any_of(textures.begin(), textures.end(), holds_tables);
    const bool has_grids = !std::all_of(textures.begin(), textures.end(), holds_tables);
    const std::string numbers = std::string(has_grids ? kHalves : "") + (has_tables ? kFloats : "");
    for (const ShaderTexture& texture : textures) {
        const TextureForm& form = form_of(application, texture);
        const auto filled = [&](std::string text) {
            text = replaced(text, "@texture", texture.name);
            text = replaced(text, "@width", std::to_string(texture.size[0]));
            text = replaced(text, "@height", std::to_string(texture.size[1]));
            text = replaced(text, "@depth", std::to_string(texture.size[2]));
            return form.data ? replaced(text, "@data", form.data(texture)) : text;
        };
        grids += filled(form.lines);
        bindings += filled(form.bindings);
        if (*form.parameter) call += ", " + texture.name;
        if (form.contents)
            shader.files.push_back({texture.name + form.suffix, form.contents(texture)});
    }
    if (needs_vertex_shader(application, shader))
        shader.files.push_back({"tonewright.vert", kVertexShader});
    std::string functions = in_literal(application, std::move(shader.text));
    std::string header;
    if (std::string_view(wrapper.before).starts_with("@header")) {
        const std::size_t end = functions.find("\n\n") + 1;
        header = functions.substr(0, end);
        functions.erase(0, end);
    }
    const auto filled = [&](std::string text) {
        text = only_if(!arguments.empty(), text, "@[", "@]");
        text = only_if(has_grids || has_tables, text, "@(", "@)");
        text = only_if(has_grids, text, "@g(", "@g)");
        text = only_if(has_tables, text, "@t(", "@t)");
        text = replaced(text, "@header", header);
        text = replaced(text, "@function", shader.function);
        text = replaced(text, "@call", call);
        text = replaced(text, "@names", names);
        text = replaced(text, "@numbers", numbers + bindings);
        text = replaced(text, "@declarations", declarations);
        text = replaced(text, "@arguments", lines);
        text = replaced(text, "@bindings", bindings);
        text = replaced(text, "@other", in_literal(application, other));
        return replaced(text, "@grids", grids);
    };
    // Applications require certain first lines, so the header comes after them. Their shaders
    // already begin with the lines of the language.
    if (*language.prologue && application.id != "threejs" && application.id != "filament")
        functions = replaced(functions, std::string("\n") + language.prologue, "");
    if (*wrapper.indent) {
        functions = replaced(functions, "\n", std::string("\n") + wrapper.indent);
        functions = replaced(functions, std::string("\n") + wrapper.indent + "\n", "\n\n");
        functions.erase(functions.rfind('\n') + 1);
    }
    shader.text = filled(wrapper.before) + functions + filled(wrapper.after);
    shader.textures.clear();
    return shader;
}

TONEWRIGHT_NAMESPACE_END
