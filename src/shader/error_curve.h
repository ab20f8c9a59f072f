// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "shader/running_error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A function of one number, in pieces that are small enough to say of each where its values lie,
/// how steep it is, and what rounding adds. An error of its argument then counts with the slope of
/// the whole function, not with those of its operations, which may be far larger and cancel.
///
/// A function that is several ones, each of what the one before gives, is taken apart as well: what
/// rounding adds in an inner one then counts with the slope of the outer ones.
class ErrorCurve {
  public:
    /// @param is_rounded  false: computing it adds no error of its own
    ErrorCurve(const Expr& f, bool is_rounded);

    [[nodiscard]] Bounded operator()(const Bounded& x);

  private:
    struct Piece {
        Interval x;
        Interval value;
        double rounding = 0;  // computed against exact, at the same argument
        double slope = 0;
        double jump = 0;
        double too_much = 0;  // about what two halves would do without
    };
    struct Link {
        RunningError f;
        RunningError slope;
        bool is_one_operation = false;
        /// The pieces of [2^k, 2^(k+1)], of the same below 0, and of what is left between.
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
    std::vector<Link> links_;  // empty where it is one
    bool is_rounded_;
};

TONEWRIGHT_NAMESPACE_END
