// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "tonewright/pipeline.h"

/// Operators as .tone files (docs/own_operators.md).
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

/// Reads an operator. Nothing is registered: the operator lives as long as somebody holds it.
/// @throws FileError        the file cannot be read
/// @throws DefinitionError  it does not define an operator
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> load_operator(const std::string& path);

/// The same from text.
/// @param name  of the file, for messages and Operator::file
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const Operator> parse_operator(
    std::string_view text, const std::string& name);

/// The operator as the text of a .tone file: its live parameters as parameters, the others as they
/// are resolved. parse_operator() reads it back as an operator with the identical expressions.
/// @throws Error  no formula says what the operator does: it is local, or has a table
[[nodiscard]] TONEWRIGHT_API std::string definition_of(const ResolvedOperator& op);

TONEWRIGHT_NAMESPACE_END
