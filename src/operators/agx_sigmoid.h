// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "tonewright/pipeline.h"

/// Shared by the dialects of AgX: Blender's matrices and the curve, for expressions and, to compute
/// the nodes of 3D LUTs, for double.
TONEWRIGHT_NAMESPACE_BEGIN

// clang-format off
/// Blender's inset and outset, for Rec.2020. The outset is the inverse of a different inset.
inline constexpr Matrix3 kAgxInsetRec2020 = {{
    {0.856627153315983, 0.0951212405381588, 0.0482516061458583},
    {0.137318972929847, 0.761241990602591,  0.101439036467562},
    {0.11189821299995,  0.0767994186031903, 0.811302368396859}}};
inline constexpr Matrix3 kAgxOutsetRec2020 = {{
    { 1.1271005818144368, -0.1106066430966033, -0.0164939387178346},
    {-0.1413297634984383,  1.1578237022162718, -0.0164939387178343},
    {-0.1413297634984383, -0.1106066430966029,  1.2519364065950402}}};
// clang-format on

// Functions of Expr for double, so that one formula serves both.
inline double min(double a, double b) { return b < a ? b : a; }
inline double max(double a, double b) { return a < b ? b : a; }
inline double pow(double base, double exponent) { return std::pow(base, exponent); }
inline double exp2(double a) { return std::exp2(a); }
inline double log2(double a) { return std::log2(a); }
inline double named(const char* /*name*/, double a) { return a; }

/// a < b ? below() : above()
template <class Below, class Above>
Expr if_less(const Expr& a, const Expr& b, const Below& below, const Above& above) {
    return select(less(a, b), below(), above());
}
template <class Below, class Above>
double if_less(double a, double b, const Below& below, const Above& above) {
    return a < b ? below() : above();
}

/// The SB2383 sigmoid: two hyperbolic arms that meet in the pivot (px, py) with a slope.
class AgxSigmoid {
  public:
    AgxSigmoid(double px, double py, double slope, double toe_power, double shoulder_power)
        : px_(px),
          py_(py),
          slope_(slope),
          toe_power_(toe_power),
          shoulder_power_(shoulder_power),
          toe_(-arm_scale(px, py, slope, toe_power)),
          shoulder_(arm_scale(1 - px, 1 - py, slope, shoulder_power)) {}

    /// Scale of an arm that ends lx and ly from the pivot.
    [[nodiscard]] static double arm_scale(double lx, double ly, double k, double p) {
        return std::pow(std::pow(k * lx, -p) * (std::pow(k * lx / ly, p) - 1), -1 / p);
    }

    /// Maps a normalized log value: 0 -> 0, px -> py, 1 -> 1.
    template <class T>
    [[nodiscard]] T operator()(const T& n) const {
        const auto arm = [&](double s, double p) -> T {
            // This arm does not apply on the other side of the pivot.
            const T u = named("u", max(slope_ * (n - px_) / s, 0));
            return s * (u / pow(1 + pow(u, p), 1 / p)) + py_;
        };
        return if_less(
            n, T(px_), [&] { return arm(toe_, toe_power_); },
            [&] { return arm(shoulder_, shoulder_power_); });
    }

  private:
    double px_, py_, slope_, toe_power_, shoulder_power_, toe_, shoulder_;
};

TONEWRIGHT_NAMESPACE_END
