// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "base/strings.h"
#include "cli/lut_input.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "cli/progress.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "shader_runs/shader_run.h"
#include "tasks/json.h"
#include "tasks/json_forms.h"
#include "tasks/verify.h"
#include "tonewright/lint.h"
#include "tonewright/lut_match.h"
#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options {
    VerifyRequest request;
    std::vector<std::string> operators;
    std::vector<std::string> shaders;
    std::string picture;
    std::string lut;
    bool json = false;
    bool summary = false;
    bool no_gpu = false;
};

void print_lint(const std::vector<LintFinding>& findings) {
    std::map<LintFinding::Level, std::size_t> count;
    for (const LintFinding& f : findings) {
        ++count[f.level];
        fmt::print("{}: {}: {}\n", level_name(f.level), f.where, f.what);
    }
    fmt::print("{} errors, {} warnings, {} notes\n\n", count[LintFinding::Level::error],
               count[LintFinding::Level::warning], count[LintFinding::Level::note]);
}

/// Prints the operator of a LUT, and the operators that are near it.
void print_matches(const std::string& path, const std::vector<LutMatch>& matches, bool as_json) {
    if (as_json) {
        fmt::print("{}\n", all_to_json(matches).dump(2));
        return;
    }
    const LutMatch& best = matches.front();
    const Operator& op = *best.definition;
    if (!is_same(best)) {
        fmt::print("{} is none of these; the nearest:\n\n", one_line(path));
    } else if (op.is_defect()) {
        fmt::print(
            "{} is {} as {} has it, a defect: {}. It has {} input ({}) and {} output, max error "
            "{:.2g}\n\n",
            one_line(path), op.meant, op.source, op.defect, best.encoding, best.input, best.display,
            best.max);
    } else {
        fmt::print("{} is {} with {} input ({}) and {} output, max error {:.2g}\n\n",
                   one_line(path), best.op, best.encoding, best.input, best.display, best.max);
    }
    fmt::print("{:<32} {:<24} {:<16} {:<12} {:>8} {:>8} {:>8}\n", "operator", "input encoding",
               "input", "output", "max", "99.9 %", "mean");
    for (const LutMatch& m : matches) {
        fmt::print("{:<32} {:<24} {:<16} {:<12} {:>8.1e} {:>8.1e} {:>8.1e}\n", m.op, m.encoding,
                   m.input, m.display, m.max, m.p999, m.mean);
    }
}

/// 8-bit codes, two digits.
std::string codes_text(double error) {
    const double codes = 255 * error;
    return codes < 1e-4 ? "<0.0001" : fmt::format("{:.2g}", codes);
}

/// One line for each operator and display: the engine as it runs on this processor, and OpenColorIO
/// as applications use it.
void print_summary(const std::vector<ParityRow>& rows) {
    fmt::print(
        "Errors of encoded values against the double-precision reference\n\n"
        "{0:<25}in 8-bit codes (1 is one step of an 8-bit picture)    largest, from 0 to 1\n"
        "{0:<25}{1:<18}{2:<18}{3:<18}\n"
        "{4:<25}{5:<9}{6:<9}{5:<9}{6:<9}{5:<9}{6:<9}{7:>9}{8:>9}{9:>9}\n",
        "", "our engine", "OpenColorIO CPU", "OpenColorIO GPU", "operator", "largest", "typical",
        "engine", "CPU", "GPU");
    std::string notes;
    for (auto first = rows.begin(), last = first; first != rows.end(); first = last) {
        last = std::find_if(first, rows.end(), [&](const ParityRow& r) {
            return r.op != first->op || r.display != first->display;
        });
        std::string codes;
        std::string values;
        for (const char* backend : {"simd", "ocio cpu default", "ocio gpu"}) {
            const auto row = std::find_if(
                first, last, [&](const ParityRow& r) { return r.backend.starts_with(backend); });
            if (row == last || row->bound == 0) {
                codes += fmt::format("{:<18}", "-");
                values += fmt::format("{:>9}", "-");
                if (row != last) notes = row->backend + ": " + row->note + "\n";
                continue;
            }
            codes += fmt::format("{:<9}{:<9}", codes_text(row->max), codes_text(row->mean));
            values += fmt::format("{:>9.1e}", row->max);
        }
        fmt::print("{:<24} {}{}\n", first->op, codes, values);
    }
    for (const ParityRow& row : rows) {
        if (!row.is_ok) notes += format_row(row);
    }
    fmt::print("{}", notes);
}

void print_json(const VerifyResult& result, const std::vector<NotExecuted>& not_executed) {
    Json object;
    if (result.lint) object.add("lint", all_to_json(*result.lint));
    object.add("rows", all_to_json(result.rows));
    Json without_run = Json::array();
    for (const NotExecuted& n : not_executed)
        without_run.push_back({{"name", n.name}, {"reason", n.reason}});
    object.add("not_executed", without_run);
    fmt::print("{}\n", object.dump(2));
}

