// SPDX-License-Identifier: Apache-2.0
#include "shader/texture_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>

#include "base/base64.h"
#include "base/half_value.h"
#include "base/ktx2.h"
#include "base/little_endian.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void append(std::string& bytes, std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i)
        bytes += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
}
void append_half(std::string& bytes, float value) {
    append(bytes, half_bits(static_cast<double>(value)), 2);
}

/// Little-endian RGBA, x running fastest.
std::string halves(const ShaderTexture& texture) {
    std::string bytes;
    bytes.reserve(2 * texture.rgba.size());
    for (const float value : texture.rgba)
        append_half(bytes, value);
    return bytes;
}

std::string in_base64(const ShaderTexture& texture) { return base64(halves(texture)); }
std::string floats_in_base64(const ShaderTexture& texture) {
    return base64(little_endian_bytes(texture.rgba));
}

std::string in_hex(const ShaderTexture& texture) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const char c : little_endian_bytes(texture.rgba)) {
        const auto byte = static_cast<unsigned char>(c);
        text += kDigits[byte >> 4U];
        text += kDigits[byte & 15U];
    }
    return text;
}

/// Red is x, which runs fastest.
std::string cube_file(const ShaderTexture& texture) {
    std::string text = fmt::format("TITLE \"{}\"\nLUT_3D_SIZE {}\n", texture.name, texture.size[0]);
    for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
        fmt::format_to(std::back_inserter(text), "{:.9g} {:.9g} {:.9g}\n", texture.rgba[i],
                       texture.rgba[i + 1], texture.rgba[i + 2]);
    }
    return text;
}

std::string in_ktx2(const ShaderTexture& texture) {
    return ktx2_file(texture.rgba, texture.size,
                     holds_tables(texture) ? Ktx2Texel::single : Ktx2Texel::half, "");
}

/// OpenEXR, uncompressed: node x, y, z at column x and row y + height * z. Tables have 32-bit
/// floats, 3D LUTs half floats.
std::string exr_file(const ShaderTexture& texture) {
    const bool is_half = !holds_tables(texture);
    const auto append_number = [&](std::string& bytes, float value) {
        if (is_half) return append_half(bytes, value);
        append(bytes, std::bit_cast<std::uint32_t>(value), 4);
    };
    const auto width = static_cast<std::uint32_t>(texture.size[0]);
    const auto height = static_cast<std::uint32_t>(texture.size[1] * texture.size[2]);
    std::string file("\x76\x2f\x31\x01\x02\0\0\0", 8);
    const auto attribute = [&](std::string_view name, std::string_view type,
                               const std::string& value) {
        file.append(name).append(1, '\0').append(type).append(1, '\0');
        append(file, value.size(), 4);
        file += value;
    };
    std::string channels;
    for (const char channel : {'A', 'B', 'G', 'R'}) {
        channels += channel;
        channels += '\0';
        append(channels, is_half ? 1 : 2, 4);
        append(channels, 0, 4);
        append(channels, 1, 4);
        append(channels, 1, 4);
    }
    channels += '\0';
    std::string window;
    for (const std::uint32_t number : {0U, 0U, width - 1, height - 1})
        append(window, number, 4);
    std::string one;
    append(one, 0x3F800000, 4);
    attribute("channels", "chlist", channels);
    attribute("compression", "compression", std::string(1, '\0'));
    attribute("dataWindow", "box2i", window);
    attribute("displayWindow", "box2i", window);
    attribute("lineOrder", "lineOrder", std::string(1, '\0'));
    attribute("pixelAspectRatio", "float", one);
    attribute("screenWindowCenter", "v2f", std::string(8, '\0'));
    attribute("screenWindowWidth", "float", one);
    file += '\0';
    const std::uint64_t row = 8 + (is_half ? 8 : 16) * std::uint64_t{width};
    const std::uint64_t begin = file.size() + 8 * std::uint64_t{height};
    for (std::uint64_t y = 0; y < height; ++y)
        append(file, begin + y * row, 8);
    for (std::uint32_t y = 0; y < height; ++y) {
        append(file, y, 4);
        append(file, row - 8, 4);
        for (const std::size_t channel : {3U, 2U, 1U, 0U}) {
            for (std::size_t x = 0; x < width; ++x)
                append_number(file, texture.rgba[4 * (std::size_t{y} * width + x) + channel]);
        }
    }
    return file;
}

