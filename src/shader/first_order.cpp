// SPDX-License-Identifier: Apache-2.0
#include "shader/first_order.h"

#include <algorithm>
#include <cmath>

#include "engine/precision.h"
#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Half a unit in the last place of 1 in float.
constexpr double kHalfUlp = 0x1p-24;
/// What measure_influence() gives where a derivative has no end.
constexpr double kPole = 1e12;

/// Errors of single operations, absolute.
struct Rounding {
    double once = 0;
    double vulkan = 0;
};

/// Vulkan 1.3 specification, "Precision and Operation of SPIR-V Instructions", and WGSL
/// (W3C, 2024), 15.7.4.1 "Floating Point Accuracy", which takes the same bounds.
Rounding rounding_of(const TapeInstruction& step, double value, double a, double b) {
    const double once = std::fabs(value) * kHalfUlp;
    const double ulp = 2 * once;
    switch (step.op) {
        case ExprOp::constant:
        case ExprOp::add:
        case ExprOp::subtract:
        case ExprOp::multiply:
            return {once, once};
        case ExprOp::divide:
            return {once, 2.5 * ulp};
        case ExprOp::square_root:  // 1 / inversesqrt(x): 2 ULP, and the division
            return {once, 4.5 * ulp};
        case ExprOp::exp2:
            return {once, (3 + 2 * std::fabs(a)) * ulp};
        case ExprOp::log2:
            return {once, a >= 0.5 && a <= 2 ? 0x1p-21 : 3 * ulp};
        case ExprOp::power: {  // exp2(y * log2(x))
            const double logarithm = a > 0 ? std::log2(a) : 0;
            const double of_log =
                a >= 0.5 && a <= 2 ? 0x1p-21 : 6 * kHalfUlp * std::fabs(logarithm);
            const double exponent = b * logarithm;
            const double of_exponent = std::fabs(b) * of_log + std::fabs(exponent) * kHalfUlp;
            return {once, (3 + 2 * std::fabs(exponent)) * ulp +
                              std::fabs(value) * 0.69314718055994531 * of_exponent};
        }
        case ExprOp::sine:
        case ExprOp::cosine:  // within [-pi, pi]
            return {once, 0x1p-11};
        case ExprOp::atan2:
            return {once, 4096 * ulp};
        case ExprOp::lookup:  // the place, the difference of samples, the product, the sum
            return {3 * once, 3 * once};
        case ExprOp::lattice:  // nodes, weights, and a sum of four products
            return {4 * once, 4 * once};
        default:  // the result is one of the operands, or a whole number
            return {};
    }
}

}  // namespace

FirstOrderError first_order_error(const std::array<Expr, 3>& outputs) {
    const Tape tape(outputs);
    const std::vector<TapeInstruction>& code = tape.code();
    const Sensitivity probes = measure_influence(code, tape.outputs());
    FirstOrderError worst;
    for (std::size_t p = 0; p < probes.value.size(); ++p) {
        const std::vector<double>& value = probes.value[p];
        FirstOrderError sum;
        bool has_pole = false;
        for (std::size_t i = 0; i < code.size(); ++i) {
            const Rounding error =
                rounding_of(code[i], value[i], value[code[i].a], value[code[i].b]);
            // A constant that float has exactly is exact.
            if (code[i].op == ExprOp::constant &&
                static_cast<double>(static_cast<float>(value[i])) == value[i])
                continue;
            const bool is_place = code[i].op == ExprOp::lookup || code[i].op == ExprOp::lattice;
            const std::array<std::uint32_t, 3> operands = {code[i].a, code[i].b, code[i].c};
            // The place in a table is a product: another rounding of what it is read with.
            for (int k = 0; is_place && k < operand_count(code[i].op); ++k) {
                const std::uint32_t operand = operands[static_cast<std::size_t>(k)];
                const double of_place =
                    std::fabs(value[operand]) * kHalfUlp * probes.sensitivity[p][operand];
                sum.rounded_once += of_place;
                sum.vulkan += of_place;
            }
            has_pole = has_pole || probes.sensitivity[p][i] >= kPole;
            sum.rounded_once += error.once * probes.sensitivity[p][i];
            sum.vulkan += error.vulkan * probes.sensitivity[p][i];
        }
        // At a pole, such as a root of 0, first order says nothing.
        if (has_pole) continue;
        worst.rounded_once = std::max(worst.rounded_once, sum.rounded_once);
        worst.vulkan = std::max(worst.vulkan, sum.vulkan);
    }
    return worst;
}

TONEWRIGHT_NAMESPACE_END
