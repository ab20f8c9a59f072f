// SPDX-License-Identifier: Apache-2.0
#include "cli/rows/apply_rows.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/command.h"
#include "cli/lut_input.h"
#include "cli/progress.h"
#include "cli/rows/apply_request.h"
#include "cli/rows/picture_messages.h"
#include "picture/exr_reader.h"
#include "picture/file_writer.h"
#include "picture/row_tonemapper.h"
#include "picture/tonemap_to_file.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// One picture, and no option that the picture commands have to do.
bool is_plain(const ApplyOptions& options) {
    for (const char* name :
         {"--frames", "--format", "--legend", "--resize", "--auto-exposure", "--meter-frames",
          "--meter-cache", "--lut", "--timeout", "--verify-output"}) {
        if (options.given.contains(name)) return false;
    }
    const std::size_t words = options.given.contains("--output") ? 1 : 2;
    return options.pictures.size() == words && !options.has_legend &&
           !is_same_name(options.statistics, "sequence") &&
           !(options.given.contains("--operator") && trimmed(options.op).empty());
}

/// The value of OpenImageIO's attribute `threads`.
int thread_count(int wanted) {
    if (wanted == 0) {
        const char* named = std::getenv("OPENIMAGEIO_THREADS");
        if (!named) named = std::getenv("CUE_THREADS");  // of OpenCue
        if (named) wanted = static_cast<int>(std::strtol(named, nullptr, 10));
    }
    const auto all = static_cast<int>(std::thread::hardware_concurrency());
    return wanted > 0 ? wanted : std::max(all, 1);
}

}  // namespace

bool apply_rows(const ApplyOptions& given) {
    if (!is_plain(given)) return false;
    ApplyOptions options = given;
    const std::string& in = options.pictures.front();
    const std::string& out =
        options.given.contains("--output") ? options.output : options.pictures.back();
    // Streams, folders, shots, and a picture that replaces itself.
    std::error_code error;
    if (in == "-" || out == "-" || !std::filesystem::is_regular_file(in, error) ||
        std::filesystem::equivalent(in, out, error))
        return false;
    try {
        // Before the operator, whose file the other module would read again.
        (void)own_writers().format_of(out);
        const int threads = thread_count(options.picture.threads);
        std::unique_ptr<RowReader> rows = open_exr(in, static_cast<unsigned>(threads));
        if (!rows) return false;
        take_lut_options("apply", options.lut, options, LutOption::yes);
        const WriteOptions asked = write_options_of(options);
        WriteOptions write = asked;
        ReadOptions read = read_options_of(options.picture);
        TonemapOptions tonemap = tonemap_options_of(options, asked);
        std::string op = options.is_false_color ? "false_color" : options.op;
        if (op.empty()) op = std::string(kDefaultOperator);
        tonemap.op =
            resolve_picture_operator(op, options.settings(), options.look, operator_files());
        // An error then, in the words of the other module.
        if (message_options().is_strict && !tonemap.op.caution().empty()) return false;
        const RowTonemapper tonemapper(tonemap);
        remove_leftovers({out});
        PictureMessages messages(in, out);
        messages.attach_to(read);
        messages.attach_to(write);
        std::optional<PictureSpec> header;
        const ResultLine result;
        {
            const QuietStderr quiet;
            Progress progress("apply", {.terminal = quiet.before()});
            write.progress = progress.listener().progress;
            if (!tonemap_own_file(
                    tonemapper, std::move(rows), in, out, write, read,
                    [&](const PictureSpec& spec) { header = spec; }, threads))
                return false;
        }
        tell_of_operator(op, tonemapper.options().op);
        messages.print();
        tell_default_operator(options);
        print_result({.in = in, .out = out, .source = *std::move(header), .threads = threads},
                     tonemapper.options(), options, result);
        return true;
    } catch (const std::exception&) {
        return false;  // the other module does it, or has the same reason
    }
}

TONEWRIGHT_NAMESPACE_END
