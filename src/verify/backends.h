// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "ocio/lower.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace OCIO = OCIO_NAMESPACE;

/// Maps interleaved RGB triplets.
using ColorRun = std::function<void(const float* in, float* out, std::size_t count)>;

struct BackendInput {
    const View& view;
    /// The stages of the view, or of its inverse.
    const Pipeline& pipeline;
    /// OpenColorIO's backends run it; null: they lower the pipeline.
    OCIO::ConstProcessorRcPtr processor = nullptr;
    /// @see LowerOptions
    std::string cache_folder = {};
};

/// Limit of the error of a backend, in code values of the display.
struct BackendBound {
    double error;
    /// An operator declares it, with a reason.
    bool is_declared = false;
    /// @see ParityRow::is_mixed_metric
    bool is_mixed_metric = false;
};

/// Bounds from the structure of a chain; an operator may declare others.
struct BackendBounds {
    BackendBound simd{1e-6};
    BackendBound cpu{3e-7};
    /// A rasterizer in software, which filters with float weights.
    BackendBound gpu{1e-6};
    /// OpenColorIO's own transform, in float32 throughout, not our lowering.
    BackendBound builtin{1e-3, false, true};
    /// Limited only by the display, because Blender chose the precision.
    BackendBound half_textures{1};
};
[[nodiscard]] TONEWRIGHT_API BackendBounds backend_bounds(const View& view,
                                                          const Pipeline& pipeline,
                                                          const Lowered& lowered);

/// A float32 backend cancels in such a matrix.
[[nodiscard]] bool has_negative_coefficient(const Matrix3& m);

/// A way to compute a view in single precision.
struct Backend {
    enum class Id : unsigned char {
        simd,
        ocio_cpu_lossless,
        ocio_cpu,
        ocio_builtin,
        half_textures,
        ocio_gpu,
        lut,
    };
    Id id;
    /// In the parity table; that of the engine is followed by an instruction set.
    std::string name;
    /// On the report's page; empty: it is not there.
    std::string title;
    /// Null: the parity table does not have it.
    BackendBound BackendBounds::*bound;
    /// @returns  null if the view has no such backend
    /// @throws Error  if it cannot run
    ColorRun (*start)(const BackendInput& input);
};

/// All of them, in the order of the parity table.
[[nodiscard]] TONEWRIGHT_API const std::vector<Backend>& all_backends();
[[nodiscard]] TONEWRIGHT_API const Backend& find_backend(Backend::Id id);

TONEWRIGHT_NAMESPACE_END
