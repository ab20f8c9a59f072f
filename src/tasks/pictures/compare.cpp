// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "image/comparison.h"
#include "image/contact_sheet.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tasks/pictures/read_picture.h"
#include "tonewright/contact_sheet.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// "AgX (Blender)"; with a look, the name of its view in the config: "AgX Punchy".
std::string title_of(const ResolvedOperator& op) {
    for (const Look& look : op.op->looks) {
        if (look.id == op.params.look()) return op.op->view + " " + look.title;
    }
    return op.op->title;
}

std::string name_of(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

std::string exposure_text(double stops) {
    if (stops == 0) return "exposure 0";
    return fmt::format("exposure {:+g} {}", stops, std::fabs(stops) == 1 ? "stop" : "stops");
}

std::string title_of(const SourceColor& source) {
    for (const InputSpace& space : all_input_spaces()) {
        if (space.id == source.name) return space.title;
    }
    return source.name;
}

OIIO::ImageBuf render(const Tonemapper& tonemapper, const OIIO::ImageBuf& scene) {
    OIIO::ImageBuf shown;
    if (!tonemapper(shown, scene)) throw PictureError(first_line(shown.geterror()));
    return shown;
}

void add_legend(SheetAnnotations& around) {
    const ReferenceEngine engine(
        build_view(make_view(resolve_operator(kFalseColor), "lin_rec709", 0, "srgb")));
    constexpr int kStops = 7;
    for (int stop = -kStops; stop <= kStops; ++stop) {
        const auto gray = static_cast<float>(0.18 * std::exp2(stop));
        const std::array<float, 3> scene = {gray, gray, gray};
        std::array<double, 3> code{};
        engine.run_rgb(scene.data(), code.data(), 1);
        around.legend.push_back({fmt::format("{}{}", stop > 0 ? "+" : "", stop),
                                 {static_cast<float>(code[0]), static_cast<float>(code[1]),
                                  static_cast<float>(code[2])}});
    }
    around.legend_heading = "False color: stops from mid gray, after exposure";
}

}  // namespace

OIIO::ImageBuf with_legend(const OIIO::ImageBuf& picture) {
    SheetAnnotations around;
    add_legend(around);
    return make_contact_sheet({{"", picture}}, 1, shown_window(picture).width(), around);
}

bool is_same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    return std::filesystem::equivalent(a, b, error) && !error;
}

std::string Comparison::Rendering::label() const { return title_of(op) + "\n" + operator_text(op); }

Comparison::Comparison(ComparisonRequest request) : request_(std::move(request)) {
    if ((request_.split || request_.difference) && request_.operators.size() != 2)
        throw Error(Problem{.value = "a split or a difference is of two operators"});
    make_renderings();
    check_outputs();
}

void Comparison::make_renderings() {
    renderings_.clear();
    for (const ResolvedOperator& op : request_.operators) {
        TonemapOptions options = request_.tonemap;
        options.op = op;
        renderings_.push_back({op, Tonemapper(options)});
    }
}

/// Operators that measure the picture measure all of it, once.
void Comparison::take_statistics(const OIIO::ImageBuf& picture) {
    const auto takes = [](const Rendering& r) { return r.tonemapper.takes_statistics(); };
    if (!std::any_of(renderings_.begin(), renderings_.end(), takes)) return;
    TonemapOptions as;
    as.input = request_.tonemap.input;
    as.input_units = request_.tonemap.input_units;
    as.reference_white = request_.tonemap.reference_white;
    const SceneStatistics statistics = measure_scene(picture, as);
    for (Rendering& r : renderings_) {
        if (takes(r)) r.tonemapper = r.tonemapper.with_statistics(statistics);
    }
}

/// The file of a picture at full size, with its operator's name.
std::string Comparison::picture_path(const Rendering& rendering) const {
    std::string name = operator_text(rendering.op);
    for (char& c : name) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (!is_plain) c = '_';
    }
    return request_.pictures + "/" + name + ".png";
}

void Comparison::check_outputs() const {
    std::vector<std::string> outputs = {request_.file};
    std::map<std::string, std::string> operators;  // of the pictures
    if (!request_.pictures.empty()) {
        for (const Rendering& r : renderings_) {
            const std::string path = picture_path(r);
            const std::string op = operator_text(r.op);
            const auto [other, is_new] = operators.emplace(path, op);
            if (!is_new && other->second != op) {
                throw Error(
                    {.value = fmt::format("pictures of {} and {} would both be written to {}",
                                          other->second, op, path),
                     .expected = "names that differ in letters or digits"});
            }
            if (is_new) outputs.push_back(path);
        }
    }
    for (const std::string& output : outputs) {
        if (!is_same_file(request_.in, output)) continue;
        const bool is_file = &output == &outputs.front();
        throw Error({.parameter = is_file ? "target" : "pictures",
                     .value = output + ", the same file as the input",
                     .expected = is_file ? "another file" : "another folder"});
    }
    // Also where the sheet is in the folder of the pictures.
    if (operators.contains(request_.file)) outputs.front() = "./" + request_.file;
    require_separate_files(outputs);
}

