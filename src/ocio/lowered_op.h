// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

// Lowering produces these operations. They only hold numbers and names: to_ocio() converts them to
// OpenColorIO transforms, and LutFiles writes their tables as LUT files.

/// y = m x + offset.
struct MatrixOp {
    Matrix3 m;
    Vector3 offset{};
};

/// min(max(x, lo), hi) per channel; an infinite end is open.
struct RangeOp {
    double lo;
    double hi;
};

/// A 1D table of each channel, linear between its entries, which are at the half floats in the
/// order of their bit patterns, or at equal distances over [0, 1].
struct Lut1DOp {
    int channels;               // 1: one table for all channels, or 3
    std::vector<float> values;  // entry by entry
    bool is_half_domain = true;
    /// Only looks up the largest and the smallest channel; the middle one keeps its relative
    /// position. OpenColorIO calls this hue adjustment DW3.
    bool keeps_hue = false;
    /// @see ClfTable::slack
    std::vector<signed char> slack = {};

    [[nodiscard]] int size() const { return static_cast<int>(values.size()) / channels; }
};

/// A 3D LUT over [0, 1] with tetrahedral interpolation.
struct Lut3DOp {
    int edge;
    std::vector<float> values;  // RGB triplets, blue fastest
    double unit = 1e-4;         // that files may round the values to
};

/// One of OpenColorIO's FixedFunctionTransforms.
struct FixedFunctionOp {
    std::string style;  // "ACES_Glow10"
    std::vector<double> parameters = {};
};

/// One of OpenColorIO's BuiltinTransforms.
struct BuiltinOp {
    std::string style;
};

struct LoweredOp {
    std::variant<MatrixOp, RangeOp, Lut1DOp, Lut3DOp, FixedFunctionOp, BuiltinOp> op;
    bool is_inverse = false;
};
using LoweredOps = std::vector<LoweredOp>;

/// One table if the three are equal, else three.
/// @param slack  of each; empty: none
[[nodiscard]] Lut1DOp lut_1d(const std::array<std::vector<float>, 3>& channels,
                             const std::array<std::vector<signed char>, 3>& slack = {});

/// The operations in reverse order, each inverted.
[[nodiscard]] TONEWRIGHT_API LoweredOps inverse(LoweredOps ops);

/// Appends `more` to `ops`.
void append(LoweredOps& ops, LoweredOps more);

TONEWRIGHT_NAMESPACE_END
