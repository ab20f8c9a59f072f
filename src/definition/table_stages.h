// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/definition.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The encoding of a LUT that takes colors as they are.
inline constexpr std::string_view kNoEncoding = "none";

/// Scene-linear light of the working primaries, encoded for the LUT, and the LUT.
/// @param encoding  as parse_input_encoding() reads it; `none` or empty: colors go in as they are
/// @param space     input space whose light is encoded; empty: the encoding's own
/// @throws Error    unknown names; a space without an encoding
[[nodiscard]] Pipeline table_stages(const TableFile& table, const std::string& encoding,
                                    const std::string& space, const Primaries& working);

/// True for what operator_of_table() gives.
[[nodiscard]] bool is_table_operator(const Operator& op);
/// The space that its settings choose; empty: that of the encoding.
[[nodiscard]] std::string space_of_table(const ResolvedOperator& op);

TONEWRIGHT_NAMESPACE_END
