// SPDX-License-Identifier: Apache-2.0
#include "tasks/bake.h"

#include <fmt/format.h>

#include <utility>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "lut/lut_warnings.h"
#include "ocio/lut_chain.h"
#include "pipeline/stand_ins.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// @throws Error  a file type that cannot store the numbers exactly: lossy, or of other depths
void require_lut_picture(const std::string& path, int bits) {
    const std::string extension = extension_of(path);
    const bool is_tiff = extension == ".tif" || extension == ".tiff";
    const bool is_held = is_tiff || (bits == 32 ? extension == ".exr" : extension == ".png");
    if (!is_held) {
        throw Error(Problem{
            .value = fmt::format("file is {}", path),
            .expected = fmt::format("{} or .tif for {} bits", bits == 32 ? ".exr" : ".png", bits)});
    }
}

/// Replaces a word, if the text has it.
std::string with_word(std::string text, std::string_view word, std::string_view by) {
    if (const std::size_t at = text.find(word); at != std::string::npos)
        text.replace(at, word.size(), by);
    return text;
}

/// The application's instructions for this file. Names with characters that mean something in a
/// shell or in a filter of ffmpeg stay FILE.
std::string steps_for(const LutApplication& host, const LutRequest& request,
                      const std::string& file) {
    constexpr std::string_view kPlain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-/";
    const std::string& steps =
        request.encoding.is_linear ? lut_steps_of(host, request.format) : host.steps;
    const bool is_plain = file.find_first_not_of(kPlain) == std::string::npos;
    return with_word(with_word(steps, "the file's primaries",
                               find_input_space(request.view.input).primaries.name),
                     "FILE", is_plain ? file : "FILE");
}

std::vector<std::string> all_steps(const LutApplication& host, const LutRequest& request,
                                   const std::string& file) {
    std::vector<std::string> lines;
    if (request.view.display != host.display && !takes_any_display(host)) {
        lines.push_back(fmt::format("{}: these steps are for the display {}; the file is for {}",
                                    host.title, host.display, request.view.display));
    }
    const bool has_its_encoding = request.encoding.id == parse_input_encoding(host.encoding).id;
    if (has_usual_input(host, request) || (host.takes_any_primaries && has_its_encoding)) {
        lines.push_back(fmt::format("{}: {}", host.title, steps_for(host, request, file)));
        return lines;
    }
    const std::string input =
        "scene-linear " + with_word(find_input_space(request.view.input).title, "Linear ", "");
    lines.push_back(fmt::format(
        "{}: convert {} before this file, which does not take the "
        "application's usual input",
        host.title,
        request.encoding.is_linear ? "to " + input : input + " to " + request.encoding.title));
    return lines;
}

void bake_chain(const BakeRequest& given, BakeResult& result) {
    LutChain chain = make_lut_chain(result.request, given.nodes, given.cache_folder);
    const PhotographError& photographs = chain.error.photographs;
    if (given.max_error && photographs.p999 > *given.max_error) {
        throw Error({.parameter = "max_error",
                     .value = shortest(*given.max_error),
                     .expected = fmt::format("at least {}, which {} has on photographs",
                                             rounded_up(photographs.p999), chain.operations)});
    }
    write_text_atomically(given.file, chain.contents);
    result.operations = std::move(chain.operations);
    result.baked.error = std::move(chain.error);
}

void bake_grid(const BakeRequest& given, BakeResult& result, const Listener& listener) {
    LutRequest& request = result.request;
    const LutApplication* const host = given.application;
    constexpr int kLargest = 129;
    const bool is_for_host = host && request.format == host->format;
    BakedLut& baked = result.baked;
    baked = bake_lut(request, given.nodes, interpolation_of(host), given.max_error,
                     is_for_host ? host->largest_size : kLargest);
    request.size = baked.lut.size;
    // The application's own input: nothing of it can be changed.
    listener.warn_of(lut_warning(given.file, request, baked,
                                 host && has_usual_input(*host, request) ? host : nullptr));
    if (is_picture_format(request.format)) {
        given.write_picture(baked.lut, request.format, given.file, request.bits.value_or(16));
    } else {
        write_text_atomically(given.file, write_lut(baked, request));
    }
    result.clipping = measure_clipping(request, baked.lut);
}

}  // namespace

LutNodes parse_lut_nodes(std::string_view text) {
    return static_cast<LutNodes>(
        find_choice("nodes", text, {"auto", "sampled", "fitted", "smooth"}));
}

LutRequest lut_request_of(const BakeRequest& given, LutFormat format) {
    const LutApplication* const host = given.application;
    LutRequest request;
    request.format = format;
    request.encoding = given.encoding
                           ? *given.encoding
                           : parse_input_encoding(host ? lut_encoding_of(*host, format)
                                                       : std::string(kDefaultLutEncoding));
    const bool has_own_encoding = host && !given.encoding;
    const bool is_chain = has_own_encoding && reads_chains(*host, format);
    const InputSpace& input = given.input ? *given.input
                                          : find_input_space(has_own_encoding && !is_chain
                                                                 ? lut_input_of(*host, *given.op.op)
                                                                 : request.encoding.default_input);
    request.view = make_view(
        given.op, in_units({input.id, input.primaries}, given.input_units), given.exposure_stops,
        given.display.value_or(host ? host->display : "srgb"), given.reference_white);
    request.dimension = given.dimension;
    request.size = given.size;
    request.bits = given.depth;
    request.decimals = given.decimals;
    if (given.icc_version && format != LutFormat::icc) {
        throw Error(
            Problem{.value = fmt::format("<<icc_version>> is given for {}", name_of(format)),
                    .expected = "format icc with it"});
    }
    if (given.icc_version && *given.icc_version != 2 && *given.icc_version != 4) {
        throw Error({.parameter = "icc_version",
                     .value = fmt::to_string(*given.icc_version),
                     .expected = "2 or 4"});
    }
    request.icc_version = given.icc_version.value_or(request.icc_version);
    if (!host || is_chain) return request;  // a chain has sizes of its own
    const bool is_table =
        given.dimension == LutDimension::one ||
        (given.dimension == LutDimension::automatic && is_table_for(*host, request.view));
    // A size counts the entries of a 1D table.
    if (given.size && !is_table && format == host->format) check_lut_size(*host, *given.size);
    if (given.format) return request;
    if (given.max_error && is_strip(host->format)) {
        throw Error(Problem{.value = fmt::format("<<max_error>> is given for {}", host->id),
                            .expected = fmt::format("none, because its size is {}", host->size)});
    }
    if (!given.depth) request.bits = host->bits;
    if (is_table) return request;
    if (!given.size && !given.max_error) request.size = host->size;
    request.dimension = LutDimension::three;
    return request;
}

BakeResult bake(const BakeRequest& request, const Listener& listener) {
    // Reports the error before minutes of work, and before the check of the name.
    require_writable_file(request.file);
    BakeResult result;
    const LutApplication* const host = request.application;
    LutRequest& lut = result.request;
    lut = lut_request_of(request, lut_format_of_file(request.file, request.format, host));
    if (is_picture_format(lut.format)) require_lut_picture(request.file, lut.bits.value_or(16));
    listener.warn_of(stand_in_warning(lut.view.op, "LUT"));
    with_memory_for(request.file, [&] {
        if (is_lut_chain(lut)) {
            bake_chain(request, result);
        } else {
            bake_grid(request, result, listener);
        }
    });
    if (host) result.steps = all_steps(*host, lut, request.file);
    return result;
}

TONEWRIGHT_NAMESPACE_END
