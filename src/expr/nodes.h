// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Every node of the expressions once, operands before the nodes that read them.
[[nodiscard]] TONEWRIGHT_API std::vector<Expr> nodes_of(Span<const Expr> exprs);

TONEWRIGHT_NAMESPACE_END
