// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <new>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/legend.h"
#include "cli/pictures/picture_input.h"
#include "image/comparison.h"
#include "image/contact_sheet.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/source_picture.h"
#include "ocio/model.h"
#include "tonewright/contact_sheet.h"
#include "tonewright/image_io.h"
#include "tonewright/lut.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kDiagnostic = "false_color";

/// "AgX (Blender)"; with a look, the name of its view in the config: "AgX Punchy".
std::string title_of(const ResolvedOperator& op) {
    for (const Look& look : op.op->looks) {
        if (look.id == op.params.look()) return op.op->view + " " + look.title;
    }
    return op.op->title;
}

/// One picture of the comparison.
struct Rendering {
    ResolvedOperator op;
    Tonemapper tonemapper;

    [[nodiscard]] std::string label() const { return title_of(op) + "\n" + operator_text(op); }
};

Rendering rendering_of(const ResolvedOperator& op, const CompareOptions& options) {
    TonemapOptions tonemap;
    tonemap.op = op;
    tonemap.exposure_stops = options.exposure;
    tonemap.input = options.input;
    tonemap.input_units = parse_input_units(options.input_units);
    tonemap.reference_white = options.reference_white;
    return {op, Tonemapper(tonemap)};
}

/// The named operators, or the views of the config.
std::vector<Rendering> renderings_of(const CompareOptions& options) {
    std::vector<Rendering> all;
    for (const std::string& text : options.operators)
        all.push_back(rendering_of(resolve_for_command(text), options));
    if (options.operators.empty()) {
        for (const ConfigModel::View& view : make_config_model().views) {
            if (!view.op.op->is_diagnostic) all.push_back(rendering_of(view.op, options));
        }
    }
    if (options.has_false_color)
        all.push_back(rendering_of(resolve_operator(kDiagnostic), options));
    return all;
}

/// Operators that measure the picture measure all of it, once.
void take_statistics(std::vector<Rendering>& renderings, const OIIO::ImageBuf& picture,
                     const CompareOptions& options) {
    const auto takes = [](const Rendering& r) { return r.tonemapper.takes_statistics(); };
    if (!std::any_of(renderings.begin(), renderings.end(), takes)) return;
    TonemapOptions as;
    as.input = options.input;
    as.input_units = parse_input_units(options.input_units);
    as.reference_white = options.reference_white;
    const SceneStatistics statistics = measure_scene(picture, as);
    for (Rendering& r : renderings) {
        if (takes(r)) r.tonemapper = r.tonemapper.with_statistics(statistics);
    }
}

OIIO::ImageBuf render(const Rendering& rendering, const OIIO::ImageBuf& scene,
                      const std::string& path) {
    OIIO::ImageBuf shown;
    if (!rendering.tonemapper(shown, scene))
        throw FileError("compare: " + path + ": " + first_line(shown.geterror()));
    return shown;
}

/// The file of a picture at full size, with its operator's name.
std::string picture_path(const CompareOptions& options, const Rendering& rendering) {
    std::string name = operator_text(rendering.op);
    for (char& c : name) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (!is_plain) c = '_';
    }
    return options.pictures + "/" + name + ".png";
}

/// @throws Error  an output is the input, or two outputs are one file
void check_outputs(const CompareOptions& options, const std::vector<Rendering>& renderings) {
    std::vector<std::string> outputs = {options.file};
    std::map<std::string, std::string> operators;  // of the pictures
    if (!options.pictures.empty()) {
        for (const Rendering& r : renderings) {
            const std::string path = picture_path(options, r);
            const std::string op = operator_text(r.op);
            const auto [other, is_new] = operators.emplace(path, op);
            if (!is_new && other->second != op) {
                throw Error(
                    fmt::format("compare: pictures of {} and {} would both be written to {}; "
                                "expected names that differ in letters or digits",
                                other->second, op, path));
            }
            if (is_new) outputs.push_back(path);
        }
    }
    for (const std::string& output : outputs) {
        if (!is_same_file(options.in, output)) continue;
        throw Error(
            fmt::format("compare: {} is {}, the same file as the input; expected another {}",
                        &output == &outputs.front() ? "-o" : "--pictures", output,
                        &output == &outputs.front() ? "file" : "folder"));
    }
    // Also where the sheet is in the folder of the pictures.
    if (operators.contains(options.file)) outputs.front() = "./" + options.file;
    require_separate_files(outputs);
}

