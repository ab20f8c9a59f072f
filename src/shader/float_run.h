// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/tape.h"
#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A program in float: every operation rounded once, with the mathematical functions of the C
/// library, which are good to a unit in the last place. What a shader's text means; a GPU's
/// functions are less exact.
class FloatRun {
  public:
    /// @pre no uniform is left in the program
    explicit FloatRun(const ShaderProgram& program);

    /// Interleaved RGB; in and out may be the same.
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const;

  private:
    Tape tape_;
};

TONEWRIGHT_NAMESPACE_END
