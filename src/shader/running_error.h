// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "shader/rounding.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A number with its exact interval, the interval of a GPU's result, and the largest difference of
/// both.
struct Bounded {
    Interval exact;
    Interval computed;
    double error = 0;
};

/// Samples that a lookup with `a` reads, and their steepest slope.
struct TableReading {
    Interval values{kInfinity, -kInfinity};
    double slope = 0;        // per unit of a
    double of_position = 0;  // error of what a sample's position is rounded to, in values
    double jump = 0;         // between neighbors, of a table of steps
};

/// Evaluates expressions over intervals, with the errors that Vulkan allows each operation. It
/// includes terms of any order. A comparison with an uncertain result counts with the difference of
/// its branches.
class RunningError {
  public:
    explicit RunningError(const std::vector<Expr>& outputs);

    /// @param inputs      for input 0, 1, ...
    /// @param has_choice  set to true if the expressions may jump: a comparison has an uncertain
    ///                    result
    [[nodiscard]] std::vector<Bounded> operator()(const std::vector<Bounded>& inputs,
                                                  bool* has_choice = nullptr) const;

    /// Number of operations.
    [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }

  private:
    struct Step {
        Expr e;
        std::size_t a = 0, b = 0, c = 0;
        /// For a Grid: the largest difference of neighbors along each axis.
        double slope[3] = {};
        Interval whole;      // of a grid's nodes
        TableReading table;  // of all samples
    };
    /// Comparisons with an uncertain result.
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

/// Slightly wider interval, for the rounding of double itself.
[[nodiscard]] Interval widened(const Interval& x);
/// Largest absolute value.
[[nodiscard]] double magnitude(const Interval& x);
[[nodiscard]] Interval hull(const Interval& a, const Interval& b);

TONEWRIGHT_NAMESPACE_END