void Comparison::write_pictures(const OIIO::ImageBuf& picture) const {
    require_writable_folder(request_.pictures);
    for (const Rendering& r : renderings_)
        write_image_atomically(render(r.tonemapper, picture), picture_path(r), OIIO::TypeUInt8);
}

void Comparison::write_sheet(const OIIO::ImageBuf& picture, const std::string& remark) const {
    const OIIO::ROI window = shown_window(picture);
    const auto count = static_cast<double>(renderings_.size() + (request_.difference ? 1 : 0));
    const PictureSize size = fitted_size(picture, request_.cell_width);
    constexpr double kMostPixels = 1 << 27;  // some 4 GB with all pictures in memory
    const double pixels = count * size.width * size.height;
    if (pixels > kMostPixels) {
        throw PictureError(fmt::format(
            "a sheet of {} pictures ({} x {} pixels, shown {} wide) has {:.0f} pixels; expected at "
            "most {:.0f} (use a smaller <<cell_width>>)",
            count, window.width(), window.height(), size.width, pixels, kMostPixels));
    }
    const OIIO::ImageBuf scene = resize_scene(picture, request_.cell_width);
    std::vector<std::pair<std::string, OIIO::ImageBuf>> cells;
    SheetAnnotations around;
    around.heading = name_of(request_.in);
    around.remark = remark;
    for (const Rendering& r : renderings_) {
        cells.emplace_back(r.label(), render(r.tonemapper, scene));
        if (r.op.op->id == kFalseColor && around.legend.empty()) add_legend(around);
    }
    if (request_.difference) {
        PictureDifference difference =
            difference_of(cells[0].second, cells[1].second, *request_.difference);
        cells.emplace_back(
            fmt::format("Difference x {:g}\nlargest {:.1f}, mean {:.2f} 8-bit codes",
                        *request_.difference, 255 * difference.largest, 255 * difference.mean),
            std::move(difference.picture));
    }
    const int columns = request_.columns > 0
                            ? request_.columns
                            : choose_columns(static_cast<int>(cells.size()), scene.spec().width,
                                             scene.spec().height);
    write_image_atomically(make_contact_sheet(cells, columns, request_.cell_width, around),
                           request_.file, OIIO::TypeUInt8);
}

void Comparison::write_split(const OIIO::ImageBuf& picture) const {
    SplitOptions split;
    split.before = {title_of(renderings_[0].op), operator_text(renderings_[0].op)};
    split.after = {title_of(renderings_[1].op), operator_text(renderings_[1].op)};
    split.remark =
        fmt::format("{}, {}", name_of(request_.in), exposure_text(request_.tonemap.exposure_stops));
    split.position = *request_.split;
    split.is_horizontal = request_.is_horizontal;
    split.has_labels = request_.has_labels;
    write_image_atomically(make_split(render(renderings_[0].tonemapper, picture),
                                      render(renderings_[1].tonemapper, picture), split),
                           request_.file, OIIO::TypeUInt8);
}

void Comparison::write(OIIO::ImageBuf picture) {
    TonemapOptions& light = request_.tonemap;
    const SourceColor source = about_picture(request_.in, [&] {
        (void)channel_layout(picture_spec(picture.spec()));
        return in_units(source_color(picture_spec(picture.spec()), light.input), light.input_units);
    });
    const std::string remark =
        fmt::format("{}, {}, shown on sRGB", exposure_text(light.exposure_stops), title_of(source));
    if (!request_.resize.empty()) {
        picture = with_memory_for(request_.in, [&] {
            return resized_picture(picture, request_.resize, light, request_.max_pixels);
        });
    } else if (source.convert || (!request_.split && !source.decode.empty())) {
        // Code values are not light, so they are not scaled.
        picture = to_rec709_light(picture, source, light.reference_white, request_.in);
        light.input = "lin_rec709";
        light.input_units = InputUnits::relative;
        light.reference_white = kUnitLuminance;
        make_renderings();
    }
    about_picture(request_.in, [&] { take_statistics(picture); });
    with_memory_for(request_.in, [&] {
        if (request_.split) {
            write_split(picture);
        } else {
            write_sheet(picture, remark);
            if (!request_.pictures.empty()) write_pictures(picture);
        }
    });
}

TONEWRIGHT_NAMESPACE_END
