// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/command.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "tonewright/definition.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options {
    std::string file;
    std::string output;
    std::string function;
    std::vector<std::string> parameters;
    std::string encoded;
    std::string primaries = "rec709";
};

/// `4` or `4,0.1,100`: the value, and the ends of its range.
ImportedParameter parameter_of(const std::string& text, std::string_view numbers) {
    std::vector<double> values;
    const char* at = numbers.data();
    const char* const end = at + numbers.size();
    bool is_right = true;
    while (is_right) {
        double value = 0;
        const auto result = std::from_chars(at, end, value);
        is_right = result.ec == std::errc() && std::isfinite(value);
        values.push_back(value);
        at = result.ptr;
        if (at == end || *at != ',') break;
        ++at;
    }
    is_right = is_right && at == end && (values.size() == 1 || values.size() == 3);
    if (!is_right)
        throw Error("import: --parameter is " + one_line(text) +
                    "; expected NAME=NUMBER or NAME=NUMBER,MIN,MAX");
    if (values.size() == 1) return {values[0]};
    return {values[0], values[1], values[2]};
}

ShaderImport import_of(const Options& options) {
    ShaderImport settings;
    settings.function = options.function;
    settings.primaries = options.primaries;
    if (!options.output.empty())
        settings.id = std::filesystem::path(options.output).stem().string();
    for (const std::string& text : options.parameters) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error("import: --parameter is " + one_line(text) + "; expected NAME=NUMBER");
        const auto numbers = std::string_view(text).substr(equals + 1);
        settings.parameters[text.substr(0, equals)] = parameter_of(text, numbers);
    }
    if (!options.encoded.empty()) {
        settings.output = static_cast<ShaderImport::Output>(
            find_choice("encoded", options.encoded, {"linear", "srgb", "gamma22", "gamma24"}));
    }
    return settings;
}

/// Colors that tell operators apart: grays, saturated colors, light above white, a negative.
constexpr std::array<Vector3, 8> kColors = {{{0, 0, 0},
                                             {0.01, 0.01, 0.01},
                                             {0.18, 0.18, 0.18},
                                             {0.9, 0.2, 0.05},
                                             {0.02, 0.3, 0.8},
                                             {3, 2, 0.5},
                                             {0.5, 12, 2},
                                             {-0.1, 0.4, 0.2}}};
using Shown = std::array<std::array<double, kColors.size()>, 3>;

/// In code values of sRGB.
Shown shown_by(const ResolvedOperator& op) {
    Shown shown{};
    for (std::size_t i = 0; i < kColors.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            shown.at(c).at(i) = kColors.at(i).at(c);
    }
    const std::array<double*, 3> at = {shown[0].data(), shown[1].data(), shown[2].data()};
    ReferenceEngine(build_view(make_view(op, "lin_rec709", 0, "srgb")))
        .run({at[0], at[1], at[2]}, at, kColors.size());
    return shown;
}

/// Names of built-in operators that show the same; the function may round its constants to five
/// digits.
std::vector<std::string> equals_of(const Shown& shown) {
    constexpr double kSame = 1e-5;
    std::vector<std::string> names;
    for (const OperatorVariant& variant : all_variants()) {
        const Shown other = shown_by(resolve_operator(variant.name, {}, variant.look));
        double error = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < kColors.size(); ++i)
                error = std::max(error, std::fabs(shown.at(c).at(i) - other.at(c).at(i)));
        }
        if (error < kSame) names.push_back(variant.name);
    }
    return names;
}

/// Judges the function by its numbers; with a warning, unless the text gave one.
std::string judgement(const ImportedShader& shader, bool is_encoding_given) {
    const std::shared_ptr<const Operator> op = parse_operator(shader.definition, "the definition");
    const Shown shown = shown_by(resolve(*op, nullptr, {}, ""));
    if (const std::vector<std::string> equals = equals_of(shown); !equals.empty())
        return fmt::format("; it equals {}", fmt::join(equals, ", "));
    // Code 0.64 is linear 0.36, a stop above mid gray.
    constexpr std::size_t kGray = 2;
    constexpr double kBright = 0.64;
    if (const double gray = shown[1].at(kGray);
        !is_encoding_given && shader.warnings.empty() && gray > kBright && gray < 1)
        warn(
            fmt::format("import: mid gray is shown as {:.2g}; if the function returns code "
                        "values, say which: --encoded srgb, gamma22 or gamma24",
                        gray));
    return "";
}

int run_import(const Options& options) {
    if (!options.output.empty()) {
        if (extension_of(options.output) != ".tone")
            throw Error("import: -o is " + options.output + "; expected a name that ends in .tone");
        std::error_code none;
        if (std::filesystem::equivalent(options.file, options.output, none))
            throw Error("import: -o is " + options.output +
                        ", the shader itself; expected another");
    }
    const ImportedShader shader = load_shader(options.file, import_of(options));
    for (const std::string& warning : shader.warnings)
        warn("import: " + warning);
    const std::string judged = judgement(shader, !options.encoded.empty());
    if (options.output.empty()) {
        fmt::print("{}", shader.definition);
    } else {
        write_text_atomically(options.output, shader.definition);
    }
    std::string others;
    for (const std::string& name : shader.others)
        others += (others.empty() ? "; others: " : ", ") + name;
    print_result(fmt::format("{}: function {} as {}{}{}",
                             options.output.empty() ? options.file : options.output,
                             shader.function, fmt::join(shader.stages, ", "), judged, others));
    return kOk;
}

}  // namespace

void add_import(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("import", "Turn a GLSL or HLSL function into an operator, a .tone file.");
    command.group("Operators");
    command.add("shader", options->file, "file with `float f(float)` or `vec3 f(vec3)`").required();
    const char* const function = "Function";
    command
        .add("--function", options->function,
             "function to import (default: the last one that no other function calls)")
        .value("NAME")
        .group(function);
    command
        .add("--parameter", options->parameters,
             "default of a further argument or a uniform; NUMBER,MIN,MAX sets its range, too")
        .value("NAME=NUMBER")
        .one_value_each()
        .group(function);
    const char* const color = "Color";
    command
        .add("--encoded", options->encoded,
             "encoding of the result: linear (default), srgb, gamma22 or gamma24")
        .value("NAME")
        .suggest({"linear", "srgb", "gamma22", "gamma24"})
        .group(color);
    command
        .add("--primaries", options->primaries,
             "primaries that the function works in, as .tone files name them")
        .value("NAME")
        .show_default()
        .group(color);
    command.add("-o", options->output, "file to write, NAME.tone (default: standard output)")
        .value("FILE")
        .group("Output");
    command.footer(
        "The imported function and those that it calls are straight-line code: no loops, textures, "
        "arrays or recursion. Negatives count as 0.\n"
        "Examples:\n"
        "  tonewright import tonemap.glsl -o my.tone\n"
        "  tonewright import aces.hlsl --function ACESFilm --parameter gain=1 -o my.tone\n"
        "  tonewright import film.glsl --encoded gamma22 -o film.tone");
    command.action([options] { return run_import(*options); });
}

TONEWRIGHT_NAMESPACE_END
