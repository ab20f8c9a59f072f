// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "shader/rounding.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A number of which it is known where it lies, where what a GPU computes for it lies, and how far
/// the two are apart at most.
struct Bounded {
    Interval exact;
    Interval computed;
    double error = 0;
};

/// Samples that a reads, and the steepest slope between them.
struct TableReading {
    Interval values{kInfinity, -kInfinity};
    double slope = 0;        // per unit of a
    double of_position = 0;  // error of what a sample's position is rounded to, in values
    double jump = 0;         // between neighbors, of a table of steps
};

/// Expressions over intervals, with the errors that Vulkan allows each operation. Nothing is
/// neglected: terms of any order count, and a comparison that may go either way counts with the
/// difference of what it chooses from.
class RunningError {
  public:
    explicit RunningError(const std::vector<Expr>& outputs);

    /// @param inputs      of input 0, 1, ...
    /// @param has_choice  becomes true where the expressions may jump: a comparison may go either
    ///                    way
    [[nodiscard]] std::vector<Bounded> operator()(const std::vector<Bounded>& inputs,
                                                  bool* has_choice = nullptr) const;

    /// How many operations that is.
    [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }

  private:
    struct Step {
        Expr e;
        std::size_t a = 0, b = 0, c = 0;
        /// Of a lattice: the largest difference of neighbors along each axis.
        double slope[3] = {};
        Interval whole;      // of a lattice's nodes
        TableReading table;  // of all samples
    };
    /// Comparisons that may go either way.
    struct Choices {
        std::vector<std::size_t> open;
        bool may_differ = false;  // between what is exact and what is computed
        bool others = false;      // whole numbers and steps of tables
    };
    using Answers = std::map<std::size_t, double>;
    [[nodiscard]] std::vector<Bounded> run(const std::vector<Bounded>& inputs,
                                           const Answers& answers, Choices* choices) const;

    std::vector<Step> nodes_;
    std::vector<std::size_t> outputs_;
};

/// The interval, a little wider: what double itself rounds.
[[nodiscard]] Interval widened(const Interval& x);
/// Largest absolute value.
[[nodiscard]] double magnitude(const Interval& x);
[[nodiscard]] Interval hull(const Interval& a, const Interval& b);

TONEWRIGHT_NAMESPACE_END
