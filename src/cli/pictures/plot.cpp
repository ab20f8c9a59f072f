// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/pictures/commands.h"
#include "plot/cairo_surface.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

void write_plot_file(const CurvePlot& plot, const std::string& path, int width) {
    if (extension_of(path) == ".pdf") {
        write_text_atomically(path, to_pdf(plot, width));
        return;
    }
    PlotPixels pixels = to_pixels(plot, width);
    OIIO::ImageSpec spec(pixels.width, pixels.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    write_image_atomically(OIIO::ImageBuf(spec, pixels.rgb.data()), path, OIIO::TypeDesc::UINT8);
}

TONEWRIGHT_NAMESPACE_END
