// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tasks/listener.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ShaderResult {
    Shader shader;
    /// True for numbers of 64 bits: the reference itself.
    bool is_double = false;
    /// Paths of its files beside the text.
    std::vector<std::string> beside = {};
};

/// Writes a shader and its textures. Old files are replaced when the new ones are complete.
/// @param file        of the text; empty: writes nothing
/// @throws Error      @see write_shader; a shader with textures and no file
/// @throws FileError  a file cannot be written
[[nodiscard]] ShaderResult write_shader_files(const ShaderRequest& request, const std::string& file,
                                              const Listener& listener);

/// All operators, presets and looks in some languages.
struct ShaderSetRequest {
    std::string folder;
    std::vector<ShaderLanguageInfo> languages;
    ShaderTables tables = ShaderTables::by_size;
    ShaderCurves curves = ShaderCurves::formula;
    /// @see View
    std::string input = "lin_rec709";
    double exposure_stops = 0;
    std::string display = std::string(kLinearOutput);
};

struct ShaderSetResult {
    std::size_t count = 0;
};

/// Writes FOLDER/LANGUAGE/tw_NAME.EXTENSION, and MANIFEST.csv.
/// @throws Error      @see make_view
/// @throws FileError  a file cannot be written
[[nodiscard]] ShaderSetResult write_shader_set(const ShaderSetRequest& request);

/// Ids of the languages whose files have this extension: `.glsl`.
[[nodiscard]] std::vector<std::string> languages_of(const std::string& extension);

TONEWRIGHT_NAMESPACE_END
