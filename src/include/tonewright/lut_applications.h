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
    /// The application brings light into any primaries before the LUT. LUTs for it are in the
    /// operator's own: a clip to these then falls on the sides of the grid, not through its cells.
    bool takes_any_primaries = false;
};
[[nodiscard]] TONEWRIGHT_API const std::vector<LutApplication>& all_lut_applications();
/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API const LutApplication& find_lut_application(std::string_view id);

/// The space whose light the application gives a LUT of this operator: of the operator's working
/// primaries where it can, else of its encoding's own.
[[nodiscard]] TONEWRIGHT_API std::string lut_input_of(const LutApplication& application,
                                                      const Operator& op);

/// The format of a LUT file: `format`, else what the application reads, else what the extension of
/// the file says.
/// @param application  null: none
/// @throws Error  the extension is none of the format's, or says no format
[[nodiscard]] TONEWRIGHT_API LutFormat lut_format_of_file(const std::string& path,
                                                          std::optional<LutFormat> format,
                                                          const LutApplication* application);

/// True where the application interpolates in cubes, not in tetrahedra, unless told otherwise.
[[nodiscard]] TONEWRIGHT_API bool is_trilinear(const LutApplication& host);

TONEWRIGHT_NAMESPACE_END
