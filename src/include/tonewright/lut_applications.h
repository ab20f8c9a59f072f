// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An application that reads LUTs, and the LUT that it expects.
struct LutApplication {
    std::string id;     // resolve
    std::string title;  // "DaVinci Resolve"
    LutFormat format;
    int size;  // grid points a side
    std::string encoding;
    /// Id of the display whose code values are the output, or `linear`.
    std::string display;
    std::optional<int> bits;
    /// The application's interpolation between nodes.
    std::string interpolation;
    /// Instructions for the user.
    std::string steps;
    /// Tested versions. Empty: the format was checked, but the application did not run.
    std::string tested;
    /// The application can convert light to any primaries before the LUT. @see lut_input_of
    bool takes_any_primaries = false;
    /// Instructions for a clf or ctf file of scene-linear input. Empty: the application does not
    /// read chains of operations.
    std::string chain_steps = {};
    /// Grid points a side that the application reads; it has `size` unless the user wants others.
    int largest_size = 129;
};
[[nodiscard]] TONEWRIGHT_API const std::vector<LutApplication>& all_lut_applications();
/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API const LutApplication& find_lut_application(std::string_view id);

/// The input space of a LUT of this operator for the application: Rec.709 or Rec.2020, whichever
/// suits the operator, if the application can convert to it; else that of the encoding.
[[nodiscard]] TONEWRIGHT_API std::string lut_input_of(const LutApplication& application,
                                                      const Operator& op);

/// @throws Error  more grid points a side than the application reads
TONEWRIGHT_API void check_lut_size(const LutApplication& application, int size);
/// True if the LUT is a 1D table unless the user wants another: one curve for each channel is exact
/// so, where the application can convert to the primaries of the view.
[[nodiscard]] TONEWRIGHT_API bool is_table_for(const LutApplication& application, const View& view);
/// True if the LUT takes the encoding and the primaries that the application gives it.
[[nodiscard]] TONEWRIGHT_API bool has_usual_input(const LutApplication& application,
                                                  const LutRequest& request);
/// True if the instructions hold for LUTs of all displays.
[[nodiscard]] TONEWRIGHT_API bool takes_any_display(const LutApplication& application);

/// True if the application reads clf and ctf files as chains of operations on scene-linear input,
/// and the format is one of them.
[[nodiscard]] TONEWRIGHT_API bool reads_chains(const LutApplication& application, LutFormat format);
/// The encoding of the input of a LUT in this format for the application: `linear` for chains.
[[nodiscard]] TONEWRIGHT_API std::string lut_encoding_of(const LutApplication& application,
                                                         LutFormat format);
/// Instructions for a LUT in this format.
[[nodiscard]] TONEWRIGHT_API const std::string& lut_steps_of(const LutApplication& application,
                                                             LutFormat format);

/// The format of a LUT file: `format`, else the application's, else that of the file's extension.
/// @param application  null: none
/// @throws Error  the extension is unknown, or contradicts the format
[[nodiscard]] TONEWRIGHT_API LutFormat lut_format_of_file(const std::string& path,
                                                          std::optional<LutFormat> format,
                                                          const LutApplication* application);

/// Default interpolation of the application.
/// @param application  null: `automatic`
[[nodiscard]] TONEWRIGHT_API LutInterpolation interpolation_of(const LutApplication* application);

TONEWRIGHT_NAMESPACE_END
