// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A scene-linear space of input pictures.
struct InputSpace {
    std::string id;     // lin_rec709
    std::string title;  // its name in the OCIO config: "Linear Rec.709"
    std::vector<std::string> aliases;
    Primaries primaries;
    /// True for spaces of cameras and editors, for LUTs of their logs. The config has these logs
    /// instead.
    bool is_camera = false;
};

/// A display: its primaries and its encoding. Display-linear 1.0 is the peak of an SDR display, and
/// 100 cd/m2 on an HDR display, as in OpenColorIO.
struct Display {
    std::string id;     // srgb
    std::string title;  // its name in the OCIO config: "sRGB"
    std::vector<std::string> aliases;
    Primaries primaries;
    /// Display-linear -> code values.
    Pipeline encode;
    /// Its inverse.
    Pipeline decode;
    std::string source;  // the standard
    bool is_hdr = false;
    /// Peak for operators with an HDR version, cd/m2.
    double peak = 100;
    /// Display-linear value of the largest code value.
    double largest_light = 1;
};

[[nodiscard]] TONEWRIGHT_API const std::vector<InputSpace>& all_input_spaces();
[[nodiscard]] TONEWRIGHT_API const std::vector<Display>& all_displays();
/// By id, title or alias. Ignores case; `-`, `_` and blanks are equal.
/// @throws Error  with the nearest name
[[nodiscard]] TONEWRIGHT_API const InputSpace& find_input_space(std::string_view name);
[[nodiscard]] TONEWRIGHT_API const Display& find_display(std::string_view name);
/// @param others  further names that the caller accepts, for the message
[[nodiscard]] TONEWRIGHT_API const Display& find_display(std::string_view name,
                                                         const std::vector<std::string>& others);

/// Color of a source picture: light in some primaries, linear or encoded.
struct SourceColor {
    std::string name;  // an input space's id, "sRGB", ...; unique
    Primaries primaries;
    /// Stored numbers -> scene-linear. Empty: the numbers are linear.
    Pipeline decode = {};
    /// True for absolute luminance (PQ, HLG, cd/m2): decoded 1.0 is kUnitLuminance cd/m2.
    bool is_absolute = false;
    /// Factor on the decoded numbers, > 0. It is applied with the exposure, before values are
    /// limited to +-kHalfMax.
    double scale = 1;
    /// Runs before `decode`, for encodings that no Pipeline can hold, such as the LUTs of an ICC
    /// profile: stored numbers -> numbers that `decode` takes. Interleaved RGB; in and out may be
    /// the same; safe to use from several threads at once. Empty: none.
    std::function<void(const float* in, float* out, std::size_t count)> convert = {};
};
/// Finds the color of a picture by a name of all_source_color_names() (source_color.h). The first
/// match counts:
/// * an input space by id, title or alias; a display, for its code values
/// * `Rec709` (the camera curve of ITU-R BT.709), `GammaX.Y`
/// * an id of the Color Interop Forum, or another curve and other primaries in the pattern of its
///   ids (`g22_rec2020_scene`). `unknown` is linear Rec.709.
/// * another space of the config by title, alias or interop id: logs of cameras, film, textures.
///   The numbers of data (`Raw`) are taken as linear Rec.709.
/// * an encoding that parse_input_encoding() takes, with its default input space
/// * `cicp:P/T`: code points of ITU-T H.273
///
/// Ignores case; `-`, `_` and blanks are equal. A namespace before an id (`ocio:`) is dropped.
/// @throws Error  with the nearest name
[[nodiscard]] TONEWRIGHT_API SourceColor find_source_color(std::string_view name);

/// Luminance of linear 1.0 on OpenColorIO's HDR displays, and the default of `reference_white`,
/// cd/m2. It is not the reference white of Report ITU-R BT.2408, which is 203 cd/m2.
inline constexpr double kUnitLuminance = 100;

/// Units of a picture's linear numbers.
enum class InputUnits : unsigned char {
    relative,   // 1.0 is diffuse white
    luminance,  // cd/m2, as in photometric renders: the reference white becomes 1.0
};
/// `relative` or `cd/m2`.
/// @throws Error  for any other text, with the nearest name
[[nodiscard]] TONEWRIGHT_API InputUnits parse_input_units(std::string_view text);
/// The color of a source whose decoded numbers have these units. Absolute sources stay as they are.
[[nodiscard]] TONEWRIGHT_API SourceColor in_units(SourceColor source, InputUnits units);
/// Factor from the source's decoded numbers to scene-linear: of an absolute source, the reference
/// white becomes 1.0.
/// @param reference_white  cd/m2
[[nodiscard]] TONEWRIGHT_API double scene_scale(const SourceColor& source, double reference_white);

