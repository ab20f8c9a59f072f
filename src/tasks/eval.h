// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "tonewright/lut_file.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Maps interleaved RGB triplets.
using ColorMap = std::function<void(const double* in, double* out, std::size_t count)>;

/// The reference computes in double precision, the others in single.
enum class EvalEngine : unsigned char { reference, simd, ocio, ocio_gpu };

/// Colors through an operator.
struct EvalRequest {
    View view;
    /// Display colors to scene-linear.
    bool is_inverse = false;
    EvalEngine engine = EvalEngine::reference;
    /// For fitted tables; empty: they are not kept.
    std::string cache_folder = {};
};
/// @throws Error  the engine cannot run; a view without an inverse
[[nodiscard]] ColorMap color_map(const EvalRequest& request);
/// The steps of the SIMD engine, one a line.
/// @throws Error  a view without an inverse
[[nodiscard]] std::string explain(const EvalRequest& request);

/// Colors through stages, which may be empty, and then a LUT.
[[nodiscard]] ColorMap color_map(LutFile lut, const Pipeline& before);

TONEWRIGHT_NAMESPACE_END
