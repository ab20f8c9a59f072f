// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "formula/formula.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// definition_of() with names for the temporaries of its formulas.
[[nodiscard]] std::string definition_of(const ResolvedOperator& op, const FormulaNames& names);

TONEWRIGHT_NAMESPACE_END
