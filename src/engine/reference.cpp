// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "engine/tape.h"
#include "expr/scalar_ops.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kTile = 256;  // pixels per pass: a tile of every value stays in the cache

/// One operation over a tile. The switch is outside the loop, so that the plain operations become
/// vector code; each computes exactly scalar_op().
template <ExprOp op>
void run_op(double* out, const double* a, const double* b, const double* c, const Table* table,
            std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i)
        out[i] = scalar_op(op, a[i], b[i], c[i], table);
}

void run_instruction(const TapeInstruction& step, double* out, const double* a, const double* b,
                     const double* c, std::size_t n) noexcept {
    const Table* t = step.table;
    switch (step.op) {
        case ExprOp::add:
            return run_op<ExprOp::add>(out, a, b, c, t, n);
        case ExprOp::subtract:
            return run_op<ExprOp::subtract>(out, a, b, c, t, n);
        case ExprOp::multiply:
            return run_op<ExprOp::multiply>(out, a, b, c, t, n);
        case ExprOp::divide:
            return run_op<ExprOp::divide>(out, a, b, c, t, n);
        case ExprOp::minimum:
            return run_op<ExprOp::minimum>(out, a, b, c, t, n);
        case ExprOp::maximum:
            return run_op<ExprOp::maximum>(out, a, b, c, t, n);
        case ExprOp::power:
            return run_op<ExprOp::power>(out, a, b, c, t, n);
        case ExprOp::atan2:
            return run_op<ExprOp::atan2>(out, a, b, c, t, n);
        case ExprOp::less:
            return run_op<ExprOp::less>(out, a, b, c, t, n);
        case ExprOp::less_equal:
            return run_op<ExprOp::less_equal>(out, a, b, c, t, n);
        case ExprOp::equal:
            return run_op<ExprOp::equal>(out, a, b, c, t, n);
        case ExprOp::negate:
            return run_op<ExprOp::negate>(out, a, b, c, t, n);
        case ExprOp::absolute:
            return run_op<ExprOp::absolute>(out, a, b, c, t, n);
        case ExprOp::square_root:
            return run_op<ExprOp::square_root>(out, a, b, c, t, n);
        case ExprOp::exp2:
            return run_op<ExprOp::exp2>(out, a, b, c, t, n);
        case ExprOp::log2:
            return run_op<ExprOp::log2>(out, a, b, c, t, n);
        case ExprOp::sine:
            return run_op<ExprOp::sine>(out, a, b, c, t, n);
        case ExprOp::cosine:
            return run_op<ExprOp::cosine>(out, a, b, c, t, n);
        case ExprOp::floor:
            return run_op<ExprOp::floor>(out, a, b, c, t, n);
        case ExprOp::select:
            return run_op<ExprOp::select>(out, a, b, c, t, n);
        case ExprOp::lookup:
            return run_op<ExprOp::lookup>(out, a, b, c, t, n);
        case ExprOp::lattice:
            for (std::size_t i = 0; i < n; ++i)
                out[i] = (*step.lattice)(step.input, a[i], b[i], c[i]);
            return;
        case ExprOp::constant:
        case ExprOp::input:
            return;
    }
}

}  // namespace

ReferenceEngine::ReferenceEngine(const Pipeline& pipeline)
    : tape_(std::make_unique<const Tape>(compose(pipeline))) {}
ReferenceEngine::~ReferenceEngine() = default;
ReferenceEngine::ReferenceEngine(ReferenceEngine&&) noexcept = default;
ReferenceEngine& ReferenceEngine::operator=(ReferenceEngine&&) noexcept = default;

void ReferenceEngine::run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
                          std::size_t count) const noexcept {
    const auto& code = tape_->code();
    const std::size_t tile = std::min(kTile, count);
    std::vector<double> values(code.size() * tile);
    const auto row = [&](std::uint32_t i) { return values.data() + i * tile; };
    for (std::uint32_t i = 0; i < code.size(); ++i) {
        if (code[i].op == ExprOp::constant) std::fill_n(row(i), tile, code[i].value);
    }
    for (std::size_t begin = 0; begin < count; begin += tile) {
        const std::size_t n = std::min(tile, count - begin);
        for (std::uint32_t i = 0; i < code.size(); ++i) {
            const TapeInstruction& step = code[i];
            if (step.op == ExprOp::input) {
                const double* plane = in[static_cast<std::size_t>(step.input)] + begin;
                for (std::size_t k = 0; k < n; ++k)
                    row(i)[k] = sanitise(plane[k]);
            } else {
                run_instruction(step, row(i), row(step.a), row(step.b), row(step.c), n);
            }
        }
        for (std::size_t c = 0; c < 3; ++c) {
            std::copy_n(row(tape_->outputs()[c]), n, out[c] + begin);
        }
    }
}

Vector3 ReferenceEngine::operator()(const Vector3& rgb) const noexcept {
    Vector3 result{};
    run({&rgb[0], &rgb[1], &rgb[2]}, {&result[0], &result[1], &result[2]}, 1);
    return result;
}

void ReferenceEngine::run_rgb(const float* in, double* out,
                              std::size_t pixel_count) const noexcept {
    constexpr std::size_t kChunk = 4096;
    std::vector<double> planes(3 * kChunk);
    const std::array<double*, 3> plane = {planes.data(), planes.data() + kChunk,
                                          planes.data() + 2 * kChunk};
    for (std::size_t begin = 0; begin < pixel_count; begin += kChunk) {
        const std::size_t n = std::min(kChunk, pixel_count - begin);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                plane[c][i] = static_cast<double>(in[(begin + i) * 3 + c]);
            }
        }
        run({plane[0], plane[1], plane[2]}, plane, n);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                out[(begin + i) * 3 + c] = plane[c][i];
        }
    }
}

TONEWRIGHT_NAMESPACE_END
