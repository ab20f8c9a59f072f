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
    /// True if it holds any 3D LUT, in a texture or an array. Otherwise the text computes the nodes
    /// of 3D LUTs that have a formula.
    bool holds_grids = false;
};
[[nodiscard]] TONEWRIGHT_API const std::vector<ShaderLanguageInfo>& shader_languages();
/// Ignores case; `-`, `_` and blanks are equal.
/// @throws Error  with the nearest id
[[nodiscard]] TONEWRIGHT_API const ShaderLanguageInfo& find_shader_language(std::string_view name);

/// An application that takes shader source as a whole file.
struct ShaderApplication {
    std::string id;     // threejs
    std::string title;  // "three.js (WebGL)"
    std::string extension;
    ShaderLanguage language;
    /// Output of the function for it: `linear`, or a display.
    std::string display;
    /// Instructions for the user: the application's own tone mapper, and the place of exposure.
    std::string steps;
    /// True if the application encodes what the function returns.
    bool encodes = false;
    /// Space of the color that the application passes.
    std::string input = "lin_rec709";
};
[[nodiscard]] TONEWRIGHT_API const std::vector<ShaderApplication>& shader_applications();
/// Ignores case; `-`, `_` and blanks are equal.
/// @throws Error  with the nearest id
[[nodiscard]] TONEWRIGHT_API const ShaderApplication& find_shader_application(
    std::string_view name);

/// Storage of tables and 3D LUTs.
enum class ShaderTables : unsigned char {
    /// Arrays, but textures for more numbers than a text should have. Where neither is possible, a
    /// user would have to connect a texture by hand, or its half floats would cost a code value of
    /// 10
    /// bits, the text computes nodes of 3D LUTs.
    by_size,
    texture,
    array,
    /// The text computes the nodes of 3D LUTs by their formula; 1D tables as by_size.
    formula,
};

/// Writing of curves of one number.
enum class ShaderCurves : unsigned char {
    formula,
    /// Piecewise polynomials, where these take fewer instructions.
    fitted,
};

/// Contents and format of a shader function.
struct ShaderRequest {
    /// Use the display `linear` for a renderer that encodes its pictures, a display for code
    /// values.
    View view;
    ShaderLanguage language = ShaderLanguage::glsl;
    /// Arguments after the color, in this order: kExposureUniform and live parameters of the
    /// operator. All other numbers are constants.
    std::vector<std::string> uniforms = {};
    /// Writes the inverse: code values of the view -> scene-linear.
    bool is_inverse = false;
    ShaderTables tables = ShaderTables::by_size;
    ShaderCurves curves = ShaderCurves::formula;
    /// Not null: writes the whole file for the application, in its language instead of `language`.
    /// Uniforms become the application's own sliders or inputs.
    const ShaderApplication* application = nullptr;
    /// Folder that keeps errors which write_shader() measures, at most 256 MiB; empty: nothing is
    /// stored.
    std::string cache_folder = {};
};

/// A table of a shader outside its text: a 3D texture of four 32-bit floats, x running fastest. For
/// a 3D LUT: RGB and 1. For a 1D table: a sample and its position, 256 to a row. The text fetches
/// texels and interpolates them, so the texture needs no filter.
struct ShaderTexture {
    std::string name;         // in the text
    std::array<int, 3> size;  // x, y, z
    std::vector<float> rgba;
    /// In JavaScript, for a 3D LUT with a formula: the function of the text that computes a node,
    /// in 64-bit float, from its coordinates z, y, x in [0, 1]. Otherwise empty.
    std::string formula = {};
};

/// Errors of the function, the same for all languages. In code values of the display, or of sRGB if
/// the output is `linear` or `native`; relative above 1.
struct ShaderErrors {
    /// Largest difference between the function in float, each operation rounded once, and the
    /// double reference, over a smaller standard sample set. For an inverse: the round-trip error
    /// of colors that the view can show.
    double in_float = 0;
    /// Bound of the difference from the text's formulas, on all platforms whose operations are as
    /// exact as the Vulkan and WGSL specifications require. It holds for every color with channels
    /// from 0 to 65504 and the view's values of uniforms. Matrices may be summed in any order.
    /// Infinite if there is no bound of at most 300 times `in_float`, for an inverse, and with
    /// fitted curves.
    double guaranteed = kInfinity;
    /// If `guaranteed` is infinite: the function of the text with the largest error.
    std::string arises_in;
    /// Estimate of the rounding error with the errors that the Vulkan specification allows each
    /// operation, to first order and over a sample set. It is no bound. Infinite if first order
    /// does not apply, and for an inverse.
    double vulkan_estimate = kInfinity;
};

/// A file beside the text, which the application reads.
struct ShaderFile {
    std::string name;
    std::string contents;
};

/// Source text: comments, helper functions, and last the function itself.
struct Shader {
    /// tw_<id>[_preset][_look], followed by _inverse or _encoded.
    std::string function;
    std::string text;
    ShaderErrors errors;
    /// For a language. A file for an application has them in its text, or in `files`.
    std::vector<ShaderTexture> textures = {};
    std::vector<ShaderFile> files = {};
};

/// @throws Error  as write_shader()
[[nodiscard]] TONEWRIGHT_API ShaderErrors measure_shader(const ShaderRequest& request);

/// Writes the text in ASCII, the same on every machine.
///
/// The function takes a color, scene-linear in the view's input primaries, 1.0 = diffuse white, and
/// returns the view's output, all in 32-bit float. Every finite color and both infinities give a
/// finite result. The result of NaN depends on the compiler.
///
/// @throws Error  a local operator; a uniform that the operator does not have, that is not live, or
///                that is named twice; an inverse with uniforms other than the exposure, or of an
///                operator without one; tables, or a 3D LUT without a formula, if the target has
///                neither textures nor arrays of that size
/// @param errors  the result of measure_shader() for the same request in any language; null:
///                measures. Texts that compute nodes, or have them in half floats, are measured
///                for themselves.
[[nodiscard]] TONEWRIGHT_API Shader write_shader(const ShaderRequest& request,
                                                 const ShaderErrors* errors = nullptr);

/// True if the view reads a 3D LUT.
[[nodiscard]] TONEWRIGHT_API bool reads_grid(const View& view);

/// The name of the function that write_shader() writes.
[[nodiscard]] TONEWRIGHT_API std::string shader_function_name(const ShaderRequest& request);

TONEWRIGHT_NAMESPACE_END
