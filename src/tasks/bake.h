// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/listener.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The encoding of a LUT's input without an application.
inline constexpr std::string_view kDefaultLutEncoding = "acescct";

/// `auto`, `sampled`, `fitted` or `smooth`. @throws Error  any other text
[[nodiscard]] LutNodes parse_lut_nodes(std::string_view text);

/// An operator as a LUT file. The application decides what has no value, else the defaults of the
/// library do.
struct BakeRequest {
    std::string file;
    ResolvedOperator op;
    /// It reads the file. Null: none.
    const LutApplication* application = nullptr;
    /// With an application: another file than its own.
    std::optional<LutFormat> format = {};
    std::optional<InputEncoding> encoding = {};
    /// Null: the application's, or that of the encoding.
    const InputSpace* input = nullptr;
    InputUnits input_units = InputUnits::relative;
    double exposure_stops = 0;
    /// @see View::display
    std::optional<std::string> display = {};
    /// cd/m2
    double reference_white = kUnitLuminance;
    LutDimension dimension = LutDimension::automatic;
    std::optional<int> size = {};
    /// @see LutRequest::bits
    std::optional<int> depth = {};
    std::optional<int> decimals = {};
    std::optional<int> icc_version = {};
    /// @see bake_lut
    std::optional<double> max_error = {};
    LutNodes nodes = LutNodes::automatic;
    /// Writes a LUT that is a picture, with 8, 16 or 32 bits.
    std::function<void(const Lut& lut, LutFormat format, const std::string& path, int bits)>
        write_picture = {};
    /// @see make_lut_chain
    std::string cache_folder = {};
};

struct BakeResult {
    /// All that was decided.
    LutRequest request;
    /// "matrix, half LUT, 3D LUT": the file is a chain of these. Empty: it is a LUT.
    std::string operations = {};
    /// A chain has its error only.
    BakedLut baked = {};
    LutClipping clipping = {};
    /// For the user of the application, one line each. @see render
    std::vector<std::string> steps = {};
};

/// The LUT, with what the application decides.
/// @throws Error  contradictions in the request; a size that the application cannot read
[[nodiscard]] LutRequest lut_request_of(const BakeRequest& request, LutFormat format);

/// Writes the file. An old one is replaced when the new one is complete.
/// @throws Error      @see bake_lut, make_lut_chain, lut_format_of_file
/// @throws FileError  the file cannot be written
[[nodiscard]] BakeResult bake(const BakeRequest& request, const Listener& listener);

TONEWRIGHT_NAMESPACE_END
