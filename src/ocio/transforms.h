// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <cstddef>

#include "ocio/lowered_op.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace OCIO = OCIO_NAMESPACE;

[[nodiscard]] TONEWRIGHT_API OCIO::TransformRcPtr to_ocio(const LoweredOp& op);
[[nodiscard]] TONEWRIGHT_API OCIO::GroupTransformRcPtr to_ocio(const LoweredOps& ops);

/// Appends the transforms of the operations.
void append(OCIO::GroupTransformRcPtr& group, const LoweredOps& ops);

/// A processor from a config without caches: OCIO's processor cache distinguishes in-memory LUTs
/// only by size.
[[nodiscard]] TONEWRIGHT_API OCIO::ConstProcessorRcPtr make_processor(
    const OCIO::ConstTransformRcPtr& transform);
[[nodiscard]] TONEWRIGHT_API OCIO::ConstProcessorRcPtr make_processor(const LoweredOps& ops);

/// Runs OCIO's CPU path.
class TONEWRIGHT_API OcioCpu {
  public:
    OcioCpu(const OCIO::ConstProcessorRcPtr& processor,
            OCIO::OptimizationFlags flags = OCIO::OPTIMIZATION_DEFAULT);
    /// Interleaved RGB float.
    void run_rgb(const float* in, float* out, std::size_t pixel_count) const;

  private:
    OCIO::ConstCPUProcessorRcPtr cpu_;
};

TONEWRIGHT_NAMESPACE_END
