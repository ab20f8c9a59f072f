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
/// denominator may round to 0, and the unused branch of a `select` may be computed.
///
/// Adds nothing if the operand's interval excludes the problem.
class FloatForm {
  public:
    /// @param inputs    intervals of inputs 0, 1, ...
    /// @param uniforms  for every uniform that the expressions read
    FloatForm(std::vector<Interval> inputs, UniformRanges uniforms);

    [[nodiscard]] Expr operator()(const Expr& e);
    /// Interval of the expression as written.
    [[nodiscard]] Interval range(const Expr& e);

  private:
    /// The expression has no names; neither has the result.
    [[nodiscard]] Expr rewritten(const Expr& e);
    [[nodiscard]] Expr rewrite(const Expr& e);
    [[nodiscard]] Expr power(const Expr& base, const Expr& exponent);
    [[nodiscard]] Expr quotient(const Expr& a, const Expr& b);

    std::vector<Interval> inputs_;
    UniformRanges uniforms_;
    PartNames names_;
    std::unordered_map<const ExprNode*, Expr> rewritten_;
    std::unordered_map<const ExprNode*, Interval> range_;
    std::vector<Expr> keep_;  // the nodes of the maps' keys
};

/// Interval of a function of one input over an interval: evaluated in pieces, which reduces the
/// effect of dependent operands.
[[nodiscard]] Interval range_over(const Expr& f, const Interval& input,
                                  const UniformRanges& uniforms);

TONEWRIGHT_NAMESPACE_END
