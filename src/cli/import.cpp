// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/strings.h"
#include "cli/command.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "tasks/import.h"
#include "tonewright/definition.h"

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

int run_import(const Options& options) {
    if (!options.output.empty()) {
        if (extension_of(options.output) != ".tone")
            throw Error("import: -o is " + options.output + "; expected a name that ends in .tone");
        std::error_code none;
        if (std::filesystem::equivalent(options.file, options.output, none))
            throw Error("import: -o is " + options.output +
                        ", the shader itself; expected another");
    }
    const auto warn_of_import = [](const std::string& text) { warn("import: " + text); };
    const auto& [shader, equals] =
        import_operator(options.file, import_of(options), options.output, {.warn = warn_of_import});
    if (options.output.empty()) fmt::print("{}", shader.definition);
    std::string others;
    for (const std::string& name : shader.others)
        others += (others.empty() ? "; others: " : ", ") + name;
    const std::string judged =
        equals.empty() ? "" : fmt::format("; it equals {}", fmt::join(equals, ", "));
    print_result(fmt::format("{}: function {} as {}{}{}",
                             options.output.empty() ? options.file : options.output,
                             shader.function, fmt::join(shader.stages, ", "), judged, others));
    return kOk;
}

}  // namespace

void add_import(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command = program.add(
        "import", "Operators", "Turn a GLSL or HLSL function into an operator, a .tone file.");
    command.argument("shader", &options->file, "file with `float f(float)` or `vec3 f(vec3)`",
                     {.is_required = true});
    command.title("Function");
    command.add("--function", "NAME", &options->function,
                "function to import (default: the last one that no other function calls)");
    command.add("--parameter", "NAME=NUMBER", &options->parameters,
                "default of a further argument or a uniform; NUMBER,MIN,MAX sets its range, too",
                {.takes_one_each = true});
    command.title("Color");
    command.add("--encoded", "NAME", &options->encoded,
                "encoding of the result: linear (default), srgb, gamma22 or gamma24",
                {.suggest = one_of({"linear", "srgb", "gamma22", "gamma24"})});
    command.add("--primaries", "NAME", &options->primaries,
                "primaries that the function works in, as .tone files name them");
    command.title("Output");
    command.add("-o", "FILE", &options->output,
                "file to write, NAME.tone (default: standard output)");
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
