// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/lut.h"
#include "tonewright/lut_file.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// How near a LUT is to an operator, if it is fed and shown like this.
struct LutMatch {
    std::string op;        // label: id, preset and what is set
    std::string encoding;  // of parse_input_encoding(), or "scene-linear": it has a shaper
    std::string input;     // space that the encoded light is in
    std::string display;   // whose code values come out, or "linear"
    /// Differences of what comes out, over what can go in.
    double max = 0;
    double p999 = 0;
    double mean = 0;
    /// The definition, which lives as long as the program. A known defect says what is wrong.
    const Operator* definition = nullptr;
};

/// Which operator a lookup table is, by what it does: against operators with every input encoding,
/// in its own primaries and in Rec.709, and on SDR displays.
/// @param operators  `id`, `id:preset`; empty: all, with their defaults, and the known defects
/// @param count      how many, the nearest first; a defect only where it is nearer by a margin
/// @throws Error  for an unknown operator
[[nodiscard]] TONEWRIGHT_API std::vector<LutMatch> match_lut(
    const LutFile& lut, const std::vector<std::string>& operators, std::size_t count = 5);

TONEWRIGHT_NAMESPACE_END
