// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>
#include <vector>

#include "tasks/report.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ReportPictureRequest {
    std::string path = {};
    /// With associated alpha, upright. Not initialized: the chart.
    OIIO::ImageBuf picture = {};
    InputUnits input_units = InputUnits::relative;
    double reference_white = kUnitLuminance;
    /// Pixels; a wider picture is made smaller.
    int width = 960;
    /// Local operators, which the page cannot run.
    std::vector<ResolvedOperator> local_operators = {};
};

/// @throws FileError  a picture without a color, or that cannot be encoded
[[nodiscard]] ReportPicture make_report_picture(const ReportPictureRequest& request);

TONEWRIGHT_NAMESPACE_END
