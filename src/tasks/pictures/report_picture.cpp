// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/report_picture.h"

#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/comparison.h"
#include "image/contact_sheet.h"
#include "image/picture_file.h"
#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "picture/source_date.h"
#include "picture/source_pixels.h"
#include "tasks/pictures/read_picture.h"
#include "tonewright/chart.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The bytes of a file with three channels.
std::string encoded(const std::vector<float>& rgb, int width, int height, const char* name,
                    const OIIO::TypeDesc& type) {
    OIIO::Filesystem::IOVecOutput memory;  // before what writes to it until it ends
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(name);
    if (!out) throw FileError(Problem{.value = first_line(OIIO::geterror())});
    OIIO::ImageSpec spec(width, height, 3, type);
    spec.attribute("compression", type == OIIO::TypeUInt8 ? "zip:9" : "zip");
    // The writer of OpenEXR would record the current time, and each page would have other bytes.
    if (type == OIIO::TypeHalf) spec.attribute("DateTime", date_text(0));
    out->set_ioproxy(&memory);
    if (!out->open(name, spec) || !out->write_image(OIIO::TypeFloat, rgb.data()) || !out->close())
        throw FileError(Problem{.value = first_line(out->geterror())});
    return {memory.buffer().begin(), memory.buffer().end()};
}

OIIO::ImageBuf light_of(const ReportPictureRequest& request) {
    const OIIO::ImageBuf& picture = request.picture;
    if (!picture.initialized()) {
        constexpr int kLargestChart = 1536;
        const int width = std::min(request.width, kLargestChart);
        return make_chart(width, width * 9 / 16);
    }
    const SourceColor source = about_picture(request.path, [&] {
        (void)channel_layout(picture_spec(picture.spec()));
        check_shown_window(picture);
        return in_units(source_color(picture_spec(picture.spec()), kAutoInput),
                        request.input_units);
    });
    return with_memory_for(request.path, [&] {
        const OIIO::ImageBuf light =
            to_rec709_light(picture, source, request.reference_white, request.path);
        return shown_window(light).width() > request.width ? resize_scene(light, request.width)
                                                           : light;
    });
}

}  // namespace

ReportPicture make_report_picture(const ReportPictureRequest& request) {
    ReportPicture result;
    result.name =
        request.path.empty() ? "chart" : std::filesystem::path(request.path).filename().string();
    const OIIO::ImageBuf light = shown_rgb(light_of(request));
    const OIIO::ROI window = light.roi();
    result.width = window.width();
    result.height = window.height();
    std::vector<float> rgb(3 * window.npixels());
    if (!light.get_pixels(window, OIIO::TypeFloat, rgb.data()))
        throw FileError(request.path + ": " + first_line(light.geterror()));
    // Everything below is computed from the half floats that the page has.
    OIIO::ImageBuf halves(OIIO::ImageSpec(result.width, result.height, 3, OIIO::TypeHalf));
    halves.set_pixels(halves.roi(), OIIO::TypeFloat, rgb.data());
    halves.get_pixels(halves.roi(), OIIO::TypeFloat, rgb.data());
    result.exr = encoded(rgb, result.width, result.height, "light.exr", OIIO::TypeHalf);
    for (const ResolvedOperator& op : request.local_operators) {
        TonemapOptions tonemap_options;
        tonemap_options.op = op;
        tonemap_options.input = "lin_rec709";
        const OIIO::ImageBuf shown = tonemap(halves, tonemap_options);
        std::vector<float> codes(rgb.size());
        if (shown.has_error() || !shown.get_pixels(shown.roi(), OIIO::TypeFloat, codes.data()))
            throw FileError(fmt::format("{}: {}", operator_text(op), first_line(shown.geterror())));
        result.shown.push_back(
            encoded(codes, result.width, result.height, "shown.png", OIIO::TypeUInt8));
    }
    result.rgb = std::move(rgb);
    return result;
}

TONEWRIGHT_NAMESPACE_END
