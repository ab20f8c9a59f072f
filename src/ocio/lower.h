// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <string>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace OCIO = OCIO_NAMESPACE;

/// A pipeline as OpenColorIO transforms.
struct Lowered {
    OCIO::GroupTransformRcPtr transform;
    /// False when a part had to be sampled into a 3D cube; otherwise only float32 rounding and the
    /// linear interpolation between neighbouring half floats separate it from the reference.
    bool is_exact = true;
    /// True when a cube stands where the pipeline would take negatives: it sees them as 0.
    bool loses_negatives = false;
    /// What was emitted, for reports: "matrix, range, half LUT, range".
    std::string summary;
};

struct LowerOptions {
    int cube_edge = 65;
    /// What a true cross-talk works in: cubes are fitted to colors of these and of Rec.709.
    Primaries primaries = kRec709;
};

/// Lowers stage by stage, asking each stage what it is (DESIGN of the project, "Lowering to OCIO"):
///
/// matrix -> MatrixTransform; clamp -> RangeTransform, never baked into a table; every run of
/// neighbouring curves -> one half-domain 1D LUT of 65536 entries, stored unclamped; a tone scale
/// -> a matrix to (R/2, L, B), xyY (or HSV for the largest channel), a half LUT on the norm, and
/// back; a hue-preserving curve -> a half LUT with OCIO's hueAdjust (a cube if the curve falls); a
/// hexcone stage -> HSV, half LUTs of logarithms with matrices that add one channel to the other,
/// and back; true cross-talk -> a shaper with a linear toe, a tetrahedral cube of unclipped smooth
/// output, and the decoding; a lattice -> a half LUT of its shaper and the same cube. Native log,
/// power and sRGB operations are not used: OCIO builds with SSE evaluate them with 15 bits, and
/// OCIO's sRGB is 1e-5 off IEC 61966-2-1.
///
/// @throws Error  when a stage has no lowering.
[[nodiscard]] TONEWRIGHT_API Lowered lower_to_ocio(const Pipeline& pipeline,
                                                   const LowerOptions& options = {});

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

/// A processor for a lowered pipeline, from a config without caches: OCIO's processor cache tells
/// in-memory LUTs apart by size alone.
[[nodiscard]] TONEWRIGHT_API OCIO::ConstProcessorRcPtr make_processor(const Lowered& lowered);

TONEWRIGHT_NAMESPACE_END
