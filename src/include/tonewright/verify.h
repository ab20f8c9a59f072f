// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What to compare with the reference.
struct VerifyOptions {
    /// As resolve_operator() takes them. Empty or `all`: every operator, preset and look. Empty,
    /// with a config: those that it has views of.
    std::vector<std::string> operators;
    /// Empty = sRGB; of a config without operators named, all that it has.
    std::vector<std::string> displays;
    std::string input = "lin_rec709";
    /// A config to check, or its folder; empty = a fresh one, written to a temporary folder and
    /// read back.
    std::string config;
    /// Grid points a side of the gamut lattices.
    int lattice_edge = 33;
    /// Random colors; colors near black and with negative channels in proportion.
    std::size_t random_count = 100000;
    /// OpenColorIO's GPU path, and shaders.
    bool with_gpu = true;
    /// Languages to run shaders of, as shader_languages() names them. Empty or `all`: each that
    /// something on this machine can run. `none`.
    std::vector<std::string> shaders;
    /// Our engine only with the instruction set that it takes on this processor.
    bool only_best_target = false;
    /// Scene-linear RGB pixels to add to the sample set, in the input space.
    std::vector<float> picture;
    /// Operators that `operators` may name, and what reads LUTs.
    OperatorSet others;
};

/// Errors of one backend of one view against the double reference, in display code values.
struct ParityRow {
    std::string op;
    std::string display;
    /// "simd AVX3", "ocio cpu lossless", "ocio cpu default", "ocio gpu", or a shader's language
    std::string backend;
    /// For OpenColorIO: "config" or "chain", and the operations. For shaders: compiler or driver.
    std::string lowering;
    /// Colors with all channels >= 0.
    double max = 0, p999 = 0, mean = 0;
    /// Every color, negatives and mixed signs of thousands included.
    double max_all = 0;
    /// The largest error of the colors beyond the bound; 0 where there are none. Near black of a
    /// display with a pure power it is an error of light (times 12.92, sRGB's slope there), because
    /// the code value's own slope is infinite. With the mixed metric only what exceeds float32
    /// rounding counts: the change of the exact result when each channel of the input, and of what
    /// enters each matrix with negative coefficients, moves by one float32 unit (2^-23 of its
    /// value; 2^-21 for the GPU, whose texture filtering rounds more often). Such matrices cancel,
    /// which no float32 backend can avoid.
    double max_beyond_rounding = 0;
    double bound = 0;
    /// True where a matrix of the chain has negative coefficients.
    bool is_mixed_metric = false;
    /// Every output finite and inside [0, 1], NaN and infinities going in. Of shaders without NaN:
    /// compilers may take it that there is none.
    bool is_total = true;
    bool is_ok = true;
    std::string note;  // why a backend is missing, or the worst color of a failure
};

/// A language or an application whose shaders are written but were not run.
struct NotExecuted {
    std::string name;
    std::string reason;
};

struct VerifyResult {
    std::vector<ParityRow> rows;
    /// Of the languages that were asked for; with all of them, what nothing can run, too.
    std::vector<NotExecuted> not_executed;
};

/// Shaders run on OpenGL and OpenGL ES through EGL, by the C compiler `$CC` (else cc, gcc, clang),
/// on OpenCL (DCTL), and on Dawn for Node.js (WGSL, HLSL) where TONEWRIGHT_NODE_MODULES names a
/// folder with the packages webgpu and naga-wasm.
/// @throws Error  unknown operators, displays, spaces, languages; FileError for the config folder.
[[nodiscard]] TONEWRIGHT_API VerifyResult
verify(const VerifyOptions& options, const std::function<void(const ParityRow&)>& on_row = {});

/// Lines of a table for the terminal: a heading, one row each.
[[nodiscard]] TONEWRIGHT_API std::string parity_heading();
[[nodiscard]] TONEWRIGHT_API std::string format_row(const ParityRow& row);
/// One line, with reasons behind names.
[[nodiscard]] TONEWRIGHT_API std::string format_not_executed(const std::vector<NotExecuted>& all);

TONEWRIGHT_NAMESPACE_END
