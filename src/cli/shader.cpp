// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "base/format_number.h"
#include "base/strings.h"
#include "cli/lut_input.h"
#include "cli/messages.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "tasks/shader_files.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options : ViewOptions {
    LutOptions lut;
    std::string language;
    std::string application;
    std::string file;
    std::vector<std::string> uniforms;
    std::string all;
    std::string tables;
    std::string curves = "formula";
    bool is_inverse = false;
    bool list = false;
};

int list_languages() {
    fmt::print("languages\n");
    for (const ShaderLanguageInfo& info : shader_languages())
        fmt::print("  {:<14}  {}\n", info.id, info.title);
    fmt::print("applications (--for prints what to do with the file)\n");
    for (const ShaderApplication& application : shader_applications()) {
        fmt::print("  {:<14}  {}, {} out\n", application.id, application.title,
                   application.display);
    }
    return kOk;
}

ShaderCurves curves_of(const Options& options) {
    return options.curves == "fitted" ? ShaderCurves::fitted : ShaderCurves::formula;
}

ShaderTables tables_of(const Options& options) {
    return options.tables == "texture"   ? ShaderTables::texture
           : options.tables == "array"   ? ShaderTables::array
           : options.tables == "formula" ? ShaderTables::formula
                                         : ShaderTables::by_size;
}

/// The language of --language, else of the file's extension.
const ShaderLanguageInfo& language_of(const Options& options) {
    const std::string extension = extension_of(options.file);
    const std::vector<std::string> ids = languages_of(extension);
    if (options.language.empty()) {
        if (ids.size() == 1) return find_shader_language(ids.front());
        throw Error(fmt::format(
            "shader: --language and --for are missing; expected {} (`tonewright shader --list`)",
            ids.empty() ? "one of them" : "--language " + join_choices(ids)));
    }
    const ShaderLanguageInfo& language = find_shader_language(options.language);
    const bool is_own = extension == language.extension || extension == "." + language.id;
    if (!ids.empty() && !is_own) {
        throw Error(fmt::format("shader: file is {}; expected {}: the language is {}",
                                printable(options.file), language.extension, language.id));
    }
    return language;
}

void write_one(Options& options) {
    if (options.file == "-") options.file.clear();
    if (options.op.empty())
        throw Error("shader: OPERATOR is missing; expected an id from `tonewright list`");
    if (!options.language.empty() && !options.application.empty())
        throw Error(
            "shader: --language and --for are given; expected one of them (`tonewright shader "
            "--list`)");
    ShaderRequest request;
    if (options.application.empty()) {
        request.language = language_of(options).language;
    } else {
        const ShaderApplication& application = find_shader_application(options.application);
        const std::string extension = extension_of(options.file);
        if (extension != application.extension && !languages_of(extension).empty()) {
            throw Error(fmt::format("shader: file is {}; expected {}: {} reads it",
                                    printable(options.file), application.extension,
                                    application.title));
        }
        request.application = &application;
        if (!options.given.contains("--display")) options.display = application.display;
        if (!options.given.contains("--input")) options.input = application.input;
    }
    request.view = options.view();
    request.uniforms = options.uniforms;
    request.is_inverse = options.is_inverse;
    request.tables = tables_of(options);
    request.curves = curves_of(options);
    request.cache_folder = user_cache_folder();
    const auto& [shader, is_double, beside] =
        write_shader_files(request, options.file, {.warn = warn});
    if (options.file.empty()) {
        fmt::print("{}", shader.text);
        return;
    }
    for (const std::string& path : beside)
        print_result(path + ": a file that it reads");
    print_result(
        is_double
            ? fmt::format("{}: {}(), the reference in 64-bit float", options.file, shader.function)
            : fmt::format("{}: {}(), in float within {} of the reference", options.file,
                          shader.function, rounded_up(shader.errors.in_float)));
    if (request.application)
        print_result(request.application->title + ": " + request.application->steps);
}

/// In one language or all: FOLDER/LANGUAGE/tw_NAME.EXTENSION.
void write_all(const Options& options) {
    if (!options.op.empty() || !options.application.empty() || !options.file.empty() ||
        !options.uniforms.empty() || options.is_inverse) {
        throw Error(
            "shader: --all is given; expected no OPERATOR, --for, -o, --uniforms or --inverse "
            "beside it");
    }
    ShaderSetRequest request;
    request.folder = options.all;
    request.languages = shader_languages();
    if (!options.language.empty()) request.languages = {find_shader_language(options.language)};
    request.tables = tables_of(options);
    request.curves = curves_of(options);
    request.input = options.input;
    request.exposure_stops = options.exposure;
    request.display = options.display;
    const ShaderSetResult result = write_shader_set(request);
    print_result(fmt::format("{}: {} shaders", options.all, result.count));
}

int run_shader(Options& options) {
    if (options.list) return list_languages();
    if (options.all.empty()) {
        write_one(options);
    } else {
        write_all(options);
    }
    return kOk;
}

}  // namespace

void add_shader(CommandLine& program) {
    auto options = std::make_shared<Options>();
    options->display = kLinearOutput;
    const Command command =
        program.add("shader", "LUTs, shaders and configs", "Write an operator as shader source.");
    add_operator_argument(command, options->op);
    command.title("Output");
    command.add("--language", "NAME", &options->language,
                "shader language; see --list (default: by the extension)",
                {.suggest = suggest_languages});
    command.add("--for", "NAME", &options->application,
                "application that takes the whole file; see --list. Sets language and display",
                {.suggest = suggest_shader_applications});
    command.add("-o", "FILE", &options->file, "file to write (default, or -: standard output)");
    command.add("--all", "FOLDER", &options->all,
                "write all operators, presets and looks in one language or in all");
    command.add("--uniforms", "NAME,...", &options->uniforms,
                "arguments after the color: exposure, and live parameters (see `tonewright list "
                "OPERATOR`)",
                {.suggest = suggest_uniforms, .takes_one_each = true, .separator = ','});
    command.add(
        "--tables", "KIND", &options->tables,
        "tables and 3D LUTs as `texture` (speed not measured) or `array`, or 3D LUTs computed by "
        "`formula`",
        {.choices = {"texture", "array", "formula"}});
    command.add("--curves", "KIND", &options->curves,
                "curves of one number as `formula`, or `fitted` polynomials where these are faster",
                {.choices = {"formula", "fitted"}});
    command.add_flag("--inverse", &options->is_inverse, "write the inverse");
    command.add_flag("--list", &options->list, "list languages and applications");
    add_view_options(command, *options);
    command.title("LUT as the operator");
    add_lut_input_options(command, options->lut);
    command.common({"--language", "--for", "-o", "--uniforms", "--list", "--set", "--look",
                    "--exposure", "--input", "--display"});
    command.footer(
        "The function is tw_<operator>, followed by _<preset>, _<look>, _inverse or _encoded. It "
        "takes scene-linear light. It returns display-linear light (--display linear, the default: "
        "for renderers that encode their pictures themselves) or code values (--display srgb).\n"
        "Examples:\n"
        "  tonewright shader agx_threejs --language glsl -o agx.glsl\n"
        "  tonewright shader hable --language hlsl --uniforms white -o hable.hlsl\n"
        "  tonewright shader agx_threejs --for threejs -o agx.js\n"
        "  tonewright shader khronos_neutral --language c --display srgb -o neutral.h");
    command.action(
        [options] {
            take_lut_options("shader", options->lut, *options, LutOption::no);
            return run_shader(*options);
        },
        &options->given);
}

TONEWRIGHT_NAMESPACE_END
