// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ExprNode {
    ExprOp op = ExprOp::constant;
    double value = 0;  // constant
    int input = 0;     // input; channel of a grid
    std::string name;  // uniform
    std::vector<Expr> operands;
    std::shared_ptr<const Table> table;  // lookup
    std::shared_ptr<const Grid> grid;
};

TONEWRIGHT_NAMESPACE_END
