// SPDX-License-Identifier: Apache-2.0
#include "tasks/shader_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/input_file.h"
#include "base/little_endian.h"
#include "pipeline/stand_ins.h"
#include "tonewright/generated_files.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Files beside the text. Textures of a language are raw little-endian floats: NAME.rgba32f.
std::vector<GeneratedFile> files_beside(const std::string& text_file, const Shader& shader) {
    std::vector<GeneratedFile> files;
    const std::filesystem::path folder = std::filesystem::path(text_file).parent_path();
    for (const ShaderTexture& texture : shader.textures)
        files.push_back({folder / (texture.name + ".rgba32f"), little_endian_bytes(texture.rgba)});
    for (const ShaderFile& file : shader.files)
        files.push_back({folder / file.name, file.contents});
    return files;
}

}  // namespace

ShaderResult write_shader_files(const ShaderRequest& request, const std::string& file,
                                const Listener& listener) {
    if (!file.empty()) require_writable_file(file);
    ShaderResult result{write_shader(request)};
    const Shader& shader = result.shader;
    listener.warn_of(stand_in_warning(request.view.op, "shader", request.uniforms));
    const std::string& display = request.view.display;
    if (request.application && request.application->encodes && display != kLinearOutput &&
        display != kNativeOutput) {
        listener.warn_of(
            fmt::format("{} encodes its picture, so code values of {} are encoded twice",
                        request.application->title, display));
    }
    constexpr double kTenBits = 1.0 / 1023;
    result.is_double = request.language == ShaderLanguage::javascript && !request.application;
    if (!result.is_double && shader.errors.in_float > kTenBits) {
        listener.warn_of(
            fmt::format("{} is up to {} off in float, more than a code value of 10 bits: its "
                        "formulas need more digits than a shader has",
                        shader.function, rounded_up(shader.errors.in_float)));
    }
    const std::vector<GeneratedFile> beside = files_beside(file, shader);
    if (!beside.empty() && file.empty()) {
        throw Error(Problem{
            .value = fmt::format("{} reads the file {}", shader.function, beside.front().path),
            .expected = "<<target=FILE>>, beside which it is written"});
    }
    if (file.empty()) return result;
    for (const auto& [path, contents] : beside) {
        write_text_atomically(path, contents);
        result.beside.push_back(path);
    }
    write_text_atomically(file, shader.text);
    return result;
}

ShaderSetResult write_shader_set(const ShaderSetRequest& set) {
    require_writable_folder(set.folder);
    ShaderSetResult result;
    std::vector<GeneratedFile> files;
    std::string manifest = "path,operator,function,float_error,guaranteed,vulkan_estimate\n";
    for (const OperatorVariant& variant : all_variants()) {
        ShaderRequest request;
        request.tables = set.tables;
        request.curves = set.curves;
        request.view = make_view(resolve_operator(variant.name, {}, variant.look), set.input,
                                 set.exposure_stops, set.display);
        const ShaderErrors errors = measure_shader(request);  // all languages share them
        for (const ShaderLanguageInfo& language : set.languages) {
            request.language = language.language;
            const Shader shader = write_shader(request, &errors);
            const std::string path = language.id + "/" + shader.function + language.extension;
            manifest +=
                fmt::format("{},{},{},{},{},{}\n", path, operator_text(request.view.op),
                            shader.function, rounded_up(errors.in_float),
                            rounded_up(errors.guaranteed), rounded_up(errors.vulkan_estimate));
            files.push_back({path, shader.text});
            ++result.count;
            for (GeneratedFile& file : files_beside(path, shader))
                files.push_back(std::move(file));
        }
    }
    files.push_back({"MANIFEST.csv", manifest});
    write_generated_files(set.folder, files, "MANIFEST.csv");
    return result;
}

std::vector<std::string> languages_of(const std::string& extension) {
    std::vector<std::string> ids;
    for (const ShaderLanguageInfo& language : shader_languages()) {
        // `.glsl` means GLSL; GLSL ES has to be named.
        if ("." + language.id == extension) return {language.id};
        if (language.extension == extension) ids.push_back(language.id);
    }
    return ids;
}

TONEWRIGHT_NAMESPACE_END