/// Each picture at full size.
void write_pictures(const CompareOptions& options, const std::vector<Rendering>& renderings,
                    const OIIO::ImageBuf& picture) {
    require_writable_folder(options.pictures);
    for (const Rendering& r : renderings)
        write_image_atomically(render(r, picture, options.in), picture_path(options, r),
                               OIIO::TypeUInt8);
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

void write_sheet(const CompareOptions& options, const std::vector<Rendering>& renderings,
                 const OIIO::ImageBuf& picture, const std::string& remark) {
    const OIIO::ROI window = shown_window(picture);
    const auto count = static_cast<double>(renderings.size() + (options.difference ? 1 : 0));
    const PictureSize size = fitted_size(picture, options.cell_width);
    constexpr double kMostPixels = 1 << 27;  // some 4 GB with all pictures in memory
    const double pixels = count * size.width * size.height;
    if (pixels > kMostPixels) {
        throw PictureError(fmt::format(
            "a sheet of {} pictures ({} x {} pixels, shown {} wide) has {:.0f} pixels; expected at "
            "most {:.0f} (use a smaller --cell-width)",
            count, window.width(), window.height(), size.width, pixels, kMostPixels));
    }
    const OIIO::ImageBuf scene = resize_scene(picture, options.cell_width);
    std::vector<std::pair<std::string, OIIO::ImageBuf>> cells;
    SheetAnnotations around;
    around.heading = name_of(options.in);
    around.remark = remark;
    for (const Rendering& r : renderings) {
        cells.emplace_back(r.label(), render(r, scene, options.in));
        if (r.op.op->id == kDiagnostic && around.legend.empty()) add_legend(around);
    }
    if (options.difference) {
        PictureDifference difference =
            difference_of(cells[0].second, cells[1].second, *options.difference);
        cells.emplace_back(
            fmt::format("Difference x {:g}\nlargest {:.1f}, mean {:.2f} 8-bit codes",
                        *options.difference, 255 * difference.largest, 255 * difference.mean),
            std::move(difference.picture));
    }
    const int columns = options.columns > 0
                            ? options.columns
                            : choose_columns(static_cast<int>(cells.size()), scene.spec().width,
                                             scene.spec().height);
    write_image_atomically(make_contact_sheet(cells, columns, options.cell_width, around),
                           options.file, OIIO::TypeUInt8);
}

void write_split(const CompareOptions& options, const std::vector<Rendering>& renderings,
                 const OIIO::ImageBuf& picture) {
    SplitOptions split;
    split.before = {title_of(renderings[0].op), operator_text(renderings[0].op)};
    split.after = {title_of(renderings[1].op), operator_text(renderings[1].op)};
    split.remark = fmt::format("{}, {}", name_of(options.in), exposure_text(options.exposure));
    split.position = *options.split;
    split.is_horizontal = options.is_horizontal;
    split.has_labels = !options.has_no_labels;
    write_image_atomically(make_split(render(renderings[0], picture, options.in),
                                      render(renderings[1], picture, options.in), split),
                           options.file, OIIO::TypeUInt8);
}

void compare_pictures(CompareOptions options) {
    if (options.is_resized) check_resize("compare", options.resize, options.picture);
    std::vector<Rendering> renderings = renderings_of(options);
    if (options.split || options.difference) {
        if (options.operators.size() != 2 || options.has_false_color) {
            throw Error(fmt::format("compare: {} is given with {} operators; expected two{}",
                                    options.split ? "--split" : "--difference",
                                    options.operators.size(),
                                    options.has_false_color ? ", without --false-color" : ""));
        }
    }
    check_outputs(options, renderings);
    OIIO::ImageBuf picture = read_picture(options.in, options.picture, options.input);
    const QuietStderr quiet;
    const SourceColor source = about_picture(options.in, [&] {
        (void)channel_layout(picture.spec());
        return in_units(source_color(picture.spec(), options.input),
                        parse_input_units(options.input_units));
    });
    const std::string remark =
        fmt::format("{}, {}, shown on sRGB", exposure_text(options.exposure), title_of(source));
    if (options.is_resized) {
        TonemapOptions light;
        light.input = options.input;
        light.exposure_stops = options.exposure;
        light.reference_white = options.reference_white;
        light.input_units = parse_input_units(options.input_units);
        picture = with_memory_for(options.in, [&] {
            return resized_picture(picture, options.resize, light,
                                   options.picture.max_pixels.value_or(kMaxPixels));
        });
    } else if (source.convert || (!options.split && !source.decode.empty())) {
        // Code values are not light, so they are not scaled.
        picture = to_rec709_light(picture, source, options.reference_white, options.in);
        options.input = "lin_rec709";
        options.input_units = "relative";
        options.reference_white = kUnitLuminance;
        renderings = renderings_of(options);
    }
    about_picture(options.in, [&] { take_statistics(renderings, picture, options); });
    with_memory_for(options.in, [&] {
        if (options.split) {
            write_split(options, renderings, picture);
        } else {
            write_sheet(options, renderings, picture, remark);
            if (!options.pictures.empty()) write_pictures(options, renderings, picture);
        }
    });
}

}  // namespace

void run_compare(CompareOptions options) {
    const std::string path = options.in;
    try {
        compare_pictures(std::move(options));
    } catch (const PictureError& e) {
        throw FileError(within("compare: " + path, e.problem()));
    } catch (const std::bad_alloc&) {
        throw FileError(within("compare: " + path, no_memory()));
    }
}

TONEWRIGHT_NAMESPACE_END
