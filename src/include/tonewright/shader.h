// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

enum class ShaderLanguage : unsigned char {
    glsl,
    glsl_es,
    hlsl,
    wgsl,
    msl,
    dctl,
    blink,
    c,
    osl,
    javascript,  // in 64-bit float: the reference for pages
};

struct ShaderLanguageInfo {
    ShaderLanguage language;
    std::string id;         // glsl-es
    std::string title;      // "GLSL ES 3.00 (WebGL 2)"
    std::string extension;  // of a file
    /// A view that reads a lattice can be written.
    bool holds_lattices = false;
};
[[nodiscard]] TONEWRIGHT_API const std::vector<ShaderLanguageInfo>& shader_languages();
/// In any case, with `-`, `_` and blanks alike.
/// @throws Error  with the nearest id.
[[nodiscard]] TONEWRIGHT_API const ShaderLanguageInfo& find_shader_language(std::string_view name);

/// A program that takes shader source, and what it takes: a whole file.
struct ShaderApplication {
    std::string id;     // threejs
    std::string title;  // "three.js (WebGL)"
    std::string extension;
    ShaderLanguage language;
    /// What the function should return there: `linear`, or a display.
    std::string display;
    /// What the user has to do there; one sentence or two.
    std::string steps;
};
[[nodiscard]] TONEWRIGHT_API const std::vector<ShaderApplication>& shader_applications();
/// In any case, with `-`, `_` and blanks alike.
/// @throws Error  with the nearest id.
[[nodiscard]] TONEWRIGHT_API const ShaderApplication& find_shader_application(
    std::string_view name);

/// Where numbers of tables and lattices stand.
enum class ShaderTables : unsigned char {
    by_size,  // in arrays, and in textures where a text should not hold that many
    texture,
    array,
};

/// How curves of one number are written.
enum class ShaderCurves : unsigned char {
    formula,
    /// As polynomials of segments, where they take fewer instructions.
    fitted,
};

/// What a shader function computes, and how it is written.
struct ShaderRequest {
    /// Display `linear` for a renderer that encodes its picture itself, a display for finished
    /// pixels.
    View view;
    ShaderLanguage language = ShaderLanguage::glsl;
    /// Arguments behind the color, in this order: kExposureUniform and live parameters of the
    /// operator. All other numbers are constants of the text.
    std::vector<std::string> uniforms = {};
    /// What the view shows -> scene-linear.
    bool is_inverse = false;
    ShaderTables tables = ShaderTables::by_size;
    ShaderCurves curves = ShaderCurves::formula;
    /// Not null: the whole file that it takes, in its language, whatever `language` says. Uniforms
    /// become its own sliders or inputs.
    const ShaderApplication* application = nullptr;
};

/// What a shader reads and its text does not hold: a 3D texture of four 32-bit floats, x running
/// fastest. Of a lattice, RGB and 1; of a table, a sample and its position, 256 to a row. The text
/// fetches texels and interpolates itself: the texture needs no filter.
struct ShaderTexture {
    std::string name;         // in the text
    std::array<int, 3> size;  // x, y, z
    std::vector<float> rgba;
    /// In JavaScript, of a lattice that has a formula: the function of the text that computes a
    /// node, in 64-bit float, from its coordinates z, y, x in [0, 1]. Else empty.
    std::string formula = {};
};

/// How exact the function is: the same in all languages. Code values of the display, or of sRGB
/// where the output is `linear` or `native`; what is above 1 counts relatively.
struct ShaderErrors {
    /// Largest difference between the function in float, each operation rounded once, and the
    /// double reference, over the standard sample set with fewer colors. Of an inverse: what the
    /// view shows of its result, against what it was made of, where the view can show that.
    double in_float = 0;
    /// No result differs by more from what the text's formulas say, on whatever computes each
    /// operation as exactly as the Vulkan and WGSL specifications demand, for every color whose
    /// channels lie from 0 to 65504, with the uniforms' values of the view. Sums of matrices may be
    /// taken in any order. Infinite where no bound was found that is at most 300 times `in_float`,
    /// of an inverse and with fitted curves.
    double guaranteed = kInfinity;
    /// Where `guaranteed` is infinite: the function of the text in which most of the error may
    /// arise.
    std::string arises_in;
    /// What roundings may add up to with the errors that the Vulkan specification allows each
    /// operation. To first order and over probe colors: an estimate, no bound. Infinite where
    /// first order says nothing, and of an inverse.
    double vulkan_estimate = kInfinity;
};

/// Source text: comments that say what it is, functions that its last one calls, and that one.
struct Shader {
    /// tw_<id>[_preset][_look], with _inverse or _encoded behind it.
    std::string function;
    std::string text;
    ShaderErrors errors;
    std::vector<ShaderTexture> textures = {};
};

/// @throws Error  as write_shader()
[[nodiscard]] TONEWRIGHT_API ShaderErrors measure_shader(const ShaderRequest& request);

/// Text in ASCII, the same on every machine.
///
/// The function takes a color, scene-linear in the view's input primaries, 1.0 = diffuse white, and
/// returns what the view shows; all in 32-bit float. Every finite color and both infinities give a
/// finite result; what NaN gives depends on the compiler.
///
/// @throws Error  a local operator; a uniform that the operator does not have, that is not live, or
///                that is named twice; an inverse with uniforms other than the exposure, or of an
///                operator that has none; tables or a lattice where the language has no texture, or
///                no array that is large enough.
/// @param errors  what measure_shader() gave for the same request in whatever language; null: it is
///                called
[[nodiscard]] TONEWRIGHT_API Shader write_shader(const ShaderRequest& request,
                                                 const ShaderErrors* errors = nullptr);

/// True when the view reads a lattice: colors on a grid, more than a text should hold.
[[nodiscard]] TONEWRIGHT_API bool reads_lattice(const View& view);

/// The name of the function that write_shader() writes.
[[nodiscard]] TONEWRIGHT_API std::string shader_function_name(const ShaderRequest& request);

TONEWRIGHT_NAMESPACE_END
