// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The smallest float that is not less than x.
[[nodiscard]] float float_from(double x) noexcept;

/// Allowed error of a curve at result y: half_ulps 2^-24 |y|, but at least the floor for the
/// exponent of x.
struct CurveTolerance {
    static constexpr int kExponents = 256;  // that a float can have

    double half_ulps = 3;  // 1 is the error of rounding the result to float
    std::array<float, kExponents> floor{};

    [[nodiscard]] double at(double x, double y) const noexcept;
    [[nodiscard]] static std::size_t exponent_of(double x) noexcept;
};

/// Layout of a compiled curve. The fastest one depends on the instruction set.
enum class CurveForm : std::uint8_t {
    none,
    segments,      // few long segments, read by permutes of whole tables (AVX-512)
    rows,          // many short cells, each a row of adjacent coefficients (AVX2, NEON)
    rows_unfused,  // rows without fused multiply-add (SSE4)
};

/// A curve as rows of coefficients, one row for each cell. The cell of x is (bits of x - base) >>
/// shift. The polynomial of a cell is in t = (x - x0) scale, where x0 is the first float of the
/// cell and scale the power of two that brings x0 into [1, 2). x0 and scale follow from the bits of
/// x, so the row stores only coefficients, and t is exact. An x below `base` is in cell 0.
struct CurveRows {
    static constexpr int kMaxRows = 1024;
    /// A kink at which cells begin anew. From the float with the bits `from` on, this `base`
    /// counts.
    struct Restart {
        std::uint32_t from;
        std::uint32_t base;
    };

    std::uint32_t base = 0;
    int shift = 0;
    bool is_fused = true;
    /// Numbers in a row, 4 or 8: the coefficients, the constant one first. In a precise curve, the
    /// second number is the rounding error of the first.
    int length = 4;
    std::vector<float> numbers;
    std::vector<Restart> restarts;  // ascending

    /// The base that counts for the float with these bits, which is not below `base`.
    [[nodiscard]] std::uint32_t base_of(std::uint32_t bits) const noexcept;
    struct Place {
        const float* row;
        float x0;
        float scale;
    };
    [[nodiscard]] Place find(float x) const noexcept;
    [[nodiscard]] static float scale_of(float x0) noexcept;
};

/// A function of one variable as polynomials in float, over segments or in rows.
///
/// Segments: x is limited to [lo, hi]. The cell of x is its exponent, or its exponent and the first
/// bits of its fraction. A cell has at most one segment boundary inside, `threshold`: an x below it
/// is in `segment[cell]`, and any other x in the next segment. A segment may span many cells. If
/// boundaries are too close together for that, or too many octaves apart, the curve has no cells.
/// Then `threshold` holds the start of each segment in ascending order, filled up with infinity,
/// and a binary search finds the segment. The polynomial of a segment is in t = x scale + offset,
/// within [-1, 1].
struct CompiledCurve {
    static constexpr int kMaxCells = 64;
    static constexpr int kMaxSegments = 64;
    static constexpr int kMinDegree = 3;
    static constexpr int kMaxDegree = 9;

    float lo = 0;
    float hi = 0;
    /// Result up to lo, so that black is exact. For a precise curve, kernels compute it as the sum
    /// of two floats.
    double at_lo = 0;
    /// Bounds of the result; the range of float if the function has no such bounds.
    float least = 0;
    float most = 0;
    /// An x below this is in cell 0.
    float cell_floor = 0;
    int shift = 23;  // the bits of x >> shift are its cell, counted from first_cell
    std::uint32_t first_cell = 0;
    int cells = 0;     // 0 (no cells), 32 or 64: the arrays are filled up
    int segments = 0;  // 16, 32 or 64: the arrays are filled up
    int degree = 0;
    alignas(64) std::array<float, kMaxCells> threshold{};
    alignas(64) std::array<std::int32_t, kMaxCells> segment{};
    alignas(64) std::array<float, kMaxSegments> scale{};
    alignas(64) std::array<float, kMaxSegments> offset{};
    alignas(64) std::array<std::array<float, kMaxSegments>, kMaxDegree + 1> coefficient{};
    /// Rounding errors of the constant coefficients, in a precise curve.
    alignas(64) std::array<float, kMaxSegments> rest{};

    /// The curve in the form of rows. If set, the members for cells and segments are unused.
    std::optional<CurveRows> rows;

    /// True: x and the result are doubles. x and the constant coefficient count in full precision,
    /// and only the change within a segment or cell is computed in float.
    bool is_precise = false;
    CurveTolerance tolerance;

    /// The result, with the arithmetic of the kernels.
    [[nodiscard]] double operator()(double x) const noexcept;
    [[nodiscard]] double slope(double x) const noexcept;

    /// Start of each segment, ascending.
    /// @pre the form is segments
    [[nodiscard]] std::vector<float> segment_begins() const;

    /// Approximate cost in instructions per vector.
    [[nodiscard]] int cost() const noexcept;

    /// @pre the form is segments
    [[nodiscard]] std::size_t segment_of(float x) const noexcept;
};

/// Replaces each number x by f(x).
using CurveFunction = std::function<void(std::span<double>)>;

/// Fits the cheapest curve that is within the tolerance of f, measured in float at many points of
/// every segment or cell, and at and beside every kink.
/// @param form  not `none`
/// @param is_precise  see CompiledCurve
/// @param range  of x. Below 0, f must be f(0)
/// @param kinks  the x at which f is not smooth, ascending; kinks within the tolerance cost nothing
/// @return  nullopt if no curve fits: f is not f(0) below 0, or has too many kinks, a pole, ...
[[nodiscard]] std::optional<CompiledCurve> compile_curve(const CurveFunction& f,
                                                         std::array<double, 2> range,
                                                         std::span<const double> kinks,
                                                         const CurveTolerance& tolerance,
                                                         CurveForm form, bool is_precise = false);

TONEWRIGHT_NAMESPACE_END
