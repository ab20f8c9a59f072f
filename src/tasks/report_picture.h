// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A picture of the report page.
struct ReportPicture {
    std::string name;
    int width = 0;
    int height = 0;
    std::string exr;         // scene-linear Rec.709 in half floats
    std::vector<float> rgb;  // the same
    /// Output of local operators on sRGB, as PNG, in the order of the request.
    std::vector<std::string> shown;
};

TONEWRIGHT_NAMESPACE_END
