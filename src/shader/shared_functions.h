// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Three expressions of a color with repeated operations turned into functions, so that a
/// per-channel curve is written once.
struct SharedFunctions {
    struct Call {
        std::size_t function;
        Expr argument;     // of inputs 0, 1, 2, and 3 + i: the result of call i
        std::string name;  // of the result; empty: none
    };
    std::vector<Expr> functions;  // of input 0
    std::vector<Call> calls;
    std::array<Expr, 3> f = {0, 0, 0};
};
[[nodiscard]] SharedFunctions share_functions(const std::array<Expr, 3>& f);

TONEWRIGHT_NAMESPACE_END