/// An Editor script, because Unity imports no volume of half floats and no 32-bit floats by itself.
std::string unity_script(const ShaderTexture& texture) {
    return fmt::format(
        R"(// Put this file into a folder `Editor`. The menu Tonewright > {0} makes Assets/{0}.asset.
using UnityEditor;
using UnityEngine;

static class {0} {{
    [MenuItem("Tonewright/{0}")]
    static void Make() {{
        var texture = new {1}, false) {{
            filterMode = FilterMode.Point, wrapMode = TextureWrapMode.Clamp
        }};
        texture.SetPixelData(System.Convert.FromBase64String(Data), 0);
        texture.Apply(false);
        AssetDatabase.CreateAsset(texture, "Assets/{0}.asset");
    }}

    const string Data = "{2}";
}}
)",
        texture.name,
        holds_tables(texture)
            ? fmt::format("Texture2D({}, {}, TextureFormat.RGBAFloat, false", texture.size[0],
                          texture.size[1])
            : fmt::format("Texture3D({0}, {0}, {0}, TextureFormat.RGBAHalf", texture.size[0]),
        holds_tables(texture) ? floats_in_base64(texture) : in_base64(texture));
}

constexpr const char* kSampler = "uniform highp sampler3D {name};\n";
constexpr const char* kTexelFetch = "texelFetch({name}, ivec3({x}, {y}, {z}), 0)";
/// A constant of a module of JavaScript.
constexpr const char* kData = "const @texture_data = '@data';\n";

