// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>

#include "base/input_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "cli/color_line.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "verify/backends.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string engine = "reference";
    int digits = 9;
    bool inverse = false;
    bool explain = false;
    LutOptions lut;
};

/// Maps triplets.
using ColorMap = std::function<void(const double* in, double* out, std::size_t count)>;

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
                    "eval: standard input: line {} has more than {} bytes; expected three "
                    "numbers",
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

/// For an engine that takes floats.
ColorMap through_floats(ColorRun run) {
    return [run = std::move(run)](const double* in, double* out, std::size_t count) {
        const std::vector<float> from(in, in + 3 * count);
        std::vector<float> to(from.size());
        run(from.data(), to.data(), count);
        std::copy(to.begin(), to.end(), out);
    };
}

ColorMap map_of_lut(const Options& options) {
    const SourceColor color = find_source_color(options.input);
    check_lut_options("eval", options.lut, options, color);
    const auto lut = with_memory_for(options.lut.file, [&] {
        return std::make_shared<const LutFile>(
            open_lut(options.lut.file, options.lut.interpolation, lut_picture_reader()));
    });
    const Pipeline before =
        before_lut("eval", with_stated_input(options.lut, color.name), options, color);
    const auto encode = before.empty() ? nullptr : std::make_shared<const ReferenceEngine>(before);
    return through_floats([lut, encode](const float* in, float* out, std::size_t count) {
        if (!encode) {
            lut->run_rgb(in, out, count);
            return;
        }
        std::vector<double> encoded(3 * count);
        encode->run_rgb(in, encoded.data(), count);
        const std::vector<float> code(encoded.begin(), encoded.end());
        lut->run_rgb(code.data(), out, count);
    });
}

View view_of(const Options& options) {
    const SourceColor color = find_source_color(options.input);
    if (options.inverse && !color.decode.empty()) {
        throw Error("eval: --input is " + color.name +
                    "; expected a scene-linear space with --inverse");
    }
    return options.view(color);
}

Pipeline pipeline_of(const Options& options, const View& view) {
    return options.inverse ? build_inverse_view(view) : build_view(view);
}

void check_has_operator(const Options& options) {
    if (options.op.empty()) {
        throw Error(
            "eval: OPERATOR is missing; expected an id from `tonewright list`, or --lut FILE");
    }
}

ColorMap map_of_operator(const Options& given) {
    Options options = given;
    check_has_operator(options);
    const std::size_t kind =
        find_choice("engine", options.engine, {"reference", "simd", "ocio", "ocio-gpu"});
    take_lut_options("eval", options.lut, options, LutOption::yes);
    const View view = view_of(options);
    const Pipeline pipeline = pipeline_of(options, view);
    if (kind == 0) {
        const auto engine = std::make_shared<const ReferenceEngine>(pipeline);
        return [engine](const double* in, double* out, std::size_t count) {
            std::array<std::vector<double>, 3> plane;
            for (std::size_t i = 0; i < 3 * count; ++i)
                plane[i % 3].push_back(in[i]);
            const std::array<double*, 3> p = {plane[0].data(), plane[1].data(), plane[2].data()};
            engine->run({p[0], p[1], p[2]}, p, count);
            for (std::size_t i = 0; i < 3 * count; ++i)
                out[i] = plane[i % 3][i / 3];
        };
    }
    constexpr std::array kBackends = {Backend::Id::simd, Backend::Id::ocio_cpu,
                                      Backend::Id::ocio_gpu};
    return through_floats(
        find_backend(kBackends.at(kind - 1)).start({view, pipeline, nullptr, user_cache_folder()}));
}

int run_explain(Options options) {
    check_has_operator(options);
    take_lut_options("eval", options.lut, options, LutOption::yes);
    const View view = view_of(options);
    const Pipeline pipeline = pipeline_of(options, view);
    fmt::print("{}", explain(pipeline, {}, view.op.op->bounds.simd_goal));
    return kOk;
}

int run_eval(const Options& options) {
    if (options.explain) return run_explain(options);
    const ColorMap map = options.lut.file.empty() ? map_of_operator(options) : map_of_lut(options);
    LineEvaluator(map, options.digits).run();
    return kOk;
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): std::function owns its state

}  // namespace

void add_eval(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("eval", "Operators", "Tone map RGB triplets from standard input, one a line.");
    command.argument("operator", &options->op,
                     "operator, operator:preset, .tone file, LUT or formula",
                     {.suggest = suggest_operators});
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
