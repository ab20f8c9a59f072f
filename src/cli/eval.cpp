// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <iostream>
#include <iterator>
#include <memory>

#include "base/strings.h"
#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "ocio/gpu.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    std::string engine = "reference";
    int digits = 9;
    bool inverse = false;
    LutOptions lut;
};

/// Triplets of numbers, one a line; comma or space between; `#` begins a comment.
std::vector<double> parse_triplets(std::string_view text) {
    std::vector<double> values;
    std::size_t line_number = 0;
    while (!text.empty()) {
        ++line_number;
        const std::size_t end = text.find('\n');
        const std::string_view whole = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);

        std::string_view line = whole.substr(0, whole.find('#'));
        std::size_t count = 0;
        bool is_bad = false;
        const auto skip = [&](std::string_view what) {
            line.remove_prefix(std::min(line.find_first_not_of(what), line.size()));
        };
        skip(" \t\r");
        while (!line.empty() && !is_bad) {
            double value = 0;
            if (line.front() == '+' && line.size() > 1 && line[1] != '-') {
                line.remove_prefix(1);  // from_chars takes no plus sign
            }
            const auto result = std::from_chars(line.data(), line.data() + line.size(), value);
            // A number too large for double is infinite, and too small is 0: what printf-ed data
            // means.
            if (result.ec == std::errc::result_out_of_range) {
                value = std::strtod(std::string(line.data(), result.ptr).c_str(), nullptr);
            } else if (result.ec != std::errc()) {
                is_bad = true;
                break;
            }
            values.push_back(value);
            ++count;
            line.remove_prefix(static_cast<std::size_t>(result.ptr - line.data()));
            const std::size_t before = line.size();
            skip(" \t\r");
            if (!line.empty() && line.front() == ',') {
                line.remove_prefix(1);
                skip(" \t\r");
                if (line.empty()) is_bad = true;  // "1,2,"
            } else if (!line.empty() && line.size() == before) {
                is_bad = true;  // "1x"
            }
        }
        if (is_bad || (count != 0 && count != 3)) {
            std::string shown(whole.substr(0, 60));
            if (!shown.empty() && shown.back() == '\r') shown.pop_back();
            throw Error(
                fmt::format("eval: line {} is \"{}\"; expected three numbers", line_number, shown));
        }
    }
    return values;
}

void print(double r, double g, double b, int digits) {
    fmt::print("{:.{}g} {:.{}g} {:.{}g}\n", r, digits, g, digits, b, digits);
}

/// Standard input as triplets.
std::vector<double> read_triplets() {
    std::cin.sync_with_stdio(false);
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    return parse_triplets(text);
}

void eval_lut(const LutFile& lut, const Pipeline& before, int digits) {
    const std::vector<double> values = read_triplets();
    const std::size_t count = values.size() / 3;
    std::vector<float> code(values.begin(), values.end());
    if (!before.empty()) {
        std::vector<double> encoded(values.size());
        ReferenceEngine(before).run_rgb(code.data(), encoded.data(), count);
        code.assign(encoded.begin(), encoded.end());
    }
    std::vector<float> shown(code.size());
    lut.run_rgb(code.data(), shown.data(), count);
    for (std::size_t i = 0; i < shown.size(); i += 3) {
        print(static_cast<double>(shown[i]), static_cast<double>(shown[i + 1]),
              static_cast<double>(shown[i + 2]), digits);
    }
}

int run_eval(const Options& options) {
    if (!options.lut.file.empty()) {
        const InputSpace& input = find_input_space(options.input);
        const Pipeline before =
            before_lut("eval", options.lut, options, {input.id, input.primaries});
        eval_lut(
            open_lut(options.lut.file, options.lut.interpolation,
                     [](const std::string& path) { return picture_commands().read_lut(path); }),
            before, options.digits);
        return kOk;
    }
    if (options.op.empty()) {
        throw Error(
            "eval: operator is missing; expected an id of `tonewright list`, or --lut FILE");
    }
    const std::vector<std::string> engines = {"reference", "simd", "ocio", "ocio-gpu"};
    if (std::find(engines.begin(), engines.end(), options.engine) == engines.end()) {
        throw Error("eval: engine is " + options.engine + "; expected " + join_choices(engines) +
                    did_you_mean(options.engine, engines));
    }
    const View view = options.view();
    if (options.inverse && !view.op.op->build_inverse) {
        throw Error(view.op.op->id + " has no inverse; expected " +
                    join_choices(invertible_operators()));
    }
    const Pipeline pipeline = options.inverse ? build_inverse_view(view) : build_view(view);
    const std::vector<double> values = read_triplets();
    const std::size_t count = values.size() / 3;
    if (options.engine == "reference") {
        const ReferenceEngine engine(pipeline);
        std::array<std::vector<double>, 3> plane;
        for (std::size_t i = 0; i < values.size(); ++i)
            plane[i % 3].push_back(values[i]);
        const std::array<double*, 3> p = {plane[0].data(), plane[1].data(), plane[2].data()};
        engine.run({p[0], p[1], p[2]}, p, count);
        for (std::size_t i = 0; i < count; ++i)
            print(p[0][i], p[1][i], p[2][i], options.digits);
        return kOk;
    }
    const std::vector<float> in(values.begin(), values.end());
    std::vector<float> out(in.size());
    if (options.engine == "simd") {
        SimdEngine(pipeline, view.op.op->bounds.simd_goal).run_rgb(in.data(), out.data(), count);
    } else {
        const LowerOptions lowering{.fits_cubes = lower_options(*view.op.op).fits_cubes};
        const auto processor = make_processor(lower_to_ocio(pipeline, lowering).ops);
        if (options.engine == "ocio") {
            OcioCpu(processor).run_rgb(in.data(), out.data(), count);
        } else {
            OcioGpu(processor).run_rgb(in.data(), out.data(), count);
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        print(static_cast<double>(out[3 * i]), static_cast<double>(out[3 * i + 1]),
              static_cast<double>(out[3 * i + 2]), options.digits);
    }
    return kOk;
}

}  // namespace

void add_eval(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command = program.add("eval", "RGB triplets on stdin -> RGB triplets on stdout");
    const Option op = command.add("operator", options->op, "operator, or operator:preset");
    add_view_options(command, *options);
    command.add("--engine", options->engine, "reference (double), simd, ocio or ocio-gpu")
        .show_default();
    command.add("--digits", options->digits, "significant digits of the output")
        .show_default()
        .range(1, 17);
    command.add_flag("--inverse", options->inverse,
                     "from what the display shows back to scene-linear; for operators that have an "
                     "inverse");
    add_lut_options(command, options->lut, op,
                    {"--set", "--look", "--display", "--reference-white", "--engine", "--inverse"});
    command.footer(
        "One colour a line: r g b or r,g,b; nan and inf are numbers; # begins a comment.\n"
        "The engines other than reference take the numbers as floats. There is no picture: "
        "parameters\nthat `apply` takes from it have their defaults.\n"
        "Examples:\n  printf '0.18 0.18 0.18\\n4,2,0.5\\n' | tonewright eval agx_sobotka --display "
        "srgb\n"
        "  echo 0.18 0.18 0.18 | tonewright eval --lut agx.cube --input-encoding acescct");
    command.action([options, command] {
        options->given = command.given();
        return run_eval(*options);
    });
}

TONEWRIGHT_NAMESPACE_END
