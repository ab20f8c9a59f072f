// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A scene-linear space that pictures come in.
struct InputSpace {
    std::string id;     // lin_rec709
    std::string title;  // as the OCIO config names it: "Linear Rec.709"
    std::vector<std::string> aliases;
    Primaries primaries;
    /// A camera's or an editor's, for LUTs of its log. The config has the logs of cameras instead.
    bool is_camera = false;
};

/// A display: its primaries and how light becomes code values. Light 1 is the peak of an SDR
/// display and 100 cd/m2 of an HDR one, as in OpenColorIO's displays.
struct Display {
    std::string id;     // srgb
    std::string title;  // as the OCIO config names it: "sRGB"
    std::vector<std::string> aliases;
    Primaries primaries;
    /// Display-linear -> code values.
    Pipeline encode;
    /// Its inverse.
    Pipeline decode;
    std::string source;  // the standard
    bool is_hdr = false;
    /// cd/m2: what operators that can make pictures for HDR displays aim at.
    double peak = 100;
    /// Light of the largest code value.
    double largest_light = 1;
};

[[nodiscard]] TONEWRIGHT_API const std::vector<InputSpace>& all_input_spaces();
[[nodiscard]] TONEWRIGHT_API const std::vector<Display>& all_displays();
/// By id, title or alias, in any case, with `-`, `_` and blanks alike.
/// @param others  what else the caller takes for a display: the message lists it
/// @throws Error  with the nearest name.
[[nodiscard]] TONEWRIGHT_API const InputSpace& find_input_space(std::string_view name);
[[nodiscard]] TONEWRIGHT_API const Display& find_display(
    std::string_view name, const std::vector<std::string>& others = {});

/// What the numbers of a picture mean: light of some primaries, as it is or through a curve.
struct SourceColor {
    std::string name;  // an input space's id, "sRGB", ...; no two have the same
    Primaries primaries;
    /// Numbers -> scene-linear. Empty: they are linear.
    Pipeline decode = {};
};
/// An input space by id, title or alias; or what pictures are encoded in: a display (its code
/// values), `Rec709` (the camera curve of ITU-R BT.709), `GammaX.Y`, or a curve of an input space's
/// primaries by the Color Interop Forum's pattern (`srgb_ap1_scene`, `g22_rec709_scene`).
/// In any case, with `-`, `_` and blanks alike.
/// @throws Error  with the nearest name.
[[nodiscard]] TONEWRIGHT_API SourceColor find_source_color(std::string_view name);

/// What OpenColorIO's HDR displays show light 1 at, cd/m2.
inline constexpr double kReferenceWhite = 100;

/// The two outputs that are no display: `linear` = display-linear Rec.709, unclamped;
/// `native` = the operator's own output, untouched.
inline constexpr std::string_view kLinearOutput = "linear";
inline constexpr std::string_view kNativeOutput = "native";

/// What one picture is shown with: input space -> exposure -> operator -> display-linear ->
/// display primaries -> encoding.
struct View {
    ResolvedOperator op;
    /// Id of an input space, or another name of a source's color.
    std::string input = "lin_rec709";
    double exposure_stops = 0;
    /// Id of a display, or `linear`, or `native`.
    std::string display = "srgb";
    /// What light 1 is shown at on an HDR display, cd/m2.
    double reference_white = kReferenceWhite;
    Primaries input_primaries = kRec709;
    /// What the source holds -> scene-linear of those primaries. Empty for input spaces.
    Pipeline input_decode = {};
};

/// @throws Error  the exposure is out of range
TONEWRIGHT_API void check_exposure(double stops);

/// @param op        as resolve_operator() gives it. On a display, what the display decides of its
///                  parameters is decided here.
/// @param exposure  stops, finite, within [-64, 64].
/// @param reference_white  what an HDR display shows light 1 at, cd/m2, within [50, 1000]: 100, or
///                  203 as Report ITU-R BT.2408 has it. SDR displays, `linear` and
///                  `native` know only the default.
/// @throws Error    unknown input space or display; exposure or reference white out of range.
[[nodiscard]] TONEWRIGHT_API View make_view(ResolvedOperator op, std::string_view input,
                                            double exposure_stops, std::string_view display,
                                            double reference_white = kReferenceWhite);
/// The same for a picture whose color may be of no input space.
[[nodiscard]] TONEWRIGHT_API View make_view(ResolvedOperator op, SourceColor input,
                                            double exposure_stops, std::string_view display,
                                            double reference_white = kReferenceWhite);

/// True when light of `gamut` needs no negative light of `display`: no color of it is lost there.
[[nodiscard]] TONEWRIGHT_API bool is_inside(const Primaries& gamut, const Primaries& display);

/// Where a display's colors are limited: the gamut that light leaves the operator in, and its
/// largest value.
struct DisplayLimit {
    Primaries primaries;
    double peak = 1;
};
/// The operator's own gamut where all of it is inside the display's, so that all such displays show
/// the same colors; else the display's. White, or more where both operator and display have more.
[[nodiscard]] TONEWRIGHT_API DisplayLimit display_limit(const ResolvedOperator& op,
                                                        const Display& display);

/// Operator output -> display-linear in the limit's primaries, limited to [0, peak]: code values
/// are decoded with the operator's own power, so that nothing is encoded twice.
[[nodiscard]] TONEWRIGHT_API Pipeline display_light_stages(const ResolvedOperator& op,
                                                           const DisplayLimit& limit);

/// The whole view as stages. Its input is sanitized: scene-linear in the view's input space, or
/// what the view decodes.
/// @see sanitize in engine.h: NaN -> 0, then each channel to +-kHalfMax
[[nodiscard]] TONEWRIGHT_API Pipeline build_view(const View& view);

/// The name of the exposure, in stops, as a uniform.
inline constexpr std::string_view kExposureUniform = "exposure";

/// The same with numbers that are not known yet: uniforms of those names.
/// @param uniforms  live parameters of the operator, and kExposureUniform, which takes the place of
///                  the view's own exposure
/// @throws Error    as build_live() does
[[nodiscard]] TONEWRIGHT_API Pipeline build_live_view(const View& view,
                                                      const std::vector<std::string>& uniforms);

/// The inverse: what the view shows -> scene-linear in the view's input primaries. What the view
/// limits is not brought back.
/// @throws Error  when the operator has no inverse.
[[nodiscard]] TONEWRIGHT_API Pipeline build_inverse_view(const View& view);

/// True when R = G = B stays so within half a code value of 10 bits, over -16..+16 stops: such a
/// view shows a gray picture as a gray picture.
[[nodiscard]] TONEWRIGHT_API bool keeps_grays(const Pipeline& view);

TONEWRIGHT_NAMESPACE_END
