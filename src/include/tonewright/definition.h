// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tonewright/pipeline.h"

/// Operators as files: .tone files and LUTs (docs/own_operators.md).
TONEWRIGHT_NAMESPACE_BEGIN

/// The file does not define an operator. The message is one line, `file:line:column: ...`.
class TONEWRIGHT_API DefinitionError : public FileError {
  public:
    DefinitionError(const std::string& message, std::string excerpt)
        : FileError(message), excerpt_(std::move(excerpt)) {}
    /// The line of the file, and one with a caret below the place. It may be empty.
    [[nodiscard]] const std::string& excerpt() const noexcept { return excerpt_; }

  private:
    std::string excerpt_;
};

/// A LUT file as stages, and what it says about itself.
struct TableFile {
    /// What the file holds: lattices, tables of each channel, and simple formulas between them.
    Pipeline stages;
    /// "3D LUT of 33^3 nodes"
    std::string description;
    /// Empty: it has none.
    std::string title;
    /// The encoding that goes in, as parse_input_encoding() reads it, and the id of the input space
    /// whose light it encodes. Empty: the file does not say.
    std::string encoding;
    std::string space;
    /// Id of the display whose code values come out, or `linear`. Empty: the file does not say.
    std::string display;
    /// What to take where the file does not say: formats of light hold light.
    std::string likely_display = "srgb";
    /// What a user should know, such as an interpolation that the operator does not have.
    std::string note;
};

/// Reads LUT files for this part of the library, which has no readers of its own.
/// @throws FileError  "read: PATH: REASON"
using TableReader = std::function<TableFile(const std::string& path)>;

/// Extensions of the files that a TableReader may know, with the dot: LUTs, and pictures of LUTs.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& table_extensions();

/// Reads an operator from a .tone file or a LUT. Nothing is registered: the operator lives as long
/// as somebody holds it.
/// @param tables  reads LUTs. Null: only .tone files without `lut` stages are operators.
/// @throws FileError        the file cannot be read
/// @throws DefinitionError  it does not define an operator
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> load_operator(
    const std::string& path, const TableReader& tables = {});

/// The same from the text of a .tone file.
/// @param name  of the file, for messages and Operator::file. Paths in the text begin at its
/// folder.
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> parse_operator(
    std::string_view text, const std::string& name, const TableReader& tables = {});

/// A LUT as an operator, with the parameters `input` (encoding), `space` (of its light) and
/// `output` (display, or `linear`). Their defaults are what the file says.
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> operator_of_table(
    const TableFile& table, const std::string& path);

/// The operator as the text of a .tone file: its live parameters as parameters, the others as they
/// are resolved. parse_operator() reads it back as an operator with the identical expressions.
/// @throws Error  no formula says what the operator does: it is local, or has a table of no file
[[nodiscard]] TONEWRIGHT_API std::string definition_of(const ResolvedOperator& op);

/// A number of a shader that stays a parameter. Without ends, its range is a guess.
struct ImportedParameter {
    double value = 0;
    std::optional<double> min = {};
    std::optional<double> max = {};
};

/// How to read a shader as an operator.
struct ShaderImport {
    /// `float f(float)` or `vec3 f(vec3)`; empty: the last one that no other calls.
    std::string function;
    /// Of the operator; empty: the name of the function.
    std::string id;
    /// The primaries that the function works in: a name that .tone files have.
    std::string primaries = "rec709";
    /// What the function returns. Empty: display-linear, with a warning where it looks encoded.
    enum class Output : unsigned char { display_linear, srgb, gamma22, gamma24 };
    std::optional<Output> output = {};
    /// Further arguments of the function, and uniforms.
    std::map<std::string, ImportedParameter> parameters;
};

/// A shader's function as an operator.
struct ImportedShader {
    /// The text of a .tone file.
    std::string definition;
    std::string function;
    /// Names of other functions that could have been taken.
    std::vector<std::string> others;
    /// Of the operator: "clamp", "matrix", "curve", ...
    std::vector<std::string> stages;
    /// What the user may have meant otherwise.
    std::vector<std::string> warnings;
};

/// Reads a function of straight-line GLSL or HLSL (docs/tone_files.md says what it may have).
/// @param name  of the file, for messages and the definition's comments
/// @throws DefinitionError  the shader has no such function, or one that no operator can say
/// @throws Error            a setting of the import is wrong
[[nodiscard]] TONEWRIGHT_API ImportedShader import_shader(std::string_view text,
                                                          const std::string& name,
                                                          const ShaderImport& settings);
/// The same from a file.
/// @throws FileError  it cannot be read
[[nodiscard]] TONEWRIGHT_API ImportedShader load_shader(const std::string& path,
                                                        const ShaderImport& settings);

TONEWRIGHT_NAMESPACE_END
