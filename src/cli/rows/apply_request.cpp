// SPDX-License-Identifier: Apache-2.0
#include "cli/rows/apply_request.h"

#include <fmt/format.h>

#include "base/strings.h"
#include "cli/command.h"
#include "picture/picture_description.h"
#include "picture/row_fitter.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

ReadOptions read_options_of(const PictureChoice& choice) {
    ReadOptions options;
    if (choice.subimage.starts_with('-')) {
        throw Error("--subimage is " + printable(choice.subimage) +
                    "; expected a number from 0, or a name");
    }
    options.subimage = choice.subimage;
    options.layer = choice.layer;
    options.max_pixels = choice.max_pixels.value_or(kMaxPixels);
    return options;
}

TonemapOptions::Unpremult alpha_of(const PictureInput& input) {
    if (input.unpremult) return TonemapOptions::Unpremult::yes;
    if (input.no_unpremult) return TonemapOptions::Unpremult::no;
    return TonemapOptions::Unpremult::automatic;
}

WriteOptions write_options_of(const ApplyOptions& options) {
    WriteOptions write;
    if (!options.type.empty()) set_pixel_type(write, options.type);
    set_alpha(write, options.alpha);
    write.compression = options.compression;
    write.quality = options.quality;
    write.subsampling = options.subsampling;
    write.verifies = options.verifies_output;
    if (options.picture.max_pixels) write.max_pixels = *options.picture.max_pixels;
    write.write_provenance = !options.has_no_metadata;
    return write;
}

TonemapOptions tonemap_options_of(const ApplyOptions& options, const WriteOptions& write) {
    TonemapOptions tonemap;
    tonemap.exposure_stops = options.exposure;
    tonemap.input = options.input;
    tonemap.display = options.display;
    tonemap.reference_white = options.reference_white;
    tonemap.input_units = parse_input_units(options.input_units);
    tonemap.unpremult = alpha_of(options.picture);
    tonemap.dither = options.dither;
    tonemap.mix = options.mix;
    if (find_choice("statistics", options.statistics, {"picture", "sequence", "defaults"}) == 2)
        tonemap.statistics = TonemapOptions::Statistics::defaults;
    take_alpha(tonemap, write);
    return tonemap;
}

bool keeps_type(const std::string& out, const ApplyOptions& options) {
    return options.type.empty() && extension_of(out) == ".exr";
}

namespace {

/// " (half, as the input; -d float for 32 bits)"; empty if an option or the format decides.
std::string kept_type_text(const std::string& out, const ApplyOptions& options,
                           const OIIO::TypeDesc& source) {
    if (!keeps_type(out, options)) return {};
    const OIIO::TypeDesc type = openexr_type(source);
    const std::string why =
        type == source ? "as the input" : fmt::format("which holds {}", name_of(source));
    return fmt::format(
        " ({}, {}; {})", name_of(type), why,
        type == OIIO::TypeDesc::HALF ? "-d float for 32 bits" : "-d half for 16 bits");
}

}  // namespace

void print_result(const AppliedPicture& done, const TonemapOptions& options,
                  const ApplyOptions& given, const ResultLine& line) {
    if (!says_what_was_done()) return;
    const ResolvedOperator& op = options.op;
    const PictureDescription said = describe_picture(done.source, options.input);
    std::string text = fmt::format(
        "apply: {} ({} x {} {}, {} by {}) -> {}{}: {} ({}), exposure {:+.3g}, display "
        "{}{}",
        done.in, done.source.width, done.source.height, name_of(done.source.format),
        said.color.name, said.rule, done.out, kept_type_text(done.out, given, done.source.format),
        op.op->view, operator_text(op), done.exposure_stops.value_or(options.exposure_stops),
        options.display, done.resized);
    if (message_options().is_verbose) text += fmt::format(", {} threads", done.threads);
    line.print(text);
}

void tell_default_operator(const ApplyOptions& options) {
    if (!options.op.empty() || options.is_false_color || message_options().is_quiet) return;
    print_message(fmt::format("apply: operator is {} ({}), the default; use --operator for another",
                              kDefaultOperator, find_operator(kDefaultOperator).view));
}

TONEWRIGHT_NAMESPACE_END
