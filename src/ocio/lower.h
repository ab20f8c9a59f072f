// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ocio/lowered_op.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A pipeline as operations that OpenColorIO has.
struct Lowered {
    LoweredOps ops;
    /// False when a part had to be sampled into a 3D LUT; otherwise only float32 rounding and the
    /// linear interpolation between neighboring half floats separate it from the reference.
    bool is_exact = true;
    /// True when a 3D LUT stands where the pipeline would take negatives: it sees them as 0.
    bool loses_negatives = false;
    /// For reports: "matrix, range, half LUT, range".
    std::string summary;
};

struct LowerOptions {
    int cube_edge = 65;
    /// 3D LUTs of channel-mixing stages are made for colors of these primaries and of Rec.709.
    Primaries primaries = kRec709;
    /// The nodes of these LUTs are fitted for the least error between them, which takes seconds;
    /// else sampled.
    bool fits_cubes = false;
};

/// Lowers stage by stage; the kind of a stage alone decides:
///
/// matrix -> matrix; clamp -> range, never baked into a table; every run of neighboring curves ->
/// one half-domain 1D LUT of 65536 entries, stored unclamped; a tone scale -> OpenColorIO's fixed
/// function where it equals one, else a matrix to (R/2, L, B), xyY (or HSV for the largest
/// channel), a half LUT on the norm, and back; a hue-preserving curve -> a half LUT with hue
/// adjustment (a 3D LUT if the curve falls); a hexcone stage -> HSV, half LUTs of logarithms with
/// matrices that add one channel to the other, and back; a channel-mixing stage -> OpenColorIO's
/// fixed functions where it equals some, else a shaper with a linear toe, a tetrahedral 3D LUT of
/// unclipped smooth output, and the decoding; a lattice -> a half LUT of its shaper and the same 3D
/// LUT. Native log, power and sRGB operations are not used: OCIO builds with SSE evaluate them with
/// 15 bits, and OCIO's sRGB is 1e-5 off IEC 61966-2-1.
///
/// @throws Error  when a stage has no lowering.
[[nodiscard]] TONEWRIGHT_API Lowered lower_to_ocio(const Pipeline& pipeline,
                                                   const LowerOptions& options = {});

TONEWRIGHT_NAMESPACE_END
