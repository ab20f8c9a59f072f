// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "shader/running_error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A function of one number in small pieces, with the range, the slope and the rounding error of
/// each. The error of the argument is multiplied by the slope of the whole function, not by those
/// of its operations, which may be much larger and cancel.
///
/// A composition of functions is split as well: the rounding error of an inner function is
/// multiplied by the slope of the outer ones.
class ErrorCurve {
  public:
    /// @param is_rounded  false: it is computed without an error of its own
    ErrorCurve(const Expr& f, bool is_rounded);

    [[nodiscard]] Bounded operator()(const Bounded& x);

  private:
    struct Piece {
        Interval x;
        Interval value;
        double rounding = 0;  // computed against exact, at the same argument
        double slope = 0;
        double jump = 0;
        double too_much = 0;  // estimate of the excess that halving would remove
    };
    struct Link {
        RunningError f;
        RunningError slope;
        bool is_one_operation = false;
        /// Pieces of [2^k, 2^(k+1)], of the negative range, and of the range between them.
        std::map<std::pair<int, int>, std::vector<Piece>> octaves = {};
        std::size_t piece_count = 0;

        [[nodiscard]] Piece piece_of(const Interval& x) const;
        [[nodiscard]] std::vector<Piece> pieces_of(const Interval& all);
        [[nodiscard]] const std::vector<Piece>& octave(int sign, int exponent);
        template <class Visit>
        void visit(const Interval& x, const Visit& visit_piece);
        [[nodiscard]] Bounded over(const Bounded& x, bool is_rounded);
    };

    Link whole_;
    std::vector<Link> links_;  // empty if it is a single function
    bool is_rounded_;
};

TONEWRIGHT_NAMESPACE_END
