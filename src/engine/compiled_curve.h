// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace tonewright {

/// A function of one float as polynomials: one or two for each octave, in tables of 32 entries,
/// which is what two vector registers of AVX-512 hold and one instruction looks up.
///
/// y(x) = sum of coefficient[k][s] u^k, u = x 2^-e - 1.5, with e the exponent of x, at least
/// `lowest_exponent`, and s = segment[e mod 32], one more where x >= boundary[e mod 32].
/// Below and at 0 y is `at_zero`, above `highest` it is y(highest).
struct CompiledCurve {
    static constexpr std::size_t kEntries = 32;
    static constexpr std::size_t kDegree = 7;

    std::array<std::array<float, kEntries>, kDegree + 1> coefficient{};
    std::array<float, kEntries> boundary{};
    std::array<std::int32_t, kEntries> segment{};
    int lowest_exponent = 0;
    float highest = 0;
    float at_zero = 0;

    /// What the vector code computes, one value at a time.
    [[nodiscard]] float operator()(float x) const noexcept;
};

/// A function to compile, with the sides that its branches (min, max, select, ...) take as bits:
/// where they change, a polynomial has to end.
struct CurveValue {
    double y;
    std::uint64_t sides;
};
using CurveFunction = std::function<CurveValue(double x)>;

/// @param f          constant below 0.
/// @param x_max      largest value that x takes.
/// @param tolerance  of y where x has the given exponent.
/// @returns          nothing when the tables do not hold f so exactly: checked in float, with x all
///                   over the domain.
[[nodiscard]] std::optional<CompiledCurve> compile_curve(
    const CurveFunction& f, double x_max, const std::function<double(int exponent)>& tolerance);

}  // namespace tonewright
