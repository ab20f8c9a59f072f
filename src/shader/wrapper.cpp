// SPDX-License-Identifier: Apache-2.0
#include "shader/wrapper.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/strings.h"
#include "shader/print.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Text around the functions. In the patterns `@function` is the last function, `@call` are the
/// arguments after its color, each with a comma before it, `@arguments` the lines of `argument` and
/// `@declarations` those of `declaration`. Text between `@[` and `@]` is left out if there are no
/// arguments. `@header` is replaced by the comments of the text.
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
     "import { ShaderChunk } from 'three';\n\n"
     "// Call it before materials are compiled, then: renderer.toneMapping = "
     "CustomToneMapping.\n"
     "export function use_@function() {\n"
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
     "`;\n",
     "const float @name_value = @value; // @help"
     "\n",
     "@name_value"},
    {"threejs-tsl",
     "import { wgsl, wgslFn } from 'three/tsl';\n\n"
     "const functions = wgsl(`\n",
     "`);\n\n"
     "// renderer.library.addToneMapping(@function, CustomToneMapping);\n"
     "export const @function = wgslFn(`\n"
     "fn @function_exposed(color: vec3<f32>, exposure: f32) -> vec3<f32> {\n"
     "@arguments"
     "    let shown = @function(color * exposure@call);\n"
     "    return max(shown, vec3<f32>(0.0)); // three.js encodes it with a power\n"
     "}\n"
     "`, [functions]);\n",
     "    let @name_value = @value; // @help\n", "@name_value"},
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
     "#[compute]\n"
     "#version 450\n\n"
     "layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;\n"
     "layout(rgba16f, set = 0, binding = 0) uniform image2D color_image;\n"
     "layout(push_constant, std430) uniform Parameters {\n"
     "    vec2 raster_size;\n"
     "    vec2 reserved;\n"
     "@arguments"
     "} parameters;\n\n",
     "\nvoid main() {\n"
     "    ivec2 place = ivec2(gl_GlobalInvocationID.xy);\n"
     "    if (any(greaterThanEqual(place, ivec2(parameters.raster_size)))) return;\n"
     "    vec4 color = imageLoad(color_image, place);\n"
     "    imageStore(color_image, place, vec4(@function(color.rgb@call), color.a));\n"
     "}\n",
     "    float @name; // @help (@value)\n", "parameters.@name"},
    {"unity",
     "Shader \"Tonewright/@function\" {\n"
     "Properties {\n"
     "@arguments"
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
     "@arguments",
     "// @name is another input of the node: @help, @value\n"},
    {"mpv",
     "@arguments"
     "//!HOOK MAIN\n"
     "//!BIND HOOKED\n"
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
    {"shadertoy", "",
     "\nvoid mainImage(out vec4 result, in vec2 place) {\n"
     "@arguments"
     "    vec4 color = texture(iChannel0, place / iResolution.xy);\n"
     "    result = vec4(@function(color.rgb@call), 1.0);\n"
     "}\n",
     "    float @name = @value; // @help\n"},
    {"gstreamer",
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
};

const Wrapper& wrapper_of(const ShaderApplication& application) {
    return *std::find_if(std::begin(kWrappers), std::end(kWrappers),
                         [&](const Wrapper& w) { return w.id == application.id; });
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    for (std::size_t at = text.find(what); at != std::string::npos;
         at = text.find(what, at + with.size()))
        text.replace(at, what.size(), with);
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
         "Call use_...() and set renderer.toneMapping to CustomToneMapping; toneMappingExposure is "
         "a factor."},
        {"threejs-tsl", "three.js (WebGPU)", ".js", ShaderLanguage::wgsl, "linear",
         "renderer.library.addToneMapping(..., CustomToneMapping), then set renderer.toneMapping."},
        {"bevy", "Bevy", ".wgsl", ShaderLanguage::wgsl, "linear",
         "A full-screen material with Tonemapping::None on the camera; Bevy encodes its picture."},
        {"godot", "Godot 4", ".glsl", ShaderLanguage::glsl, "linear",
         "A CompositorEffect, after the opaque and transparent passes, with the tone mapper Linear "
         "and exposure and white 1."},
        {"unity", "Unity (URP)", ".shader", ShaderLanguage::hlsl, "linear",
         "A Full Screen Pass Renderer Feature after post-processing, with Tonemapping None and HDR "
         "on."},
        {"unreal", "Unreal Engine", ".ush", ShaderLanguage::hlsl, "srgb",
         "A post-process material at `Replacing the Tonemapper` with a Custom node; its result is "
         "not encoded again, and bloom and vignette are left out there."},
        {"mpv", "mpv", ".glsl", ShaderLanguage::glsl, "srgb",
         "mpv --vo=gpu --vf=format=gamma=srgb --glsl-shader=FILE on scene-linear pictures (EXR); "
         "sliders need mpv 0.36."},
        {"reshade", "ReShade", ".fx", ShaderLanguage::hlsl, "linear",
         "For games that pass scRGB (scene-linear) to ReShade; in other games the picture is "
         "already tone mapped."},
        {"resolve", "DaVinci Resolve (DCTL)", ".dctl", ShaderLanguage::dctl, "rec1886",
         "Copy it into the LUT folder; a DCTL effect on a node whose input is scene-linear."},
        {"nuke", "Nuke (BlinkScript)", ".rpp", ShaderLanguage::blink, "linear",
         "The Kernel File of a BlinkScript node on scene-linear RGBA; the Viewer and the Write "
         "node "
         "encode what it returns, with sRGB."},
        {"shadertoy", "Shadertoy", ".glsl", ShaderLanguage::glsl_es, "srgb",
         "Paste it into Image; iChannel0 holds the scene-linear picture."},
        {"gstreamer", "GStreamer glshader", ".frag", ShaderLanguage::glsl_es, "srgb",
         "glshader fragment=\"$(cat FILE)\" on scene-linear frames; uniforms by its property "
         "`uniforms`."},
    };
    return applications;
}

