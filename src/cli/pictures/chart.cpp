// SPDX-License-Identifier: Apache-2.0
#include "tonewright/chart.h"
#include "cli/pictures/commands.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

void run_chart(const ChartOptions& options) {
    const OIIO::TypeDesc type = parse_pixel_type(options.type);
    if (!type.is_floating_point()) {
        throw Error("chart: -d is " + options.type + "; expected half or float");
    }
    write_image_atomically(make_chart(options.width, options.height), options.file, type);
}

TONEWRIGHT_NAMESPACE_END