constexpr TextureForm kGrids[] = {
    // A strip, because OutputPass compiles GLSL ES 1.00, which has no 3D textures.
    {.application = "threejs",
     .is_default = true,
     .holds_halves = true,
     .declaration = "uniform sampler2D {name}; // node x, y, z in column x, row y + {edge} * z\n",
     .fetch = "texture2D({name}, (vec2({x}, {y} + {edge} * ({z})) + 0.5) / vec2({edge}, {edge} * "
              "{edge}))",
     .color_of_fetch = ".rgb",
     .lines = "    @texture: [@width, @height * @depth, HalfFloatType, Uint16Array, '@data'],\n",
     .data = in_base64},
    {.application = "threejs-tsl",
     .is_default = true,
     .holds_halves = true,
     .declaration = "",
     .fetch = "textureLoad({name}, vec3<i32>({x}, {y}, {z}), 0)",
     .color_of_fetch = ".rgb",
     .lines = "    @texture: [gridOf, [@width, @height, @depth], '@data'],\n",
     .data = in_base64},
    // Image processing has one 3D texture, that of color grading.
    {.application = "babylon",
     .is_default = true,
     .holds_halves = true,
     .declaration = "",
     .fetch = "texelFetch(txColorTransform, ivec3({x}, {y}, {z}), 0)",
     .color_of_fetch = ".rgb",
     .is_only_one = true,
     .lines = "    // The 3D LUT has the place of the color grading texture, at the weight 0.\n"
              "    const grid = new RawTexture3D(halves(@texture_data), @width, @width, @width,\n"
              "        Constants.TEXTUREFORMAT_RGBA, scene, false, false, "
              "Constants.TEXTURE_NEAREST_SAMPLINGMODE,\n"
              "        Constants.TEXTURETYPE_HALF_FLOAT);\n"
              "    grid.level = 0;\n"
              "    settings.colorGradingTexture = grid;\n"
              "    settings.colorGradingEnabled = true;\n",
     .bindings = kData,
     .data = in_base64},
    {.application = "playcanvas",
     .is_default = true,
     .holds_halves = true,
     .declaration = kSampler,
     .fetch = kTexelFetch,
     .color_of_fetch = ".rgb",
     .lines =
         "    device.scope.resolve('@texture').setValue(new Texture(device, {\n"
         "        name: '@texture', width: @width, height: @width, depth: @width, volume: true, "
         "mipmaps: false,\n"
         "        format: PIXELFORMAT_RGBA16F, levels: [halves(@texture_data)],\n"
         "        minFilter: FILTER_NEAREST, magFilter: FILTER_NEAREST, addressU: "
         "ADDRESS_CLAMP_TO_EDGE,\n"
         "        addressV: ADDRESS_CLAMP_TO_EDGE, addressW: ADDRESS_CLAMP_TO_EDGE,\n"
         "    }));\n",
     .bindings = kData,
     .data = in_base64},
    {.application = "cesium",
     .is_default = true,
     .holds_halves = true,
     .declaration = kSampler,
     .fetch = kTexelFetch,
     .color_of_fetch = ".rgb",
     .lines = "    const @texture = new Texture3D({\n"
              "        context: scene.context, pixelDatatype: PixelDatatype.HALF_FLOAT, sampler: "
              "Sampler.NEAREST, flipY: false,\n"
              "        source: { width: @width, height: @width, depth: @width, arrayBufferView: "
              "halves(@texture_data) },\n"
              "    });\n"
              "    uniforms.@texture = () => @texture;\n",
     .bindings = kData,
     .data = in_base64},
    {.application = "postprocessing",
     .is_default = true,
     .holds_halves = true,
     .declaration = kSampler,
     .fetch = kTexelFetch,
     .color_of_fetch = ".rgb",
     .lines = "        const @texture = new Data3DTexture(halves(@texture_data), @width, @width, "
              "@width);\n"
              "        @texture.type = HalfFloatType;\n"
              "        @texture.needsUpdate = true;\n"
              "        uniforms.set('@texture', new Uniform(@texture));\n",
     .bindings = kData,
     .data = in_base64},
    {.application = "bevy",
     .is_default = false,
     .holds_halves = true,
     .declaration = "@group(0) @binding({binding}) var {name}: texture_3d<f32>;\n",
     .fetch = "textureLoad({name}, vec3<i32>({x}, {y}, {z}), 0)",
     .color_of_fetch = ".rgb",
     .first_binding = 2,
     .note = "// Its file is {name}.ktx2: Handle<Image> with #[texture({binding}, dimension = "
             "\"3d\", filterable = false)].\n",
     .suffix = ".ktx2",
     .contents = in_ktx2},
    {.application = "godot",
     .is_default = true,
     .holds_halves = true,
     .declaration = "layout(set = 0, binding = {binding}) uniform sampler3D {name};\n",
     .fetch = "texelFetch({name}, ivec3({x}, {y}, {z}), 0)",
     .color_of_fetch = ".rgb",
     .first_binding = 1,
     .lines = "    [@width, @height, @depth, \"@data\"],\n",
     .data = in_base64},
    {.application = "unity",
     .is_default = false,
     .holds_halves = true,
     .declaration = "Texture3D<float4> {name};\n",
     .fetch = "{name}.Load(int4({x}, {y}, {z}, 0))",
     .color_of_fetch = ".rgb",
     .note = "// {name}.cs makes the asset of it: give it to the material.\n",
     .lines = "    @texture(\"@texture.asset\", 3D) = \"\" {}\n",
     .suffix = ".cs",
     .contents = unity_script},
    {.application = "unreal",
     .is_default = false,
     .holds_halves = true,
     .declaration = "",
     .fetch = "{name}.Load(int4({x}, {y}, {z}, 0))",
     .color_of_fetch = ".rgb",
     .parameter = "Texture3D {name}",
     .note =
         "// Its file is {name}.exr, a strip: make a Volume Texture of it, with tiles of {edge} "
         "x {edge}\n// and the compression HDR.\n",
     .lines = "// @texture is another input of the node: a Texture Object of the Volume Texture\n",
     .suffix = ".exr",
     .contents = exr_file},
    // mpv's own renderer has no name for half floats in its data.
    {.application = "mpv",
     .is_default = true,
     .holds_halves = false,
     .declaration = "",
     .fetch = "texelFetch({name}, ivec3({x}, {y}, {z}), 0)",
     .color_of_fetch = ".rgb",
     .lines = "//!TEXTURE @texture\n//!SIZE @width @width @width\n//!FORMAT rgba32f\n"
              "//!FILTER NEAREST\n//!BORDER CLAMP\n@data\n\n",
     .bindings = "//!BIND @texture\n",
     .data = in_hex},
    {.application = "reshade",
     .is_default = true,
     .holds_halves = true,
     .declaration = "texture3D {name}_texture < source = \"{name}.cube\"; > {{\n"
                    "    Width = {edge};\n    Height = {edge};\n    Depth = {edge};\n"
                    "    Format = RGBA16F;\n}};\n"
                    "sampler3D {name} {{\n    Texture = {name}_texture;\n    MinFilter = POINT;\n"
                    "    MagFilter = POINT;\n    MipFilter = POINT;\n}};\n",
     .fetch = "tex3Dfetch({name}, int3({x}, {y}, {z}))",
     .color_of_fetch = ".rgb",
     .note = "// Its file is {name}.cube, for the folder reshade-shaders/Textures; ReShade 6.0 and "
             "later read it.\n",
     .suffix = ".cube",
     .contents = cube_file},
    {.application = "resolve",
     .is_default = true,
     .holds_halves = true,
     .declaration = "DEFINE_LUT({name}, {name}.cube)\n",
     .fetch = "APPLY_LUT(({x}) / {last}.0f, ({y}) / {last}.0f, ({z}) / {last}.0f, {name})",
     .color_of_fetch = "",
     .note =
         "// Its file is {name}.cube, for the same folder. Only nodes are read, so the project's "
         "interpolation\n// of 3D LUTs does not matter.\n",
     .suffix = ".cube",
     .contents = cube_file},
    {.application = "nuke",
     .is_default = false,
     .holds_halves = true,
     .declaration = "float3 {name}_at(int x, int y, int z) {{\n"
                    "    float4 node = {name}(x, {edge} * {edge} - 1 - (y + {edge} * z));\n"
                    "    return float3(node.x, node.y, node.z);\n}}\n",
     .fetch = "{name}_at({x}, {y}, {z})",
     .color_of_fetch = "",
     .note = "// It is the second input: a Read node of {name}.exr, raw data.\n",
     .lines = "    Image<eRead, eAccessRandom, eEdgeClamped> @texture;\n",
     .suffix = ".exr",
     .contents = exr_file},
};

