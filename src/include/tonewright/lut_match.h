// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/lut.h"
#include "tonewright/lut_file.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Difference between a LUT and an operator, for one input encoding and display.
struct LutMatch {
    std::string op;  // label: id, preset and settings
    std::string
        encoding;         // as in parse_input_encoding(), or "scene-linear" for a LUT with a shaper
    std::string input;    // space of the encoded light
    std::string display;  // display of the output's code values, or "linear"
    /// Differences of the output over the whole input range.
    double max = 0;
    double p999 = 0;
    double mean = 0;
    /// The definition, which lives as long as the program. A known defect describes its mistake.
    const Operator* definition = nullptr;
};

/// Identifies the operator of a LUT. Compares its output with operators in every input encoding, in
/// the encoding's own primaries and in Rec.709, and on SDR displays.
/// @param operators  empty: all, with their defaults, and the known defects
/// @param count      number of matches, the nearest first; a defect must be nearer by a margin
[[nodiscard]] TONEWRIGHT_API std::vector<LutMatch> match_lut(
    const LutFile& lut, const std::vector<ResolvedOperator>& operators, std::size_t count = 5);

TONEWRIGHT_NAMESPACE_END
