// SPDX-License-Identifier: Apache-2.0
#include "tonewright/verify.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

#include "cli/json.h"
#include "cli/lut_input.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "tonewright/lint.h"
#include "tonewright/lut_match.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options {
    VerifyOptions verify;
    std::string picture;
    std::string lut;
    bool json = false;
    bool quick = false;
    bool no_gpu = false;
};

const char* level_name(LintFinding::Level level) {
    if (level == LintFinding::Level::error) return "error";
    return level == LintFinding::Level::warning ? "warning" : "note";
}

void print_lint(const std::vector<LintFinding>& findings) {
    std::map<LintFinding::Level, std::size_t> count;
    for (const LintFinding& f : findings) {
        ++count[f.level];
        fmt::print("{}: {}: {}\n", level_name(f.level), f.where, f.what);
    }
    fmt::print("{} errors, {} warnings, {} notes\n\n", count[LintFinding::Level::error],
               count[LintFinding::Level::warning], count[LintFinding::Level::note]);
}

/// What a lookup table is. Nearer than a hundredth in the mean it is that operator; what is left is
/// between its nodes.
void print_matches(const std::string& path, const std::vector<LutMatch>& matches, bool as_json) {
    if (as_json) {
        Json all = Json::array();
        for (const LutMatch& m : matches) {
            all.push_back({{"operator", m.op},
                           {"input_encoding", m.encoding},
                           {"input", m.input},
                           {"display", m.display},
                           {"max", m.max},
                           {"p999", m.p999},
                           {"mean", m.mean}});
        }
        fmt::print("{}\n", all.dump(2));
        return;
    }
    constexpr double kSame = 1e-2;
    const LutMatch& best = matches.front();
    if (best.mean <= kSame) {
        fmt::print("{} is {} with {} input ({}) and {} output, max error {:.2g}\n\n", path, best.op,
                   best.encoding, best.input, best.display, best.max);
    } else {
        fmt::print("{} is none of these; the nearest:\n\n", path);
    }
    fmt::print("{:<32} {:<24} {:<16} {:<12} {:>8} {:>8} {:>8}\n", "operator", "input encoding",
               "input", "output", "max", "99.9 %", "mean");
    for (const LutMatch& m : matches) {
        fmt::print("{:<32} {:<24} {:<16} {:<12} {:>8.1e} {:>8.1e} {:>8.1e}\n", m.op, m.encoding,
                   m.input, m.display, m.max, m.p999, m.mean);
    }
}

int run_verify(Options& options) {
    int exit_code = kOk;
    VerifyOptions& verify_options = options.verify;
    if (!options.lut.empty()) {
        print_matches(options.lut,
                      match_lut(open_lut(options.lut, "auto",
                                         [](const std::string& path) {
                                             return picture_commands().read_lut(path);
                                         }),
                                verify_options.operators),
                      options.json);
        return kOk;
    }
    verify_options.with_gpu = !options.no_gpu;
    if (options.quick) verify_options.lattice_edge = 9;
    Json lint = Json::array();
    const bool is_of_config = !verify_options.config.empty() && verify_options.operators.empty();
    if (is_of_config) {
        const std::filesystem::path given(verify_options.config);
        const std::vector<LintFinding> findings =
            lint_config(std::filesystem::is_directory(given) ? given / "config.ocio" : given,
                        verify_options.with_gpu);
        if (!options.json) print_lint(findings);
        for (const LintFinding& f : findings) {
            if (f.level == LintFinding::Level::error) exit_code = kCheckFailed;
            lint.push_back({{"level", level_name(f.level)}, {"where", f.where}, {"what", f.what}});
        }
    }
    if (!options.picture.empty())
        verify_options.picture = picture_commands().read_pixels(options.picture);
    bool has_heading = false;  // not before the names have proved good
    const auto print = [&](const ParityRow& row) {
        if (options.json) return;
        if (!has_heading) fmt::print("{}", parity_heading());
        has_heading = true;
        fmt::print("{}", format_row(row));
        std::fflush(stdout);
    };
    const std::vector<ParityRow> rows = verify(verify_options, print);
    std::size_t failed = 0;
    for (const ParityRow& row : rows)
        failed += row.is_ok ? 0 : 1;
    if (options.json) {
        Json all = Json::array();
        for (const ParityRow& r : rows) {
            all.push_back({{"operator", r.op},
                           {"display", r.display},
                           {"form", r.form},
                           {"lowering", r.lowering},
                           {"max", r.max},
                           {"p999", r.p999},
                           {"mean", r.mean},
                           {"max_all", r.max_all},
                           {"max_beyond_rounding", r.max_beyond_rounding},
                           {"bound", r.bound},
                           {"mixed_metric", r.is_mixed_metric},
                           {"ok", r.is_ok},
                           {"note", r.note}});
        }
        // Rows alone, of operators; of a config, what the lint found, too.
        if (is_of_config) all = Json{{"lint", lint}, {"rows", all}};
        fmt::print("{}\n", all.dump(2));
    } else if (!rows.empty() || !is_of_config) {
        fmt::print("{} comparisons, {} beyond their bound\n", rows.size(), failed);
    }
    if (failed) exit_code = kCheckFailed;
    return exit_code;
}

}  // namespace

void add_verify(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("verify", "the parity table: every form against the double reference");
    command.add("operators", options->verify.operators,
                "or all, with their presets and looks, the default; of a config its "
                "views are the default");
    command
        .add("--display", options->verify.displays,
             "displays; repeat for more; default: srgb, of a config all")
        .one_value_each();
    command.add("--input", options->verify.input, "scene-linear space of the probes")
        .show_default();
    command.add("--config", options->verify.config,
                "a config to check, or its folder: any, ours or not; default: a fresh one");
    command.add("--picture", options->picture, "picture whose pixels join the probes");
    command.add_flag("--quick", options->quick,
                     "gamut lattices of 9 instead of 33 points a side (of a config 17)");
    command.add_flag("--no-gpu", options->no_gpu, "leave OCIO's GPU path out");
    command.add_flag("--json", options->json, "for programs");
    const Option lut = command.add(
        "--lut", options->lut,
        "a LUT, ours or not, of any format of `apply --lut`: which of the operators it is, "
        "with which input encoding, and how far from it; nothing is held to a bound");
    for (const char* other :
         {"--display", "--input", "--config", "--picture", "--quick", "--no-gpu"})
        lut.excludes(command.option(other));
    command.footer(
        "max, 99.9 % and mean: errors of display code values over probes >= 0; max all: negatives "
        "and mixed\n"
        "signs included. beyond f32: where an error is beyond the bound, how far it exceeds what "
        "float32\n"
        "rounding before a cancelling matrix has to cost. Exit code 1 when a bound is exceeded.\n"
        "Examples:\n  tonewright verify hable --display display_p3\n"
        "  tonewright verify --lut somebodys_agx.cube agx_sobotka agx_blender");
    command.action([options] { return run_verify(*options); });
}

TONEWRIGHT_NAMESPACE_END