constexpr const char* kFlatSampler = "uniform highp sampler2D {name};\n";
constexpr const char* kFlatFetch = "texelFetch({name}, ivec2({x}, {y}), 0)";

constexpr TextureForm kTables[] = {
    // GLSL ES 1.00 of OutputPass has no texelFetch.
    {.application = "threejs",
     .is_default = false,
     .holds_halves = false,
     .declaration = kFlatSampler,
     .fetch = "texture2D({name}, (vec2({x}, {y}) + 0.5) / vec2({width}, {height}))",
     .color_of_fetch = "",
     .lines = "    @texture: [@width, @height, FloatType, Float32Array, '@data'],\n",
     .data = floats_in_base64},
    {.application = "threejs-tsl",
     .is_default = false,
     .holds_halves = false,
     .declaration = "",
     .fetch = "textureLoad({name}, vec2<i32>({x}, {y}), 0)",
     .color_of_fetch = "",
     .lines = "    @texture: [tablesOf, [@width, @height], '@data'],\n",
     .data = floats_in_base64},
    // In the place of the 3D LUT, as a volume with a depth of 1. Every WebGL 2 has volumes of 256
    // texels a side.
    {.application = "babylon",
     .is_default = false,
     .holds_halves = false,
     .declaration = "",
     .fetch = "texelFetch(txColorTransform, ivec3({x}, {y}, 0), 0)",
     .color_of_fetch = "",
     .is_only_one = true,
     .lines = "    // The tables have the place of the color grading texture, at the weight 0.\n"
              "    const tables = new RawTexture3D(floats(@texture_data), @width, @height, 1,\n"
              "        Constants.TEXTUREFORMAT_RGBA, scene, false, false, "
              "Constants.TEXTURE_NEAREST_SAMPLINGMODE,\n"
              "        Constants.TEXTURETYPE_FLOAT);\n"
              "    tables.level = 0;\n"
              "    settings.colorGradingTexture = tables;\n"
              "    settings.colorGradingEnabled = true;\n",
     .bindings = kData,
     .data = floats_in_base64,
     .largest_width = 256},
    {.application = "playcanvas",
     .is_default = false,
     .holds_halves = false,
     .declaration = kFlatSampler,
     .fetch = kFlatFetch,
     .color_of_fetch = "",
     .lines = "    device.scope.resolve('@texture').setValue(new Texture(device, {\n"
              "        name: '@texture', width: @width, height: @height, mipmaps: false,\n"
              "        format: PIXELFORMAT_RGBA32F, levels: [floats(@texture_data)],\n"
              "        minFilter: FILTER_NEAREST, magFilter: FILTER_NEAREST, addressU: "
              "ADDRESS_CLAMP_TO_EDGE,\n"
              "        addressV: ADDRESS_CLAMP_TO_EDGE,\n"
              "    }));\n",
     .bindings = kData,
     .data = floats_in_base64},
    {.application = "cesium",
     .is_default = false,
     .holds_halves = false,
     .declaration = kFlatSampler,
     .fetch = kFlatFetch,
     .color_of_fetch = "",
     .lines = "    const @texture = new Texture({\n"
              "        context: scene.context, pixelDatatype: PixelDatatype.FLOAT, sampler: "
              "Sampler.NEAREST, flipY: false,\n"
              "        source: { width: @width, height: @height, arrayBufferView: "
              "floats(@texture_data) },\n"
              "    });\n"
              "    uniforms.@texture = () => @texture;\n",
     .bindings = kData,
     .data = floats_in_base64},
    {.application = "postprocessing",
     .is_default = false,
     .holds_halves = false,
     .declaration = kFlatSampler,
     .fetch = kFlatFetch,
     .color_of_fetch = "",
     .lines = "        const @texture = new DataTexture(floats(@texture_data), @width, @height);\n"
              "        @texture.type = FloatType;\n"
              "        @texture.needsUpdate = true;\n"
              "        uniforms.set('@texture', new Uniform(@texture));\n",
     .bindings = kData,
     .data = floats_in_base64},
    {.application = "bevy",
     .is_default = false,
     .holds_halves = false,
     .declaration = "@group(0) @binding({binding}) var {name}: texture_2d<f32>;\n",
     .fetch = "textureLoad({name}, vec2<i32>({x}, {y}), 0)",
     .color_of_fetch = "",
     .note = "// Its file is {name}.ktx2: Handle<Image> with #[texture({binding}, filterable = "
             "false)].\n",
     .suffix = ".ktx2",
     .contents = in_ktx2},
    {.application = "godot",
     .is_default = false,
     .holds_halves = false,
     .declaration = "layout(set = 0, binding = {binding}) uniform sampler2D {name};\n",
     .fetch = kFlatFetch,
     .color_of_fetch = "",
     .lines = "    [@width, @height, @depth, \"@data\"],\n",
     .data = floats_in_base64},
    {.application = "unity",
     .is_default = false,
     .holds_halves = false,
     .declaration = "Texture2D<float4> {name};\n",
     .fetch = "{name}.Load(int3({x}, {y}, 0))",
     .color_of_fetch = "",
     .note = "// {name}.cs makes the asset of it: give it to the material.\n",
     .lines = "    @texture(\"@texture.asset\", 2D) = \"\" {}\n",
     .suffix = ".cs",
     .contents = unity_script},
    {.application = "unreal",
     .is_default = false,
     .holds_halves = false,
     .declaration = "",
     .fetch = "{name}.Load(int3({x}, {y}, 0))",
     .color_of_fetch = "",
     .parameter = "Texture2D {name}",
     .note = "// Its file is {name}.exr: import it without sRGB and mipmaps,\n// with the "
             "compression HDR High Precision (RGBA32F).\n",
     .lines = "// @texture is another input of the node: a Texture Object of its file\n",
     .suffix = ".exr",
     .contents = exr_file},
    {.application = "mpv",
     .is_default = false,
     .holds_halves = false,
     .declaration = "",
     .fetch = kFlatFetch,
     .color_of_fetch = "",
     .lines = "//!TEXTURE @texture\n//!SIZE @width @height\n//!FORMAT rgba32f\n"
              "//!FILTER NEAREST\n//!BORDER CLAMP\n@data\n\n",
     .bindings = "//!BIND @texture\n",
     .data = in_hex},
};

