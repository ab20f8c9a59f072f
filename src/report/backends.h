// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Output of one backend for some colors, in code values of the view's display.
struct BackendResult {
    std::string name;
    /// Interleaved RGB; empty where the backend did not run.
    std::vector<float> shown;
    std::string reason = {};  // the reason why it did not run
};

/// The engine, OpenColorIO's CPU and GPU paths, and a LUT as applications interpolate it.
/// @param rgb           interleaved, scene-linear in the view's input space
/// @param cache_folder  @see LowerOptions
[[nodiscard]] std::vector<BackendResult> run_backends(const View& view,
                                                      const std::vector<float>& rgb,
                                                      const std::string& cache_folder);

TONEWRIGHT_NAMESPACE_END
