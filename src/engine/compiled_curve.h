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

/// The first float that is not before x.
[[nodiscard]] float float_from(double x) noexcept;

/// What a curve may be wrong by, where its result is y: units of 2^-24 |y|, but at least a floor,
/// which depends on the exponent of x.
struct CurveTolerance {
    static constexpr int kExponents = 256;  // of floats

    double half_ulps = 3;  // of a float's; 1 is the rounding of a result
    std::array<float, kExponents> floor{};

    [[nodiscard]] double at(double x, double y) const noexcept;
    [[nodiscard]] static std::size_t exponent_of(double x) noexcept;
};

/// How a compiled curve finds the polynomial of a number: what is fast differs between processors.
enum class CurveForm : std::uint8_t {
    none,
    segments,  // few and long, for permutes over whole tables (AVX-512): no branch and no gather
    rows,      // many and short, for loads of neighboring numbers (AVX2, NEON)
    rows_unfused,  // the same with products and sums rounded one by one (SSE4)
};

/// A curve in the form of rows: the bits of x as a whole number, minus `base` and without the last
/// `shift`, are its cell, and the polynomial of a cell is in t = (x - x0) scale, where x0 is the
/// float that the cell begins with and scale the power of two that brings x0 into [1, 2): neither
/// takes a number of the row, and t is exact. Below `base`, cell 0.
struct CurveRows {
    static constexpr int kMaxRows = 1024;
    /// At a kink cells begin anew: from the float with the bits `from` on, `base` is this one.
    struct Restart {
        std::uint32_t from;
        std::uint32_t base;
    };

    std::uint32_t base = 0;
    int shift = 0;
    bool is_fused = true;
    /// Coefficients from the constant on in a row, 4 or 8. Of a precise curve the second is what is
    /// missing in the first.
    int length = 4;
    std::vector<float> numbers;
    std::vector<Restart> restarts;  // rising

    /// Of the cells of a number that is not below `base`, given by its bits.
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
/// Segments: x is limited to [lo, hi]. Its exponent, or that and the first bits of its fraction, is
/// the cell. A cell has at most one segment boundary inside, `threshold`: before it lies
/// `segment[cell]`, from it on the next one. A segment may span many cells. Where boundaries are
/// too near together for that, or too many octaves apart, there are no cells: `threshold` is where
/// each segment begins, rising, filled up with infinity, and the segment is searched for. The
/// polynomial of a segment is in t = x scale + offset, within [-1, 1].
struct CompiledCurve {
    static constexpr int kMaxCells = 64;
    static constexpr int kMaxSegments = 64;
    static constexpr int kMinDegree = 3;
    static constexpr int kMaxDegree = 9;

    float lo = 0;
    float hi = 0;
    /// The result at lo, and before it: black is black exactly. Kernels give a precise curve's as
    /// the sum of two floats.
    double at_lo = 0;
    /// The least and the largest result, where the function has such ends.
    float least = 0;
    float most = 0;
    /// Below this, cell 0.
    float cell_floor = 0;
    int shift = 23;  // of the bits of x, to its cell
    std::uint32_t first_cell = 0;
    int cells = 0;     // as many as are filled: 0 (see above), 32 or 64
    int segments = 0;  // likewise: 16, 32 or 64
    int degree = 0;
    alignas(64) std::array<float, kMaxCells> threshold{};
    alignas(64) std::array<std::int32_t, kMaxCells> segment{};
    alignas(64) std::array<float, kMaxSegments> scale{};
    alignas(64) std::array<float, kMaxSegments> offset{};
    alignas(64) std::array<std::array<float, kMaxSegments>, kMaxDegree + 1> coefficient{};
    /// What is missing in the first coefficients; of a precise curve.
    alignas(64) std::array<float, kMaxSegments> rest{};

    /// The other form. Where it is there, nothing is said of cells and segments.
    std::optional<CurveRows> rows;

    /// Takes and gives doubles. x and the first coefficient count with all their digits, and only
    /// the change within a segment is computed in float.
    bool is_precise = false;
    CurveTolerance tolerance;

    /// As the kernels compute it: in float with fused multiply-adds.
    [[nodiscard]] double operator()(double x) const noexcept;
    [[nodiscard]] double slope(double x) const noexcept;

    /// Where each segment begins, rising.
    /// @pre the form is segments
    [[nodiscard]] std::vector<float> segment_begins() const;

    /// In instructions a vector, roughly.
    [[nodiscard]] int cost() const noexcept;

    /// @pre the form is segments
    [[nodiscard]] std::size_t segment_of(float x) const noexcept;
};

/// Replaces each number x by f(x).
using CurveFunction = std::function<void(std::span<double>)>;

/// The cheapest such curve that is within the tolerance of f, measured in float at many places of
/// every segment, and at and beside every kink. Nothing when there is none: f is no function of
/// that kind (it has values below 0 that matter, too many kinks, a pole...).
/// @param form  not `none`
/// @param is_precise  see CompiledCurve
/// @param range  of x. Above 0 all of it counts; below 0, f has to be f(0).
/// @param kinks  where f is not smooth, rising; those that do not show cost nothing
[[nodiscard]] std::optional<CompiledCurve> compile_curve(const CurveFunction& f,
                                                         std::array<double, 2> range,
                                                         std::span<const double> kinks,
                                                         const CurveTolerance& tolerance,
                                                         CurveForm form, bool is_precise = false);

TONEWRIGHT_NAMESPACE_END
