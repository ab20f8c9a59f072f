// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/compare.h"

#include <fmt/format.h>

#include <new>
#include <utility>
#include <vector>

#include "base/input_file.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/reading.h"
#include "cli/pictures/requests.h"
#include "cli/progress.h"
#include "cli/rows/picture_messages.h"
#include "image/contact_sheet.h"
#include "ocio/model.h"
#include "picture/picture_error.h"
#include "tonewright/contact_sheet.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The named operators, or the views of the config.
std::vector<ResolvedOperator> operators_of(const CompareOptions& options) {
    std::vector<ResolvedOperator> all;
    for (const std::string& text : options.operators)
        all.push_back(resolve_for_command(text));
    if (options.operators.empty()) {
        for (const ConfigModel::View& view : make_config_model().views) {
            if (!view.op.op->is_diagnostic) all.push_back(view.op);
        }
    }
    if (options.has_false_color) all.push_back(resolve_operator(kFalseColor));
    return all;
}

ComparisonRequest request_of(const CompareOptions& options) {
    ComparisonRequest request;
    request.in = options.in;
    request.file = options.file;
    request.pictures = options.pictures;
    request.operators = operators_of(options);
    request.tonemap.exposure_stops = options.exposure;
    request.tonemap.input = options.light.input;
    request.tonemap.input_units = parse_input_units(options.light.units);
    request.tonemap.reference_white = options.light.reference_white;
    request.resize = options.resize;
    request.max_pixels = options.picture.max_pixels.value_or(kMaxPixels);
    request.columns = options.columns;
    request.cell_width = options.cell_width;
    request.difference = options.difference;
    request.split = options.split;
    request.is_horizontal = options.is_horizontal;
    request.has_labels = !options.has_no_labels;
    return request;
}

}  // namespace

void run_compare(const CompareOptions& options) {
    if (options.given.contains("--resize"))
        check_resize("compare", options.resize, options.picture);
    ComparisonRequest request = request_of(options);
    if ((options.split || options.difference) &&
        (options.operators.size() != 2 || options.has_false_color)) {
        throw Error(fmt::format("compare: {} is given with {} operators; expected two{}",
                                options.split ? "--split" : "--difference",
                                options.operators.size(),
                                options.has_false_color ? ", without --false-color" : ""));
    }
    try {
        Comparison comparison(std::move(request));
        OIIO::ImageBuf picture = read_picture(options.in, options.picture, options.light.input);
        const QuietStderr quiet;
        const Progress progress("compare", {.terminal = quiet.before()});
        comparison.write(std::move(picture));
    } catch (const PictureError& e) {
        throw FileError(within("compare: " + options.in, e.problem()));
    } catch (const std::bad_alloc&) {
        throw FileError(within("compare: " + options.in, no_memory()));
    }
}

void run_sheet(const SheetOptions& options) {
    std::vector<std::pair<std::string, OIIO::ImageBuf>> labeled;
    for (const std::string& text : options.pictures) {
        const std::size_t equals = text.find('=');
        const std::string path = equals == std::string::npos ? text : text.substr(equals + 1);
        if (is_same_file(path, options.file)) {
            throw Error(fmt::format(
                "sheet: -o is {}, the same file as an input; expected another file", options.file));
        }
        labeled.emplace_back(equals == std::string::npos ? text : text.substr(0, equals),
                             read_picture(path, options.choice));
        try {
            check_shown_window(labeled.back().second);
        } catch (const PictureError& e) {
            throw FileError(within("sheet: " + path, e.problem()));
        }
    }
    write_image_atomically(make_contact_sheet(labeled, options.columns, options.cell_width),
                           options.file, OIIO::TypeUInt8);
}

TONEWRIGHT_NAMESPACE_END
