// SPDX-License-Identifier: Apache-2.0
#include "cli/lut_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tuple>

#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "cli/messages.h"
#include "lut/stated_input.h"
#include "pipeline/exposure.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

LutFile open_lut(const std::string& path, const std::string& interpolation,
                 const std::function<Lut(const std::string&)>& read_picture) {
    silence_opencolorio();
    const LutInterpolation between = parse_lut_interpolation(interpolation);
    if (!is_lut_picture(path)) {
        LutFile lut(path, between);
        if (!lut.note().empty()) warn(path + ": " + lut.note());
        return lut;
    }
    return LutFile(read_picture(path), between);
}

namespace {

/// The part of a file from Tonewright that has its text.
/// @throws FileError  not a regular file, which may have no end
const std::string& text_of_lut(const LutOptions& options) {
    if (options.text) return *options.text;
    require_regular_file(options.file);
    // Our text is at the beginning, but in a device link it comes after the table.
    constexpr std::size_t kBeginning = 1U << 16U;
    const std::string extension = extension_of(options.file);
    const bool is_link = extension == ".icc" || extension == ".icm";
    std::string contents(is_link ? std::size_t{1} << 26U : kBeginning, '\0');
    std::ifstream file(options.file, std::ios::binary);
    file.read(contents.data(), static_cast<std::streamsize>(contents.size()));
    contents.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
    options.text = std::move(contents);
    return *options.text;
}

/// The stages before the LUT, with --input-encoding.
const InputSpace& space_before(const LutOptions& options, const InputEncoding& encoding) {
    return find_input_space(options.space.empty() ? encoding.default_input : options.space);
}

/// `none` is for pictures that are encoded already.
void warn_of_contradiction(const LutOptions& options, const StatedInput& stated) {
    if (options.encoding == "none") return;
    const InputEncoding encoding = parse_input_encoding(options.encoding);
    const std::string id = encoding.is_linear ? "linear" : encoding.id;
    const InputSpace& space = space_before(options, encoding);
    if (id == stated.encoding && space.id == stated.space) return;
    warn(fmt::format("{}: --input-encoding makes {} of {}, but the LUT expects {}, by its header",
                     options.file, id, space.title, stated.text));
}

}  // namespace

std::optional<std::string> stated_display(const LutOptions& options) {
    return read_stated_display(text_of_lut(options));
}

LutOptions with_stated_input(const LutOptions& options, const std::string& input) {
    const std::optional<StatedInput> stated = read_stated_input(text_of_lut(options));
    if (!options.encoding.empty()) {
        if (stated) warn_of_contradiction(options, *stated);
        return options;
    }
    if (!stated) {
        warn(fmt::format(
            "{}: the file does not say which encoding it expects, so colors are passed unchanged; "
            "many LUTs expect a log: --input-encoding acescct, logc3, ... (`tonewright verify "
            "--lut` "
            "finds it if the LUT is a known operator), or none",
            options.file));
        return options;
    }
    LutOptions found = options;
    found.encoding = stated->encoding;
    if (found.space.empty()) found.space = stated->space;
    if (!message_options().is_quiet) {
        print_message(fmt::format(
            "{}: the LUT expects {}, by its header; the input is {} (--input-encoding none "
            "passes colors unchanged)",
            options.file, stated->text, input));
    }
    return found;
}

Pipeline before_lut(const char* command, const LutOptions& options, const ViewOptions& view,
                    const SourceColor& input) {
    if (options.encoding.empty() || options.encoding == "none") {
        for (const char* name : {"--input", "--exposure", "--lut-space", "--resize"}) {
            if (view.given.contains(name)) {
                throw Error(
                    std::string(command) + ": " + name + " is given for " + options.file +
                    "; expected --input-encoding with it: without it, colors are passed unchanged");
            }
        }
        return {};
    }
    const InputEncoding encoding = parse_input_encoding(options.encoding);
    if (!(std::fabs(view.exposure) <= 64))
        throw Error("exposure is " + shortest(view.exposure) + "; expected [-64, 64] stops");
    const InputSpace& to = space_before(options, encoding);
    const SourceColor source = in_units(input, parse_input_units(view.input_units));
    Pipeline stages = exposed_stages(
        source.decode, scene_scale(source, view.reference_white) * std::exp2(view.exposure));
    stages.push_back(MatrixStage{rgb_to_rgb(source.primaries, to.primaries)});
    stages.push_back(curve_stage(encoding.encode));
    return stages;
}

void take_lut_options(const char* command, const LutOptions& options, ViewOptions& view,
                      LutOption lut_option) {
    for (const auto& [option, parameter, value] :
         {std::tuple("--input-encoding", "input", options.encoding),
          std::tuple("--lut-space", "space", options.space)}) {
        if (value.empty()) continue;
        if (!names_a_lut(view.op)) {
            throw Error(fmt::format("{}: {} is {}; expected a LUT as the operator{}", command,
                                    option, value,
                                    lut_option == LutOption::yes ? ", or --lut" : ""));
        }
        view.set.push_back(fmt::format("{}={}", parameter, value));
    }
}

void check_lut_options(const char* command, const LutOptions& options, const ViewOptions& view,
                       const SourceColor& input) {
    if (options.encoding.empty() && read_stated_input(text_of_lut(options))) return;
    (void)before_lut(command, options, view, input);
}

TONEWRIGHT_NAMESPACE_END
