// SPDX-License-Identifier: Apache-2.0
#include "shader/language.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr LanguageFacts kGlsl = {
    .language = ShaderLanguage::glsl,
    .number = "float",
    .color = "vec3",
    .boolean = "bool",
    .integer = "int",
    .suffix = "",
    .is_double = false,
    .make_color = "vec3",
    .channel = {".r", ".g", ".b"},
    .before_function = "",
    .function = "{result} {name}({parameters})",
    .parameter = "{type} {name}",
    .let = "{type} {name} = {value};",
    .variable = "{type} {name} = {value};",
    .loop = "for (int i = 0; i < {count}; i++)",
    .choose = "{condition} ? {yes} : {no}",
    .to_integer = "int({value})",
    .to_number = "float({value})",
    .half = "({value}) / 2",
    .array = "const float {name}[{count}] = float[{count}](\n{values});",
    .has_textures = true,
    .prefers_formula = false,
    .is_for_grids = false,
    .has_one_texture = false,
    .tables = nullptr,
    .holds_halves = false,
    .texel = "32-bit float",
    .texture = "uniform highp sampler3D {name};\n",
    .texture_parameter = "",
    .first_binding = 0,
    .fetch = "texelFetch({name}, ivec3({x}, {y}, {z}), 0)",
    .color_of_fetch = ".rgb",
    .loader =
        "// To load its file:\n"
        "// glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA32F, {width}, {height}, {depth}, 0, GL_RGBA, "
        "GL_FLOAT, data);\n"
        "// GL_TEXTURE_MIN_FILTER and GL_TEXTURE_MAG_FILTER are GL_NEAREST.\n",
    .largest_array = 4096,
    .has_local_arrays = false,
    .has_color_math = true,
    .splat = "vec3({value})",
    .product = "dot({a}, {b})",
    .minimum = "min",
    .maximum = "max",
    .absolute = "abs",
    .square_root = "sqrt",
    .exp2 = "exp2",
    .log2 = "log2",
    .power = "pow",
    .sine = "sin",
    .cosine = "cos",
    .atan2 = "atan",
    .floor = "floor",
    .prologue = "",
    .entry = LanguageFacts::Entry::function,
};

constexpr LanguageFacts glsl_es() {
    LanguageFacts f = kGlsl;
    f.language = ShaderLanguage::glsl_es;
    f.loader =
        "// To load its file:\n"
        "// const data = new Float32Array(await (await fetch('{name}.rgba32f')).arrayBuffer());\n"
        "// gl.bindTexture(gl.TEXTURE_3D, gl.createTexture());\n"
        "// gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);\n"
        "// gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);\n"
        "// gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA32F, {width}, {height}, {depth}, 0, gl.RGBA, "
        "gl.FLOAT, data);\n";
    f.prologue = "precision highp float;\nprecision highp int;\n";
    return f;
}

constexpr LanguageFacts hlsl() {
    LanguageFacts f = kGlsl;
    f.language = ShaderLanguage::hlsl;
    f.color = "float3";
    f.make_color = "float3";
    f.to_integer = "(int)({value})";
    f.to_number = "(float)({value})";
    f.array = "static const float {name}[{count}] = {{\n{values}}};";
    f.texture = "Texture3D<float4> {name};\n";
    f.fetch = "{name}.Load(int4({x}, {y}, {z}, 0))";
    f.loader =
        "// To load its file:\n"
        "// Direct3D: DXGI_FORMAT_R32G32B32A32_FLOAT, {pitch} bytes a row.\n"
        "// Unity: var t = new Texture3D({width}, {height}, {depth}, TextureFormat.RGBAFloat, "
        "false);\n"
        "//        t.SetPixelData(File.ReadAllBytes(\"{name}.rgba32f\"), 0); t.Apply(false);\n";
    f.splat = "float3({value}, {value}, {value})";
    f.atan2 = "atan2";
    return f;
}

constexpr LanguageFacts wgsl() {
    LanguageFacts f = kGlsl;
    f.language = ShaderLanguage::wgsl;
    f.number = "f32";
    f.color = "vec3<f32>";
    f.integer = "i32";
    f.make_color = "vec3<f32>";
    f.function = "fn {name}({parameters}) -> {result}";
    f.parameter = "{name}: {type}";
    f.let = "let {name} = {value};";
    f.variable = "var {name}: {type} = {value};";
    f.loop = "for (var i: i32 = 0; i < {count}; i++)";
    f.choose = "select({no}, {yes}, {condition})";
    f.to_integer = "i32({value})";
    f.to_number = "f32({value})";
    // Not `const`, because older compilers refuse a variable index into a constant array.
    f.array = "var<private> {name}: array<f32, {count}> = array<f32, {count}>(\n{values});";
    f.texture = "@group(0) @binding({binding}) var {name}: texture_3d<f32>;\n";
    f.fetch = "textureLoad({name}, vec3<i32>({x}, {y}, {z}), 0)";
    f.loader =
        "// To load its file:\n"
        "// const data = new Float32Array(await (await fetch('{name}.rgba32f')).arrayBuffer());\n"
        "// const size = [{width}, {height}, {depth}];\n"
        "// const texture = device.createTexture({{ size, dimension: '3d', format: 'rgba32float',\n"
        "//     usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST }});\n"
        "// device.queue.writeTexture({{ texture }}, data, {{ bytesPerRow: {pitch}, rowsPerImage: "
        "{height} }}, size);\n";
    f.splat = "vec3<f32>({value})";
    f.atan2 = "atan2";
    return f;
}

