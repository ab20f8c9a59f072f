// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <optional>

#include "base/input_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "cli/color_line.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "tasks/eval.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string engine = "reference";
    int digits = 9;
    bool inverse = false;
    bool explain = false;
    LutOptions lut;
};

/// Standard input as triplets, one a line, separated by commas or spaces; `#` begins a comment. It
/// answers the received lines before it reads more, so that a program can wait for each answer.
class LineEvaluator {
  public:
    LineEvaluator(ColorMap map, int digits) : map_(std::move(map)), digits_(digits) {}

    /// Runs until the end of standard input. Lines before a wrong line are answered.
    void run() {
        std::vector<char> block(std::size_t{1} << 20);
        std::string rest;  // an incomplete line
        while (const std::size_t count = read_some(block)) {
            std::string_view text(block.data(), count);
            for (std::size_t end = text.find('\n'); end != std::string_view::npos;
                 end = text.find('\n')) {
                take(rest.empty() ? text.substr(0, end) : rest.append(text.substr(0, end)));
                rest.clear();
                text.remove_prefix(end + 1);
            }
            rest += text;
            if (rest.size() > kLongestLine) take(rest);
            answer();
        }
        if (!rest.empty()) take(rest);
        answer();
    }

  private:
    static constexpr std::size_t kLongestLine = 1 << 16;

    /// Blocks until there is input.
    /// @returns  0 at the end
    static std::size_t read_some(std::vector<char>& block) {
        while (true) {
            const ssize_t count = ::read(STDIN_FILENO, block.data(), block.size());
            if (count >= 0) return static_cast<std::size_t>(count);
            if (errno != EINTR) throw FileError("read: standard input: " + reason_of(errno));
        }
    }

    void take(std::string_view line) {
        ++number_;
        try {
            if (line.size() > kLongestLine) {
                throw Error(fmt::format(
                    "eval: standard input: line {} has more than {} bytes; expected three numbers",
                    number_, kLongestLine));
            }
            if (const std::optional<Vector3> color = parse_color_line(line, number_))
                colors_.insert(colors_.end(), color->begin(), color->end());
        } catch (const Error&) {
            answer();
            throw;
        }
    }

    void answer() {
        const std::size_t count = colors_.size() / 3;
        if (count == 0) return;
        std::vector<double> shown(colors_.size());
        map_(colors_.data(), shown.data(), count);
        for (std::size_t i = 0; i < shown.size(); i += 3) {
            fmt::print("{:.{}g} {:.{}g} {:.{}g}\n", shown[i], digits_, shown[i + 1], digits_,
                       shown[i + 2], digits_);
        }
        if (std::fflush(stdout) != 0) throw FileError("write: standard output: cannot write");
        colors_.clear();
    }

    ColorMap map_;
    int digits_;
    std::size_t number_ = 0;
    std::vector<double> colors_;
};

ColorMap map_of_lut(const Options& options) {
    const SourceColor color = find_source_color(options.input);
    check_lut_options("eval", options.lut, options, color);
    LutFile lut = with_memory_for(options.lut.file, [&] {
        return open_lut(options.lut.file, options.lut.interpolation, lut_picture_reader());
    });
    return color_map(std::move(lut), before_lut("eval", with_stated_input(options.lut, color.name),
                                                options, color));
}

EvalRequest request_of(Options options) {
    if (options.op.empty()) {
        throw Error(
            "eval: OPERATOR is missing; expected an id from `tonewright list`, or --lut FILE");
    }
    EvalRequest request;
    // With --explain, it is not read.
    if (!options.explain) {
        request.engine = static_cast<EvalEngine>(
            find_choice("engine", options.engine, {"reference", "simd", "ocio", "ocio-gpu"}));
    }
    take_lut_options("eval", options.lut, options, LutOption::yes);
    const SourceColor color = find_source_color(options.input);
    if (options.inverse && !color.decode.empty()) {
        throw Error("eval: --input is " + color.name +
                    "; expected a scene-linear space with --inverse");
    }
    request.view = options.view(color);
    request.is_inverse = options.inverse;
    request.cache_folder = user_cache_folder();
    return request;
}

int run_eval(const Options& options) {
    if (options.explain) {
        fmt::print("{}", explain(request_of(options)));
        return kOk;
    }
    const bool is_lut = !options.lut.file.empty();
    LineEvaluator(is_lut ? map_of_lut(options) : color_map(request_of(options)), options.digits)
        .run();
    return kOk;
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): std::function owns its state

}  // namespace

void add_eval(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("eval", "Operators", "Tone map RGB triplets from standard input, one a line.");
    add_operator_argument(command, options->op);
    add_view_options(command, *options);
    command.describe("--input", "color space of the input (`tonewright list --inputs`)",
                     suggest_input_colors);
    command.title("Computation");
    command.add("--engine", "NAME", &options->engine,
                "`reference` (double precision), `simd`, `ocio` or `ocio-gpu` (floats)",
                {.suggest = one_of({"reference", "simd", "ocio", "ocio-gpu"})});
    command.add("--digits", "N", &options->digits, "significant digits of the output",
                {.range = {{1, 17}}});
    command.add_flag("--inverse", &options->inverse,
                     "map display colors to scene-linear, where the operator can be inverted");
    command.add_flag("--explain", &options->explain,
                     "print how the simd engine computes the operator, step by step, and stop");
    add_lut_options(command, options->lut,
                    {"operator", "--set", "--look", "--display", "--reference-white", "--engine",
                     "--inverse", "--explain"});
    command.footer(
        "A line is `r g b` or `r,g,b`. Values may be nan and inf; # begins a comment. Each line is "
        "answered when it arrives, so a program can keep eval running. Parameters that `apply` "
        "measures from the picture keep their defaults.\n"
        "Examples:\n"
        "  printf '0.18 0.18 0.18\\n4,2,0.5\\n' | tonewright eval agx_sobotka\n"
        "  echo 0.18 0.18 0.18 | tonewright eval --lut agx.cube --input-encoding acescct");
    command.action([options] { return run_eval(*options); }, &options->given);
}

TONEWRIGHT_NAMESPACE_END
