// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

namespace tonewright {

/// A scene-linear space that pictures come in.
struct InputSpace {
    std::string id;     // lin_rec709
    std::string title;  // as the OCIO config names it: "Linear Rec.709 (sRGB)"
    std::vector<std::string> aliases;
    Primaries primaries;
};

/// A display: its primaries and how light becomes code values.
struct Display {
    std::string id;     // srgb
    std::string title;  // as the OCIO config names it: "sRGB"
    std::vector<std::string> aliases;
    Primaries primaries;
    /// Display-linear (1 = peak) -> code value, of input 0.
    Expr encode;
    /// Its inverse.
    Expr decode;
    std::string source;  // the standard
};

[[nodiscard]] const std::vector<InputSpace>& all_input_spaces();
[[nodiscard]] const std::vector<Display>& all_displays();
/// By id, title or alias; letters' case does not matter. @throws Error with the nearest name.
[[nodiscard]] const InputSpace& find_input_space(std::string_view name);
[[nodiscard]] const Display& find_display(std::string_view name);

/// The two outputs that are no display: `linear` = display-linear Rec.709, unclamped;
/// `native` = the operator's own output, untouched.
inline constexpr std::string_view kLinearOutput = "linear";
inline constexpr std::string_view kNativeOutput = "native";

/// What one picture is shown with: input space -> exposure -> operator -> display-linear ->
/// display primaries -> encoding.
struct View {
    ResolvedOperator op;
    std::string input = "lin_rec709";
    double exposure_stops = 0;
    /// Id of a display, or `linear`, or `native`.
    std::string display = "srgb";
};

/// @param op        as resolve_operator() gives it.
/// @param exposure  stops, finite, within [-64, 64].
/// @throws Error    unknown input space or display; exposure out of range.
[[nodiscard]] View make_view(ResolvedOperator op, std::string_view input, double exposure_stops,
                             std::string_view display);

/// True when light of `gamut` needs no negative light of `display`: no color of it is lost there.
[[nodiscard]] bool is_inside(const Primaries& gamut, const Primaries& display);

/// Operator output -> display-linear in the display's primaries, limited to [0, 1] (SDR): code
/// values are decoded with the operator's own power, so that nothing is encoded twice.
[[nodiscard]] Pipeline display_light_stages(const Operator& op, const Primaries& display);

/// The whole view as stages. Its input is sanitised scene-linear in the view's input space.
/// @see sanitise in engine.h: NaN -> 0, then each channel to +-kHalfMax
[[nodiscard]] Pipeline build_view(const View& view);

/// True when R = G = B stays so within half a code value of 10 bits, over -16..+16 stops: such a
/// view shows a grey picture as a grey picture.
[[nodiscard]] bool keeps_greys(const Pipeline& view);

}  // namespace tonewright
