// SPDX-License-Identifier: Apache-2.0
#include "shader/first_order.h"

#include <algorithm>
#include <cmath>

#include "engine/precision.h"
#include "engine/tape.h"
#include "shader/rounding.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Result of measure_sensitivity() for infinite derivatives.
constexpr double kPole = 1e12;

}  // namespace

FirstOrderError first_order_error(const std::array<Expr, 3>& outputs,
                                  const std::map<const Grid*, double>& of_nodes) {
    const Tape tape(outputs);
    const std::vector<TapeInstruction>& code = tape.code();
    const Sensitivity probes = measure_sensitivity(code, tape.outputs());
    FirstOrderError worst;
    std::vector<double> value(code.size());
    for (std::size_t p = 0; p < probes.value[0].size(); ++p) {
        for (std::size_t i = 0; i < code.size(); ++i)
            value[i] = probes.value[i][p];
        FirstOrderError sum;
        bool has_pole = false;
        for (std::size_t i = 0; i < code.size(); ++i) {
            const double a = value[code[i].a];
            const double b = value[code[i].b];
            const Rounding error = rounding_of(code[i].op, value[i], {a, a}, {b, b});
            // A constant that float has exactly is exact.
            if (code[i].op == ExprOp::constant &&
                static_cast<double>(static_cast<float>(value[i])) == value[i])
                continue;
            const bool is_place = code[i].op == ExprOp::lookup || code[i].op == ExprOp::grid;
            const std::array<std::uint32_t, 3> operands = {code[i].a, code[i].b, code[i].c};
            // The position in a table is a product, which adds a rounding of the argument.
            for (int k = 0; is_place && k < operand_count(code[i].op); ++k) {
                const std::uint32_t operand = operands[static_cast<std::size_t>(k)];
                const double of_place =
                    std::fabs(value[operand]) * kHalfUlp * probes.sensitivity[operand][p];
                sum.rounded_once += of_place;
                sum.vulkan += of_place;
            }
            has_pole = has_pole || probes.sensitivity[i][p] >= kPole;
            sum.rounded_once += error.once * probes.sensitivity[i][p];
            sum.vulkan += error.vulkan * probes.sensitivity[i][p];
            const auto of_node = of_nodes.find(code[i].grid);
            if (of_node != of_nodes.end()) sum.vulkan += of_node->second * probes.sensitivity[i][p];
        }
        // At a pole, such as a root of 0, first order gives no estimate.
        if (has_pole) continue;
        worst.rounded_once = std::max(worst.rounded_once, sum.rounded_once);
        worst.vulkan = std::max(worst.vulkan, sum.vulkan);
    }
    return worst;
}

TONEWRIGHT_NAMESPACE_END
