// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An application that reads a LUT, and what it expects.
struct LutApplication {
    std::string id;     // resolve
    std::string title;  // "DaVinci Resolve"
    LutFormat format;
    int size;  // grid points a side
    std::string encoding;
    /// Id of the display whose code values come out, or `linear`.
    std::string display;
    std::optional<int> bits;
    /// What the application does between the nodes.
    std::string interpolation;
    /// What a user does with the file.
    std::string steps;
    /// Empty: the format was checked, the application not run.
    std::string tested;
};
[[nodiscard]] TONEWRIGHT_API const std::vector<LutApplication>& all_lut_applications();
/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API const LutApplication& find_lut_application(std::string_view id);

/// True where the application interpolates in cubes, not in tetrahedra, unless told otherwise.
[[nodiscard]] TONEWRIGHT_API bool is_trilinear(const LutApplication& host);

TONEWRIGHT_NAMESPACE_END
