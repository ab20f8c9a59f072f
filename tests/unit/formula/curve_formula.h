// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "formula/formula.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline FormulaScope curve_scope() {
    FormulaScope scope;
    scope.inputs = {"x"};
    scope.names.emplace("k", FormulaValue{Expr::uniform("k")});
    scope.names.emplace("mode.soft", FormulaValue{1});
    return scope;
}

inline Expr parsed_formula(const std::string& formula) {
    return parse_formula(formula, curve_scope());
}

TONEWRIGHT_NAMESPACE_END
