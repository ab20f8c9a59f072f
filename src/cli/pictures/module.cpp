// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebuf.h>

#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/reading.h"
#include "cli/progress.h"
#include "cli/rows/picture_messages.h"
#include "image/lut_picture.h"
#include "image/shipped_pictures.h"
#include "lut/shipped_set.h"
#include "plot/cairo_surface.h"
#include "tasks/pictures/read_picture.h"
#include "tasks/pictures/report_picture.h"
#include "tonewright/chart.h"
#include "tonewright/generated_files.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void use_messages(const MessageOptions& options) { message_options() = options; }

void write_test_chart(const ChartOptions& options) {
    const OIIO::TypeDesc type = parse_pixel_type(options.type);
    if (!type.is_floating_point())
        throw Error("chart: -d is " + options.type + "; expected half or float");
    write_image_atomically(make_chart(options.width, options.height), options.file, type);
}

std::vector<float> read_pixels(const std::string& path) {
    return light_pixels(read_picture(path), path);
}

void write_plot(const CurvePlot& plot, const std::string& path, int width) {
    if (extension_of(path) == ".pdf") {
        write_text_atomically(path, to_pdf(plot, width));
        return;
    }
    PlotPixels pixels = to_pixels(plot, width);
    OIIO::ImageSpec spec(pixels.width, pixels.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    write_image_atomically(OIIO::ImageBuf(spec, pixels.rgb.data()), path, OIIO::TypeDesc::UINT8);
}

void write_shipped_luts(const std::string& folder, const std::string& application) {
    require_writable_folder(folder);
    Progress progress("bake --all", {.unit = "LUTs"});
    std::vector<ShippedLut> luts = bake_shipped_luts(application, progress.listener().progress);
    std::vector<GeneratedFile> files = make_shipped_files(luts);
    for (GeneratedFile& file : describe_shipped_luts(luts)) {
        if (file.path.ends_with(".md")) file.contents = render(file.contents, command_style());
        files.push_back(std::move(file));
    }
    write_generated_files(folder, files, "MANIFEST.csv");
}

ReportPicture read_report_picture(const ReportPictureOptions& options) {
    ReportPictureRequest request = {.path = options.path,
                                    .input_units = parse_input_units(options.light.units),
                                    .reference_white = options.light.reference_white,
                                    .width = options.width,
                                    .local_operators = options.local_operators};
    if (!options.path.empty()) request.picture = read_picture(options.path, options.choice);
    const QuietStderr quiet;
    return make_report_picture(request);
}

}  // namespace

Lut load_lut_picture(const std::string& path) {
    const QuietStderr quiet;
    return read_lut_picture(path);
}

extern "C" [[gnu::visibility("default")]] const PictureCommands* tonewright_picture_commands(
    const char* build) {
    if (std::string_view(build) != kPictureCommandsBuild) return nullptr;
    // In a static build the module has a list of unfinished files of its own.
    remove_unfinished_files_on_signals();
    lut_picture_reader() = load_lut_picture;
    static constexpr PictureCommands kCommands = {.use_messages = use_messages,
                                                  .apply = run_apply,
                                                  .meter = run_meter,
                                                  .compare = run_compare,
                                                  .chart = write_test_chart,
                                                  .sheet = run_sheet,
                                                  .info = run_info,
                                                  .read_pixels = read_pixels,
                                                  .write_plot = write_plot,
                                                  .read_lut = load_lut_picture,
                                                  .write_lut = write_lut_picture,
                                                  .write_shipped_luts = write_shipped_luts,
                                                  .read_report_picture = read_report_picture};
    return &kCommands;
}

TONEWRIGHT_NAMESPACE_END
