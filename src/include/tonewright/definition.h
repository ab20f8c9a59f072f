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
    /// The line of the file, and a line with a caret below the error. May be empty.
    [[nodiscard]] const std::string& excerpt() const noexcept { return excerpt_; }

  private:
    std::string excerpt_;
};

/// A LUT file as stages, with the facts of its header.
struct TableFile {
    /// 3D LUTs, 1D tables for each channel, and simple formulas between them.
    Pipeline stages;
    /// "3D LUT of 33^3 nodes"
    std::string description;
    /// Empty: none.
    std::string title;
    /// The encoding of the input, as parse_input_encoding() reads it, and the id of the input space
    /// whose light it encodes. Empty: unknown.
    std::string encoding;
    std::string space;
    /// Id of the display whose code values are the output, or `linear`. Empty: unknown.
    std::string display;
    /// Used if `display` is empty; `linear` for formats that usually contain light.
    std::string likely_display = "srgb";
    /// A note for the user, such as an interpolation that the operator does not support.
    std::string note;
};

/// Reads LUT files. The core library has no such reader of its own.
/// @throws FileError  "read: PATH: REASON"
using TableReader = std::function<TableFile(const std::string& path)>;

/// Extensions of LUT files and of pictures that contain LUTs, with the dot.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& table_extensions();

/// Reads an operator from a .tone file or a LUT. Nothing is registered: the caller owns the
/// operator.
/// @param tables  reads LUTs. Null: only .tone files without `lut` stages are read.
/// @throws FileError        the file cannot be read
/// @throws DefinitionError  it does not define an operator
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> load_operator(
    const std::string& path, const TableReader& tables = {});

/// The same from the text of a .tone file.
/// @param name  of the file, for messages and Operator::file. Paths in the text begin at its
/// folder.
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> parse_operator(
    std::string_view text, const std::string& name, const TableReader& tables = {});

/// A formula as an operator, as people type it: "x/(1 + x)". A formula of x maps each channel; one
/// of r, g, b gives all three. Three formulas with commas between them give red, green and blue.
/// Input and output are linear Rec.709, the output for a display's white of 1; negatives are
/// clamped at 0 first. The grammar is that of .tone files. name() is the text.
/// @throws Error  no formula, more than 4096 characters, or a result that is not finite
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> formula_operator(
    std::string_view text);
/// True for a text with x, r, g or b and a sign of arithmetic.
[[nodiscard]] TONEWRIGHT_API bool may_be_formula(std::string_view text);

/// A LUT as an operator, with the parameters `input` (encoding), `space` (of the encoded light) and
/// `output` (display, or `linear`). Their defaults come from the file.
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> operator_of_table(
    const TableFile& table, const std::string& path);

/// The operator as the text of a .tone file: live parameters stay parameters, the others are fixed
/// as resolved. parse_operator() reads the text as an operator with identical expressions.
/// @throws Error  a local operator, or one with a table that comes from no file
[[nodiscard]] TONEWRIGHT_API std::string definition_of(const ResolvedOperator& op);

/// A number of a shader that becomes a parameter. Without `min` and `max`, its range reaches from a
/// sixteenth of the value to sixteen times the value.
struct ImportedParameter {
    double value = 0;
    std::optional<double> min = {};
    std::optional<double> max = {};
};

/// Options for reading a shader as an operator.
struct ShaderImport {
    /// Name of `float f(float)` or `vec3 f(vec3)`; empty: the last one that no other function
    /// calls.
    std::string function;
    /// Id of the operator; empty: the name of the function.
    std::string id;
    /// The primaries of the function, by the names of .tone files.
    std::string primaries = "rec709";
    /// Meaning of the result. Empty: display-linear, with a warning if it looks encoded.
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
    /// Names of other functions that could be imported.
    std::vector<std::string> others;
    /// Kinds of the operator's stages: "clamp", "matrix", "curve", ...
    std::vector<std::string> stages;
    /// Cautions about assumptions that may be wrong.
    std::vector<std::string> warnings;
};

/// Reads a function of straight-line GLSL or HLSL; docs/tone_files.md lists what is supported.
/// @param name  of the file, for messages and the definition's comments
/// @throws DefinitionError  the shader has no such function, or one that cannot be an operator
/// @throws Error            a setting of the import is wrong
[[nodiscard]] TONEWRIGHT_API ImportedShader import_shader(std::string_view text,
                                                          const std::string& name,
                                                          const ShaderImport& settings);
/// The same from a file.
/// @throws FileError  it cannot be read
[[nodiscard]] TONEWRIGHT_API ImportedShader load_shader(const std::string& path,
                                                        const ShaderImport& settings);

TONEWRIGHT_NAMESPACE_END
