// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "cli/lut_input.h"
#include "cli/messages.h"
#include "cli/plot.h"
#include "cli/shared_options.h"
#include "measure/laws.h"
#include "plot/gray_curve.h"
#include "plot/terminal_plot.h"
#include "tasks/json_forms.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string file;
    LutOptions lut;
    bool json = false;
    bool is_ascii = false;
};

using Verdict = LawResult::Verdict;

void print_text(const View& view, const Options& options, const std::vector<LawResult>& results) {
    std::vector<double> places;
    for (const LawResult& r : results) {
        if (r.verdict == Verdict::breaks && r.x) places.push_back(*r.x);
    }
    if (!message_options().is_quiet) {
        fmt::print("{}\n\n", operator_text(view.op));
        const auto curve = [&](const std::vector<double>& x) { return gray_codes(view, x); };
        fmt::print("{}\n", terminal_plot(curve, places,
                                         options.is_ascii ? TerminalText::ascii : terminal_text()));
    }
    for (const LawResult& r : results) {
        fmt::print("{:<11} {}{}\n", r.law, to_string(r.verdict),
                   r.text.empty() ? "" : ": " + r.text);
    }
}

int run_check(const Options& options) {
    const View view = options.view();
    const std::vector<LawResult> results = check_laws(view.op);
    if (options.json) {
        const Json object = {{"operator", operator_text(view.op)}, {"laws", all_to_json(results)}};
        fmt::print("{}\n", object.dump(2));
    } else {
        print_text(view, options, results);
    }
    std::fflush(stdout);  // before the warnings, if both go to a terminal
    if (!options.file.empty()) {
        const ResultLine line;
        PlotOptions plot;
        static_cast<ViewOptions&>(plot) = options;
        plot.operators = {options.op};
        plot.file = options.file;
        const std::string title = write_plot(plot);
        line.print(fmt::format("check: {}: {}", options.file, title));
    }
    // --strict ends at the first; the report has all.
    for (const LawResult& r : results) {
        if (r.verdict == Verdict::breaks)
            warn(fmt::format("check: {}: {}: {}", operator_text(view.op), r.law, r.text));
    }
    return kOk;
}

}  // namespace

void add_check(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("check", "Checks", "Check an operator against the laws of tone curves.");
    add_operator_argument(command, options->op, true);
    add_operator_options(command, *options);
    command.title("LUT as the operator");
    add_lut_input_options(command, options->lut);
    command.title("Output");
    command.add("-o", "FILE", &options->file,
                "write the tone curve, too: .svg, .pdf, or a picture such as .png");
    command.add_flag("--ascii", &options->is_ascii,
                     "draw with ASCII characters (default: where the locale is not UTF-8)");
    command.add_flag("--json", &options->json, "print JSON");
    command.footer(
        "The laws: numbers are finite; brighter scenes are shown brighter; grays stay below the "
        "output peak, reach white, begin at black and stay gray; there are no jumps; the round "
        "trip through the inverse is exact. A broken law is a warning, unless the operator "
        "declares it. With --strict, a warning gives exit code 1.\n"
        "Examples:\n"
        "  tonewright check my.tone\n"
        "  tonewright check hable:white=4 -o hable.svg");
    command.action([options] {
        take_lut_options("check", options->lut, *options, LutOption::no);
        return run_check(*options);
    });
}

TONEWRIGHT_NAMESPACE_END
