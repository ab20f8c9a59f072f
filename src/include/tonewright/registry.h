// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/pipeline.h"

/// The built-in operators, by name.
TONEWRIGHT_NAMESPACE_BEGIN

/// All operators that map each pixel by itself, sorted by id. The table is generated from the files
/// of src/operators/.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& all_operators();
/// All operators that look at a pixel's surroundings, sorted by id. They work on pictures only.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& local_operators();

/// @throws Error  naming the nearest id when there is no such operator, or for a local operator.
[[nodiscard]] TONEWRIGHT_API const Operator& find_operator(std::string_view id);
/// The same, but accepts local operators.
[[nodiscard]] TONEWRIGHT_API const Operator& find_picture_operator(std::string_view id);

/// Looks up `id` or `id:preset` and checks the settings against the operator's parameters.
///
/// @param name      operator id, optionally `:preset`.
/// @param settings  parameter name -> text; they win over the preset's.
/// @param look      look id, or empty.
/// @throws Error    as find_operator(), find_preset() and resolve().
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve_operator(std::string_view name,
                                                               const Settings& settings = {},
                                                               std::string_view look = {});
/// The same, but accepts local operators.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve_picture_operator(
    std::string_view name, const Settings& settings = {}, std::string_view look = {});

/// The same from one text: `id[:preset][:parameter=value...][:look=id]`.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator parse_operator(std::string_view text);
[[nodiscard]] TONEWRIGHT_API ResolvedOperator parse_picture_operator(std::string_view text);
/// The inverse of parse_operator(). A value that contains a colon does not survive it.
[[nodiscard]] TONEWRIGHT_API std::string operator_text(const ResolvedOperator& op);

/// Ids of the operators that have an inverse.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> invertible_operators();

/// An operator, `operator:preset`, or an operator with a look.
struct OperatorVariant {
    std::string name;
    std::string look;
};
/// Every operator, each with every preset and with every look.
[[nodiscard]] TONEWRIGHT_API std::vector<OperatorVariant> all_variants();

TONEWRIGHT_NAMESPACE_END
