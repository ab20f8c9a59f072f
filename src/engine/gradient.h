// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/tape.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Double-precision values of a pipeline, bit for bit the reference engine's, and their derivatives
/// by its inputs: forward differentiation along the tape, for less than a second evaluation costs.
/// Safe to share between threads.
class GradientEngine {
  public:
    /// @throws Error  what Grid::nodes() throws
    explicit GradientEngine(const Pipeline& pipeline);

    /// Planar. At a kink the derivative of one side, 0 where it is not finite.
    /// @param slope  slope[c][k]: d out[c] / d in[k]
    void run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
             const std::array<std::array<double*, 3>, 3>& slope, std::size_t count) const;

  private:
    struct Step {
        TapeInstruction instruction;
        std::size_t out = 0;  // rows of a value: itself and three derivatives
        std::array<std::size_t, 3> in{};
        unsigned inputs = 0;                       // that it moves with, a bit for each
        std::array<unsigned, 3> operand_inputs{};  // that its operands move with
    };

    Tape tape_;
    std::vector<Step> steps_;
    std::array<std::size_t, 3> outputs_{};
    std::size_t register_count_ = 0;
};

TONEWRIGHT_NAMESPACE_END