/// The functions of both backends of three.js read one node.
constexpr TextureForm kTableOfSecondLanguage = {.application = "threejs-tsl",
                                                .is_default = false,
                                                .holds_halves = false,
                                                .declaration = "",
                                                .fetch = kFlatFetch,
                                                .color_of_fetch = ""};

const TextureForm* found_in(std::span<const TextureForm> forms,
                            const ShaderApplication& application) {
    const auto found = std::find_if(forms.begin(), forms.end(), [&](const TextureForm& form) {
        return form.application == application.id;
    });
    return found == forms.end() ? nullptr : &*found;
}

}  // namespace

bool holds_tables(const ShaderTexture& texture) { return texture.size[2] == 1; }

const TextureForm* grid_form(const ShaderApplication& application) {
    return found_in(kGrids, application);
}

const TextureForm* table_form(const ShaderApplication& application) {
    return found_in(kTables, application);
}

const TextureForm& form_of(const ShaderApplication& application, const ShaderTexture& texture) {
    return *(holds_tables(texture) ? table_form(application) : grid_form(application));
}

LanguageFacts language_for(const ShaderApplication& application) {
    LanguageFacts language = facts_of(application.language);
    const TextureForm* const form = grid_form(application);
    language.has_textures = form != nullptr;
    language.prefers_formula = !form || !form->is_default;
    if (!form) return language;
    if (form->holds_halves) language.texel = "half floats";
    language.texture = form->declaration;
    language.texture_parameter = form->parameter;
    language.first_binding = form->first_binding;
    language.fetch = form->fetch;
    language.color_of_fetch = form->color_of_fetch;
    language.loader = form->note;
    language.is_for_grids = true;
    language.holds_halves = form->holds_halves;
    language.has_one_texture = form->is_only_one;
    language.tables = table_form(application);
    return language;
}

LanguageFacts second_language_for(ShaderLanguage language) {
    LanguageFacts facts = facts_of(language);
    facts.texture = "";
    facts.loader = "";
    facts.prologue = "";
    facts.is_for_grids = true;
    facts.tables = &kTableOfSecondLanguage;
    return facts;
}

TONEWRIGHT_NAMESPACE_END
