// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Extensions of the LUT files that are text, with the dot.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& lut_text_extensions();

/// Looks through a LUT file before OpenColorIO reads it, whose readers make room for whatever size
/// a file declares, leave lines out that they do not understand, take NaN for a number and wait for
/// ever for the end of a .csp's metadata. Where one of its readers fails it tries all others: a
/// file must have the form that its extension says, and nothing in its free text that another
/// reader makes room for. Accepts what is about: CRLF, comments, empty lines, no TITLE, DOMAIN_MIN
/// and DOMAIN_MAX or LUT_3D_INPUT_RANGE. Takes no memory to speak of.
/// @param path  whose extension says the format
/// @throws FileError  with path, line and reason.
TONEWRIGHT_API void check_lut_text(const std::string& path, std::string_view text);

/// A .cube: a table, a cube or both, and the light or code that each of them begins and ends at.
struct CubeText {
    struct Table {
        int size = 0;  // 0: there is none
        std::array<double, 3> lo = {0, 0, 0};
        std::array<double, 3> hi = {1, 1, 1};
        std::vector<float> rows;  // RGB triplets; of a cube red fastest
    };
    Table table;
    Table cube;
};

/// Adobe's and Resolve's .cube. OpenColorIO has a reader for each, that takes no TITLE together
/// with a range: files that are about have both.
/// @throws FileError  with path, line and reason.
[[nodiscard]] TONEWRIGHT_API CubeText parse_cube(const std::string& path, std::string_view text);

TONEWRIGHT_NAMESPACE_END