constexpr LanguageFacts msl() {
    LanguageFacts f = hlsl();
    f.language = ShaderLanguage::msl;
    f.suffix = "f";
    f.before_function = "inline ";
    f.to_integer = "int({value})";
    f.to_number = "float({value})";
    f.has_textures = false;
    f.array = "constant float {name}[{count}] = {{\n{values}}};";
    f.splat = "float3({value})";
    f.prologue = "#include <metal_stdlib>\nusing namespace metal;\n";
    return f;
}

/// C, and languages with its functions under other names.
constexpr LanguageFacts c() {
    LanguageFacts f = kGlsl;
    f.language = ShaderLanguage::c;
    f.color = "tw_rgb";
    f.boolean = "int";
    f.suffix = "f";
    f.make_color = "tw_make_rgb";
    f.before_function = "static inline ";
    f.to_integer = "(int)({value})";
    f.to_number = "(float)({value})";
    f.array = "static const float {name}[{count}] = {{\n{values}}};";
    f.has_textures = false;
    f.largest_array = std::numeric_limits<std::size_t>::max();
    f.has_color_math = false;
    f.product = "";
    f.minimum = "fminf";
    f.maximum = "fmaxf";
    f.absolute = "fabsf";
    f.square_root = "sqrtf";
    f.exp2 = "exp2f";
    f.log2 = "log2f";
    f.power = "powf";
    f.sine = "sinf";
    f.cosine = "cosf";
    f.atan2 = "atan2f";
    f.floor = "floorf";
    f.prologue =
        "#include <math.h>\n"
        "\n"
        "#ifndef TONEWRIGHT_RGB\n"
        "#define TONEWRIGHT_RGB\n"
        "typedef struct { float r, g, b; } tw_rgb;\n"
        "static inline tw_rgb tw_make_rgb(float r, float g, float b) {\n"
        "    tw_rgb c;\n"
        "    c.r = r;\n"
        "    c.g = g;\n"
        "    c.b = b;\n"
        "    return c;\n"
        "}\n"
        "#endif\n";
    f.entry = LanguageFacts::Entry::pointers;
    return f;
}

constexpr LanguageFacts dctl() {
    LanguageFacts f = c();
    f.language = ShaderLanguage::dctl;
    f.color = "float3";
    f.boolean = "bool";
    f.make_color = "make_float3";
    f.channel = {".x", ".y", ".z"};
    f.before_function = "__DEVICE__ ";
    f.largest_array = 4096;
    f.array = "__CONSTANT__ float {name}[{count}] = {{\n{values}}};";
    f.minimum = "_fminf";
    f.maximum = "_fmaxf";
    f.absolute = "_fabs";
    f.square_root = "_sqrtf";
    f.exp2 = "_exp2f";
    f.log2 = "_log2f";
    f.power = "_powf";
    f.sine = "_sinf";
    f.cosine = "_cosf";
    f.atan2 = "_atan2f";
    f.floor = "_floor";
    f.prologue = "";
    f.entry = LanguageFacts::Entry::function;
    return f;
}

/// Members of a kernel.
constexpr LanguageFacts blink() {
    LanguageFacts f = dctl();
    f.language = ShaderLanguage::blink;
    f.make_color = "float3";
    f.before_function = "";
    f.array = "float {name}[{count}] = {{\n{values}}};";
    f.has_local_arrays = true;
    f.minimum = "min";
    f.maximum = "max";
    f.absolute = "fabs";
    f.square_root = "sqrt";
    f.exp2 = "";
    f.log2 = "log2";
    f.power = "pow";
    f.sine = "sin";
    f.cosine = "cos";
    f.atan2 = "atan2";
    f.floor = "floor";
    return f;
}

constexpr LanguageFacts osl() {
    LanguageFacts f = kGlsl;
    f.language = ShaderLanguage::osl;
    f.color = "color";
    f.boolean = "int";
    f.make_color = "color";
    f.channel = {"[0]", "[1]", "[2]"};
    f.array = "float {name}[{count}] = {{\n{values}}};";
    f.to_integer = "(int)({value})";
    f.to_number = "(float)({value})";
    f.has_textures = false;
    f.has_local_arrays = true;
    f.splat = "color({value})";
    f.product = "";  // of vectors alone
    f.atan2 = "atan2";
    f.entry = LanguageFacts::Entry::shader;
    return f;
}

