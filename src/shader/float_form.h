// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "expr/interval.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Intervals of uniforms, by name.
using UniformRanges = std::map<std::string, Interval, std::less<>>;

/// Expressions rewritten so that float, as shaders compute it, gives a finite number wherever the
/// double reference does: denormals are 0, `pow`, `log2` and `sqrt` know no negatives, a
/// denominator may have been rounded to 0, and what a `select` does not take may be computed.
///
/// Where an operand's interval says that nothing can go wrong, nothing is added.
class FloatForm {
  public:
    /// @param inputs    intervals of inputs 0, 1, ...
    /// @param uniforms  of every uniform that the expressions read
    FloatForm(std::vector<Interval> inputs, UniformRanges uniforms);

    [[nodiscard]] Expr operator()(const Expr& e);
    /// Where the expression, as it is written, lies.
    [[nodiscard]] Interval range(const Expr& e);

  private:
    [[nodiscard]] Expr rewrite(const Expr& e);
    [[nodiscard]] Expr power(const Expr& base, const Expr& exponent);
    [[nodiscard]] Expr quotient(const Expr& a, const Expr& b);

    std::vector<Interval> inputs_;
    UniformRanges uniforms_;
    std::unordered_map<const ExprNode*, Expr> rewritten_;
    std::unordered_map<const ExprNode*, Interval> range_;
    std::vector<Expr> keep_;  // the nodes of the maps' keys
};

/// Where a function of one input lies over an interval of it: the interval in pieces, so that
/// operands that depend on each other count less.
[[nodiscard]] Interval range_over(const Expr& f, const Interval& input,
                                  const UniformRanges& uniforms);

TONEWRIGHT_NAMESPACE_END