/// The two outputs that are not displays: `linear` is display-linear Rec.709, unclamped; `native`
/// is the operator's own output.
inline constexpr std::string_view kLinearOutput = "linear";
inline constexpr std::string_view kNativeOutput = "native";

/// Input space -> exposure -> operator -> display-linear -> display primaries -> encoding.
struct View {
    ResolvedOperator op;
    /// Id of an input space, or another name of a source's color.
    std::string input = "lin_rec709";
    double exposure_stops = 0;
    /// Id of a display, or `linear`, or `native`.
    std::string display = "srgb";
    /// Luminance of scene-linear 1.0 in absolute sources and on an HDR display, cd/m2.
    double reference_white = kUnitLuminance;
    Primaries input_primaries = kRec709;
    /// Stored numbers of the source -> light in those primaries. Empty for input spaces.
    Pipeline input_decode = {};
    /// Factor from that light to scene-linear. @see scene_scale()
    double input_scale = 1;
};

/// @throws Error  the exposure is out of range
TONEWRIGHT_API void check_exposure(double stops);

/// @param op        the result of resolve_operator(). This function sets the parameters that the
///                  display decides.
/// @param exposure  stops, finite, within [-64, 64]
/// @param reference_white  luminance of scene-linear 1.0 in absolute sources and on an HDR display,
///                  cd/m2, within [50, 1000] (Report ITU-R BT.2408: 203). If the source is relative
///                  and the display is SDR, `linear` or `native`, only the default is accepted.
/// @throws Error    unknown input space or display; exposure or reference white out of range
[[nodiscard]] TONEWRIGHT_API View make_view(ResolvedOperator op, std::string_view input,
                                            double exposure_stops, std::string_view display,
                                            double reference_white = kUnitLuminance);
/// The same for a source picture.
[[nodiscard]] TONEWRIGHT_API View make_view(ResolvedOperator op, SourceColor input,
                                            double exposure_stops, std::string_view display,
                                            double reference_white = kUnitLuminance);

/// True if the display can show all colors of the gamut, without negative channels.
[[nodiscard]] TONEWRIGHT_API bool is_inside(const Primaries& gamut, const Primaries& display);

/// Limits of displayed colors: a gamut, and the largest value.
struct DisplayLimit {
    Primaries primaries;
    double peak = 1;
};
/// The operator's own gamut if the display can show all of it, so that all such displays show the
/// same colors; otherwise the display's gamut. The peak is white, or more if both operator and
/// display exceed white.
[[nodiscard]] TONEWRIGHT_API DisplayLimit display_limit(const ResolvedOperator& op,
                                                        const Display& display);

/// Operator output -> display-linear in the limit's primaries, limited to [0, peak]. Code values
/// are decoded with the operator's own power, so that nothing is encoded twice.
[[nodiscard]] TONEWRIGHT_API Pipeline display_light_stages(const ResolvedOperator& op,
                                                           const DisplayLimit& limit);

/// The whole view as stages: decoding, exposure, the limit +-kHalfMax, the operator, the display.
/// Its input is scene-linear in the view's input space, or the stored numbers that the view
/// decodes, where NaN is 0. Engines limit stored numbers to +-kHalfMax. Without decoding and
/// exposure, they also are the limit, and the stages have none. @see limits_input()
[[nodiscard]] TONEWRIGHT_API Pipeline build_view(const View& view);

/// The name of the exposure, in stops, as a uniform.
inline constexpr std::string_view kExposureUniform = "exposure";

/// The same with uniforms instead of some numbers.
/// @param uniforms  live parameters of the operator, and kExposureUniform, which replaces the
///                  view's own exposure
/// @throws Error    as build_live() does
[[nodiscard]] TONEWRIGHT_API Pipeline build_live_view(const View& view,
                                                      const std::vector<std::string>& uniforms);

/// The inverse: output of the view -> scene-linear in the view's input primaries. Clipped values
/// stay clipped.
/// @throws Error  the operator has no inverse
[[nodiscard]] TONEWRIGHT_API Pipeline build_inverse_view(const View& view);

/// True if the view keeps gray neutral: R = G = B stays so within half a 10-bit code value, over
/// -16..+16 stops.
[[nodiscard]] TONEWRIGHT_API bool keeps_grays(const Pipeline& view);

TONEWRIGHT_NAMESPACE_END
