// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "engine/tape.h"
#include "shader/program.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Grids of a program -> Grids with the nodes that a text reads, such as half floats. A Grid that
/// is not in the map has its own nodes.
using GridsInText = std::map<const Grid*, std::shared_ptr<const Grid>>;

/// Runs a program in float: every operation is rounded once, with the math functions of the C
/// library, which are accurate to a unit in the last place. GPUs are less accurate.
class FloatRun {
  public:
    /// @pre the program has no uniforms
    explicit FloatRun(const ShaderProgram& program, GridsInText grids = {});

    /// Interleaved RGB; in and out may be equal.
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const;

  private:
    Tape tape_;
    GridsInText grids_;
};

TONEWRIGHT_NAMESPACE_END
