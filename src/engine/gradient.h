// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/tape.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Computes the values of a pipeline in double precision, bit for bit like the reference engine,
/// and their derivatives by its inputs. Forward differentiation along the tape costs less than a
/// second evaluation. Safe to share between threads.
class GradientEngine {
  public:
    /// @throws Error  errors of Grid::nodes()
    explicit GradientEngine(const Pipeline& pipeline);

    /// Runs over planar colors. The derivative at a kink is that of one side; one that is not
    /// finite is 0.
    /// @param slope  slope[c][k]: d out[c] / d in[k]
    void run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
             const std::array<std::array<double*, 3>, 3>& slope, std::size_t count) const;

  private:
    struct Step {
        TapeInstruction instruction;
        std::size_t out = 0;  // register of the value and its three derivatives
        std::array<std::size_t, 3> in{};
        unsigned inputs = 0;                       // that the value depends on, one bit each
        std::array<unsigned, 3> operand_inputs{};  // that its operands depend on
    };

    Tape tape_;
    std::vector<Step> steps_;
    std::array<std::size_t, 3> outputs_{};
    std::size_t register_count_ = 0;
};

TONEWRIGHT_NAMESPACE_END
