// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "cli/progress.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "shader_runs/shader_run.h"
#include "tasks/report.h"
#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options {
    std::string file;
    std::vector<std::string> pictures;
    std::vector<std::string> operators;
    ReportPictureOptions picture;
    bool no_parity = false;
};

std::vector<ResolvedOperator> operators_of(const Options& options) {
    const bool is_all = options.operators == std::vector<std::string>{"all"};
    if (is_all || options.operators.empty()) return report_operators(is_all);
    std::vector<ResolvedOperator> all;
    for (const std::string& text : options.operators)
        all.push_back(resolve_for_command(text));
    return all;
}

int run_report(const Options& options) {
    if (const std::string extension = extension_of(options.file);
        extension != ".html" && extension != ".htm") {
        throw Error("report: -o is " + printable(options.file) +
                    "; expected a name that ends in .html");
    }
    const ResultLine line;
    print_opencolorio_messages();
    const std::string page = [&] {
        Progress progress("report");
        ReportRequest request;
        request.operators = operators_of(options);  // names are checked first
        require_writable_file(options.file);
        request.pictures = options.pictures;
        request.read_picture = [&](const std::string& path,
                                   const std::vector<ResolvedOperator>& local_operators) {
            ReportPictureOptions wanted = options.picture;
            wanted.path = path;
            wanted.local_operators = local_operators;
            return picture_commands().read_report_picture(wanted);
        };
        request.has_parity = !options.no_parity;
        request.shader_runs = [] {
            VerifyOptions verify;
            add_shader_runs(verify, {"glsl-es"});
            return verify.shaders;
        };
        request.progress = progress.listener().progress;
        request.cache_folder = user_cache_folder();
        return make_report(request);
    }();
    write_text_atomically(options.file, page);
    line.print(
        fmt::format("report: {}: {:.1f} MB", options.file, static_cast<double>(page.size()) / 1e6));
    return kOk;
}

}  // namespace

void add_report(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("report", "Pictures", "Write an HTML page that shows operators on pictures.");
    command.argument(
        "pictures", &options->pictures,
        "pictures to embed, in any format that OpenImageIO reads (default: the chart)");
    command.title("Contents");
    command.add("-o", "FILE", &options->file, "HTML file to write", {.is_required = true});
    command.add(
        "--operators", "LIST", &options->operators,
        "operators, as for `compare`, or `all`, with presets and looks (default: all without "
        "them)",
        {.suggest = suggest_operators, .takes_one_each = true, .separator = ','});
    command.add("--width", "N", &options->picture.width,
                "largest width of an embedded picture in pixels", {.range = {{320, 8192}}});
    add_input_units(command, options->picture.light.units, options->picture.light.reference_white);
    command.title("Pictures");
    add_picture_choice(command, options->picture.choice);
    command.title("Contents");
    command.add_flag("--no-parity", &options->no_parity, "leave out the parity table");
    add_progress(command);
    command.footer(
        "The page is one file. It opens without a server and sends no data. It runs the exported "
        "GLSL ES on the embedded pictures, and on pictures that you drop on it.\n"
        "Examples:\n"
        "  tonewright report -o page.html\n"
        "  tonewright report -o page.html render.exr --operators agx_blender,hable");
    command.action([options] { return run_report(*options); });
}

TONEWRIGHT_NAMESPACE_END
