// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ocio/lowered_op.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A pipeline as OpenColorIO operations.
struct Lowered {
    LoweredOps ops;
    /// False if a stage had to be sampled into a 3D LUT; otherwise only float32 rounding and the
    /// linear interpolation between neighboring half floats separate it from the reference.
    bool is_exact = true;
    /// True if a 3D LUT replaces a stage that accepts negatives; it reads them as 0.
    bool loses_negatives = false;
    /// For reports: "matrix, range, half LUT, range".
    std::string summary;
};

struct LowerOptions {
    int cube_edge = 65;
    /// 3D LUTs of channel-mixing stages are optimized for colors of these primaries and of Rec.709.
    Primaries primaries = kRec709;
    /// Fits the nodes of these LUTs for the least error between them, which takes seconds;
    /// otherwise samples them.
    bool fits_cubes = false;
    /// Folder that keeps fitted nodes. @see cached_numbers
    std::string cache_folder = {};
};

/// Lowers stage by stage, by the kind of the stage:
///
/// matrix -> matrix; clamp -> range, never baked into a table; every run of neighboring curves ->
/// one half-domain 1D LUT of 65536 entries, stored unclamped; a tone scale -> OpenColorIO's fixed
/// function if it equals one, otherwise a matrix to (R/2, L, B), xyY (or HSV for the largest
/// channel), a half LUT on the norm, and the inverses; a hue-preserving curve -> a half LUT with
/// hue adjustment (a 3D LUT if the curve falls); a hexcone stage -> HSV, half LUTs of logarithms
/// with matrices that add one channel to the other, and inverse HSV; a channel-mixing stage ->
/// OpenColorIO's fixed functions if it equals some, otherwise a shaper with a linear toe, a
/// tetrahedral 3D LUT of unclipped smooth output, and the decoding; a Grid -> a half LUT of its
/// shaper and the same 3D LUT. Native log, power and sRGB operations are not used: OCIO builds with
/// SSE evaluate them with 15 bits, and OCIO's sRGB is 1e-5 off IEC 61966-2-1.
///
/// @throws Error  when a stage has no lowering.
[[nodiscard]] TONEWRIGHT_API Lowered lower_to_ocio(const Pipeline& pipeline,
                                                   const LowerOptions& options = {});

TONEWRIGHT_NAMESPACE_END