const ShaderApplication& find_shader_application(std::string_view name) {
    std::vector<std::string> ids;
    for (const ShaderApplication& application : shader_applications())
        ids.push_back(application.id);
    return shader_applications()[find_choice("application", name, ids)];
}

std::string wrap(const ShaderApplication& application, const Shader& shader,
                 const std::vector<ShaderArgument>& arguments) {
    const Wrapper& wrapper = wrapper_of(application);
    const LanguageFacts& language = facts_of(application.language);
    std::string lines;
    std::string declarations;
    std::string call;
    for (const ShaderArgument& argument : arguments) {
        lines += of_argument(wrapper.argument, argument, language);
        declarations += of_argument(wrapper.declaration, argument, language);
        call += ", " + of_argument(wrapper.argument_in_call, argument, language);
    }
    std::string functions = shader.text;
    std::string header;
    if (std::string_view(wrapper.before).starts_with("@header")) {
        const std::size_t end = functions.find("\n\n") + 1;
        header = functions.substr(0, end);
        functions.erase(0, end);
    }
    const auto filled = [&](std::string text) {
        const std::size_t begin = text.find("@[");
        if (begin != std::string::npos && arguments.empty())
            text.erase(begin, text.find("@]") - begin);
        text = replaced(replaced(text, "@[", ""), "@]", "");
        text = replaced(text, "@header", header);
        text = replaced(text, "@function", shader.function);
        text = replaced(text, "@call", call);
        text = replaced(text, "@declarations", declarations);
        return replaced(text, "@arguments", lines);
    };
    // Applications require certain first lines, so the header comes after them. Their shaders
    // already begin with the lines of the language.
    if (*language.prologue && application.id != "threejs")
        functions = replaced(functions, std::string("\n") + language.prologue, "");
    if (*wrapper.indent) {
        functions = replaced(functions, "\n", std::string("\n") + wrapper.indent);
        functions = replaced(functions, std::string("\n") + wrapper.indent + "\n", "\n\n");
        functions.erase(functions.rfind('\n') + 1);
    }
    return filled(wrapper.before) + functions + filled(wrapper.after);
}

TONEWRIGHT_NAMESPACE_END