int run_verify(Options& options) {
    VerifyOptions& verify_options = options.request.options;
    if (!options.lut.empty()) {
        print_matches(options.lut,
                      match_lut(open_lut(options.lut, "auto", lut_picture_reader()),
                                resolve_operators(options.operators)),
                      options.json);
        return kOk;
    }
    verify_options.operators = resolve_operators(options.operators, operator_files());
    for (const ResolvedOperator& op : verify_options.operators) {
        if (!op.op->file.empty()) warn_of(op);
    }
    verify_options.with_gpu = !options.no_gpu;
    verify_options.cache_folder = user_cache_folder();
    options.request.has_lint = true;
    print_opencolorio_messages();
    if (!options.picture.empty())
        verify_options.picture = picture_commands().read_pixels(options.picture);
    const bool is_table = !options.json && !options.summary;
    // Rows on the terminal show the progress.
    const int terminal = is_table && ::isatty(STDOUT_FILENO) != 0 ? -1 : STDERR_FILENO;
    std::optional<Progress> line(std::in_place, "verify",
                                 ProgressFacts{.unit = "views", .terminal = terminal});
    verify_options.progress = line->listener().progress;
    const std::vector<NotExecuted> not_executed = add_shader_runs(verify_options, options.shaders);
    bool has_heading = false;  // only after the names have been checked
    VerifyListener listener;
    listener.on_lint = [&](const std::vector<LintFinding>& findings) {
        if (options.json) return;
        line->print_over([&] { print_lint(findings); });
    };
    listener.on_row = [&](const ParityRow& row) {
        if (!is_table) return;
        if (!has_heading) fmt::print("{}", parity_heading());
        has_heading = true;
        fmt::print("{}", format_row(row));
        std::fflush(stdout);
    };
    const VerifyResult result = verify(options.request, listener);
    line.reset();
    if (options.summary) print_summary(result.rows);
    if (options.json) {
        print_json(result, not_executed);
    } else if (!result.rows.empty() || !result.lint) {
        fmt::print("{} comparisons, {} beyond their bound\n", result.rows.size(), result.failed);
        if (!not_executed.empty() && !options.summary)
            fmt::print("{}", format_not_executed(not_executed));
    }
    return result.is_ok ? kOk : kCheckFailed;
}

}  // namespace

void add_verify(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command = program.add(
        "verify", "Checks",
        "Compare every backend with the double-precision reference and print the errors.");
    command.argument(
        "operators", &options->operators,
        "operators (default: all with their presets and looks, or the views of the config)",
        {.suggest = suggest_operators});
    command.title("What to verify");
    command.add("--config", "CONFIG", &options->request.options.config,
                "config file or its folder, also one of other software (default: a new config)");
    command.add("--lut", "FILE", &options->lut,
                "LUT file: find the operator and the input encoding that made it, and the error");
    command.add("--display", "NAME", &options->request.options.displays,
                "display; repeat for more (default: srgb, or all displays of the config)",
                {.suggest = suggest_config_displays, .takes_one_each = true});
    command.add("--input", "SPACE", &options->request.options.input,
                "scene-linear color space of the samples", {.suggest = suggest_spaces});
    command.title("Measurement");
    command.add("--picture", "FILE", &options->picture,
                "add the pixels of this picture to the samples");
    command.add_flag("--quick", &options->request.is_quick,
                     "use smaller sample sets: 9 grid points a side, 10,000 random colors");
    command.add_flag("--best-target", &options->request.options.only_best_target,
                     "measure only the fastest instruction set of this machine");
    command.add_flag("--no-gpu", &options->no_gpu, "leave out OpenColorIO's GPU path and shaders");
    command.add(
        "--shaders", "LIST", &options->shaders,
        "run shaders in these languages: glsl, glsl-es, wgsl, hlsl, dctl, c, or none (default: "
        "all that this machine can run)",
        {.suggest = one_of({"glsl", "glsl-es", "wgsl", "hlsl", "dctl", "c", "none"}),
         .takes_one_each = true,
         .separator = ','});
    command.title("Output");
    command.add_flag("--summary", &options->summary, "print one line for each operator");
    command.add_flag("--json", &options->json, "print JSON");
    add_progress(command);
    command.exclude("--progress", {"--json"});
    command.exclude("--lut", {"--display", "--input", "--config", "--picture", "--quick",
                              "--summary", "--best-target", "--no-gpu", "--shaders"});
    command.footer(
        "The columns max, 99.9 % and mean are errors of code values over samples >= 0; max all "
        "includes negative values. Beyond f32: how far an error above its bound exceeds float32 "
        "rounding. The exit code is 1 when an error exceeds its bound.\n"
        "Examples:\n"
        "  tonewright verify hable --display display_p3\n"
        "  tonewright verify --lut unknown.cube agx_sobotka agx_blender");
    command.action([options] { return run_verify(*options); });
}

TONEWRIGHT_NAMESPACE_END
