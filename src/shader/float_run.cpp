// SPDX-License-Identifier: Apache-2.0
#include "shader/float_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Like the printed functions.
float look_up(const Table& table, float x) {
    const auto at = [&](std::size_t i) { return static_cast<float>(table.samples[i]); };
    const std::size_t n = table.samples.size();
    if (n == 1) return at(0);
    const bool is_step = table.interpolation == Table::Interpolation::step;
    if (table.positions.empty()) {
        const float t = std::min(std::max(x, 0.0F), 1.0F);
        const float place = t * static_cast<float>(is_step ? n : n - 1);
        const auto i = std::min(static_cast<std::size_t>(place), is_step ? n - 1 : n - 2);
        if (is_step) return at(i);
        return at(i) + (place - static_cast<float>(i)) * (at(i + 1) - at(i));
    }
    const auto position = [&](std::size_t i) { return static_cast<float>(table.positions[i]); };
    std::size_t lo = 0;
    std::size_t hi = is_step ? n : n - 1;
    while (hi - lo > 1) {
        const std::size_t middle = (lo + hi) / 2;
        (x < position(middle) ? hi : lo) = middle;
    }
    if (is_step) return at(lo);
    const float t = (x - position(lo)) / (position(lo + 1) - position(lo));
    return at(lo) + std::min(std::max(t, 0.0F), 1.0F) * (at(lo + 1) - at(lo));
}

float operation(const TapeInstruction& step, const Grid* grid, float a, float b, float c) {
    switch (step.op) {
        case ExprOp::constant:
            return static_cast<float>(step.value);
        case ExprOp::add:
            return a + b;
        case ExprOp::subtract:
            return a - b;
        case ExprOp::multiply:
            return a * b;
        case ExprOp::divide:
            return a / b;
        case ExprOp::minimum:
            return b < a ? b : a;
        case ExprOp::maximum:
            return a < b ? b : a;
        case ExprOp::power:
            return std::pow(a, b);
        case ExprOp::atan2:
            return std::atan2(a, b);
        case ExprOp::less:
            return a < b ? 1.0F : 0.0F;
        case ExprOp::less_equal:
            return a <= b ? 1.0F : 0.0F;
        case ExprOp::equal:
            return a == b ? 1.0F : 0.0F;
        case ExprOp::negate:
            return -a;
        case ExprOp::absolute:
            return std::fabs(a);
        case ExprOp::square_root:
            return std::sqrt(a);
        case ExprOp::exp2:
            return std::exp2(a);
        case ExprOp::log2:
            return std::log2(a);
        case ExprOp::sine:
            return std::sin(a);
        case ExprOp::cosine:
            return std::cos(a);
        case ExprOp::floor:
            return std::floor(a);
        case ExprOp::select:
            return a != 0 ? b : c;
        case ExprOp::lookup:
            return look_up(*step.table, a);
        case ExprOp::grid:
            return static_cast<float>((*grid)(step.input, static_cast<double>(a),
                                              static_cast<double>(b), static_cast<double>(c)));
        case ExprOp::input:
        case ExprOp::uniform:
            break;
    }
    return 0;
}

}  // namespace

FloatRun::FloatRun(const ShaderProgram& program, GridsInText grids)
    : tape_(compose(program)), grids_(std::move(grids)) {}

void FloatRun::run_rgb(const float* in, float* out, std::size_t pixel_count) const {
    const std::vector<TapeInstruction>& code = tape_.code();
    // Runs each step for all colors of a block, so that the switch is evaluated once.
    constexpr std::size_t kBlock = 256;
    std::vector<std::array<float, kBlock>> value(code.size());
    for (std::size_t done = 0; done < pixel_count; done += kBlock) {
        const std::size_t count = std::min(kBlock, pixel_count - done);
        for (std::size_t i = 0; i < code.size(); ++i) {
            const TapeInstruction& step = code[i];
            const auto replaced = grids_.find(step.grid);
            const Grid* const grid = replaced == grids_.end() ? step.grid : replaced->second.get();
            for (std::size_t k = 0; k < count; ++k) {
                value[i][k] = step.op == ExprOp::input
                                  ? in[3 * (done + k) + static_cast<std::size_t>(step.input)]
                                  : operation(step, grid, value[step.a][k], value[step.b][k],
                                              value[step.c][k]);
            }
        }
        for (std::size_t k = 0; k < count; ++k) {
            for (std::size_t c = 0; c < 3; ++c)
                out[3 * (done + k) + c] = value[tape_.outputs()[c]][k];
        }
    }
}

TONEWRIGHT_NAMESPACE_END
