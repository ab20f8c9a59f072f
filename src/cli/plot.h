// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct PlotOptions : ViewOptions {
    std::vector<std::string> operators;
    std::string file;
    std::string title;
    std::string y = "code";
    int width = 0;
    bool is_dark = false;
};

/// Writes the tone curves of the operators as .svg, .pdf or a picture.
/// @returns  the title of the plot
/// @throws Error, FileError
std::string write_plot(const PlotOptions& options);

TONEWRIGHT_NAMESPACE_END
