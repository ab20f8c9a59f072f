// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "tasks/listener.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A folder by which an engine tests its own function of an operator, without Tonewright.
struct ConformanceRequest {
    /// Display `linear` for functions of renderers that encode their pictures themselves.
    View view;
    std::string folder;
};

struct ConformanceResult {
    std::size_t colors = 0;  // of colors.csv
    /// For functions in 32-bit float: largest error of code values, of sRGB if the output is light.
    /// Absolute up to 1, relative above.
    double tolerance = 0;
};

/// Writes the tables colors.csv, negative.csv and extremes.csv, runners in several languages, and
/// README.md.
/// @throws Error      a local operator
/// @throws FileError  a file cannot be written
[[nodiscard]] ConformanceResult write_conformance_kit(const ConformanceRequest& request,
                                                      const Listener& listener);

TONEWRIGHT_NAMESPACE_END