/// The double reference for web pages, with 64-bit numbers. A color is an array.
constexpr LanguageFacts javascript() {
    LanguageFacts f = kGlsl;
    f.language = ShaderLanguage::javascript;
    f.is_double = true;
    f.make_color = "tw_rgb";
    f.channel = {"[0]", "[1]", "[2]"};
    f.function = "function {name}({parameters})";
    f.parameter = "{name}";
    f.let = "const {name} = {value};";
    f.variable = "let {name} = {value};";
    f.loop = "for (let i = 0; i < {count}; i++)";
    f.to_integer = "Math.trunc({value})";
    f.to_number = "{value}";
    f.half = "({value}) >> 1";
    f.array = "const {name} = [\n{values}];";
    f.texture =
        "// Before the first call, make {name} a function of x, y, z that returns [r, g, b].\n";
    f.fetch = "{name}({x}, {y}, {z})";
    f.color_of_fetch = "";
    f.loader =
        "// To load its file:\n"
        "// const data = new Float32Array(await (await fetch('{name}.rgba32f')).arrayBuffer());\n"
        "// const {name} = (x, y, z) => {{\n"
        "//     const i = 4 * (x + {width} * (y + {height} * z));\n"
        "//     return [data[i], data[i + 1], data[i + 2]];\n"
        "// }};\n";
    f.largest_array = 65536;
    f.has_color_math = false;
    f.product = "";
    f.minimum = "Math.min";
    f.maximum = "Math.max";
    f.absolute = "Math.abs";
    f.square_root = "Math.sqrt";
    f.exp2 = "";
    f.log2 = "Math.log2";
    f.power = "Math.pow";
    f.sine = "Math.sin";
    f.cosine = "Math.cos";
    f.atan2 = "Math.atan2";
    f.floor = "Math.floor";
    f.prologue = "const tw_rgb = (r, g, b) => [r, g, b];\n";
    return f;
}

constexpr std::array kFacts = {kGlsl,  glsl_es(), hlsl(), wgsl(), msl(),
                               dctl(), blink(),   c(),    osl(),  javascript()};

}  // namespace

const std::vector<ShaderLanguageInfo>& shader_languages() {
    static const std::vector<ShaderLanguageInfo> languages = {
        {ShaderLanguage::glsl, "glsl", "GLSL 3.30 and later", ".glsl", true},
        {ShaderLanguage::glsl_es, "glsl-es", "GLSL ES 3.00 (WebGL 2)", ".glsl", true},
        {ShaderLanguage::hlsl, "hlsl", "HLSL", ".hlsl", true},
        {ShaderLanguage::wgsl, "wgsl", "WGSL (WebGPU)", ".wgsl", true},
        {ShaderLanguage::msl, "msl", "Metal Shading Language", ".metal"},
        {ShaderLanguage::dctl, "dctl", "DCTL (DaVinci Resolve)", ".h"},
        {ShaderLanguage::blink, "blinkscript", "BlinkScript (Nuke), members of a kernel", ".h"},
        {ShaderLanguage::c, "c", "C99 and C++", ".h", true},
        {ShaderLanguage::osl, "osl", "Open Shading Language", ".osl"},
        {ShaderLanguage::javascript, "js", "JavaScript, in 64-bit float", ".js", true},
    };
    return languages;
}

const ShaderLanguageInfo& find_shader_language(std::string_view name) {
    std::vector<std::string> ids;
    for (const ShaderLanguageInfo& info : shader_languages())
        ids.push_back(info.id);
    return shader_languages()[find_choice("language", name, ids)];
}

const LanguageFacts& facts_of(ShaderLanguage language) {
    return *std::find_if(kFacts.begin(), kFacts.end(),
                         [&](const LanguageFacts& f) { return f.language == language; });
}

std::string float_literal(double value, const LanguageFacts& language) {
    // Not the largest float, because its shortest digits lie above it, and WGSL refuses such a
    // literal.
    constexpr double kMost = 3e38;
    value = std::clamp(value, -kMost, kMost);
    const auto digits_of = [](auto number) {
        if (std::fpclassify(number) == FP_SUBNORMAL) number = 0;
        std::array<char, 32> buffer{};
        return std::string(buffer.data(),
                           std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr);
    };
    const std::string text =
        language.is_double ? digits_of(value) : digits_of(static_cast<float>(value));
    const std::size_t exponent = text.find('e');
    std::string digits = text.substr(0, exponent);
    if (digits.find('.') == std::string::npos) digits += ".0";
    return digits + (exponent == std::string::npos ? "" : text.substr(exponent)) + language.suffix;
}

TONEWRIGHT_NAMESPACE_END
