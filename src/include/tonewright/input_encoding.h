// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Encoding of scene-linear light in [0, 1], the input range of a LUT.
struct InputEncoding {
    std::string id;     // "acescct", "log2:-10:6.5", "linear:0:1"
    std::string title;  // for headers: "ACEScct (Academy S-2016-001)"
    /// Scene-linear -> input of the LUT, and the inverse; functions of input 0.
    Expr encode = Expr::input();
    Expr decode = Expr::input();
    /// Scene-linear light at input 0 and 1 of the LUT.
    double scene_lo = 0;
    double scene_hi = 1;
    bool is_linear = false;
    /// Input space of the encoding, used if the user names none.
    std::string default_input = "lin_rec709";
    /// Nodes a side of the operator that is a grid in this encoding; a 3D LUT of this size is that
    /// grid. 0: none.
    int grid_size = 0;
};

/// `acescct`, `logc3` (ARRI, EI 800), `logc4`, `slog3` (Sony), `davinci` (DaVinci Intermediate),
/// `unity_logc`, `unreal_log`, `srgb`, `agx_log` (E-Gamut, log2 from -10 to 15 stops: the grid of
/// Blender's AgX); `pq[:WHITE]` = SMPTE ST 2084, scene-linear 1 at WHITE cd/m2 (default 100);
/// `hlg[:WHITE]` = HLG of ITU-R BT.2100, the scene light of each channel by its inverse OETF, where
/// scene-linear 1 is the gray that an HLG display of 1000 cd/m2 shows at WHITE cd/m2 (default 100),
/// without the display's OOTF, which mixes channels; `log2[:LO:HI]` = log2 of scene-linear over
/// 0.18, LO..HI stops (default -10:6.5); `reinhard` = x/(x + 1) of scene-linear x, up to 65504, as
/// in Tony McMapface; `linear[:LO:HI]` = scene-linear (default 0:1).
/// @throws Error  unknown name; parameters that are not numbers or out of range
[[nodiscard]] TONEWRIGHT_API InputEncoding parse_input_encoding(std::string_view text);
/// Names without parameters.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> input_encoding_names();

TONEWRIGHT_NAMESPACE_END
