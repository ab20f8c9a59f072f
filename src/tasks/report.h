// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tonewright/verify.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ReportPicture {
    std::string name;
    int width = 0;
    int height = 0;
    std::string exr;         // scene-linear Rec.709 in half floats
    std::vector<float> rgb;  // the same
    /// Output of local operators on sRGB, as PNG, in the order of the request.
    std::vector<std::string> shown;
};

/// A page that shows operators on pictures, on an sRGB screen.
struct ReportRequest {
    /// The page has each once, and also `false_color`.
    std::vector<ResolvedOperator> operators = {};
    /// Empty: the chart.
    std::vector<std::string> pictures = {};
    /// Reads a picture. The path is empty for the chart. The page cannot run local operators.
    std::function<ReportPicture(const std::string& path,
                                const std::vector<ResolvedOperator>& local_operators)>
        read_picture = {};
    /// Includes the rows of verify().
    bool has_parity = true;
    /// Runs for these rows, @see VerifyOptions::shaders. Called after the pictures were read.
    std::function<std::vector<LanguageRun>()> shader_runs = {};
    /// @see LowerOptions; empty: nothing is stored.
    std::string cache_folder = {};
    /// Receives the number of operators that were measured on the pictures, and of verified views.
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// All operators, also local ones.
/// @param has_variants  also their presets and looks
[[nodiscard]] std::vector<ResolvedOperator> report_operators(bool has_variants);

/// The page as one HTML file.
/// @throws Error  @see verify, write_shader; and what read_picture throws
[[nodiscard]] std::string make_report(const ReportRequest& request);

TONEWRIGHT_NAMESPACE_END
