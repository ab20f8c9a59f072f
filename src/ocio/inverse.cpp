// SPDX-License-Identifier: Apache-2.0
#include "ocio/inverse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "ocio/fixed_functions.h"
#include "ocio/inverse_cube.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// ---------------------------------------------------------------------------------------------
// Per-channel stages

/// Function of a run of stages for one channel.
class ChannelCurve {
  public:
    ChannelCurve(const Pipeline& run, std::size_t channel) : engine_(run), channel_(channel) {}

    double operator()(double x) const {
        Vector3 v{};
        v[channel_] = x;
        return engine_(v)[channel_];
    }

    /// In place.
    void run(std::vector<double>& x) const {
        std::array<std::vector<double>, 3> planes = {x, x, x};
        engine_.run({planes[0].data(), planes[1].data(), planes[2].data()},
                    {planes[0].data(), planes[1].data(), planes[2].data()}, x.size());
        x = planes[channel_];
    }

  private:
    ReferenceEngine engine_;
    std::size_t channel_;
};

/// Replaces each y by the smallest x with f(x) = y; f rises.
void solve(const ChannelCurve& f, std::vector<double>& y, double lo, double hi) {
    // Bisects over float bit patterns, because values span many magnitudes.
    const auto to_place = [](double x) { return std::copysign(std::log1p(std::fabs(x) * 1e6), x); };
    const auto to_light = [](double p) {
        return std::copysign(std::expm1(std::fabs(p)) * 1e-6, p);
    };
    std::vector<double> a(y.size(), to_place(lo));
    std::vector<double> b(y.size(), to_place(hi));
    std::vector<double> shown(y.size());
    for (int round = 0; round < 60; ++round) {
        for (std::size_t i = 0; i < y.size(); ++i)
            shown[i] = to_light((a[i] + b[i]) / 2);
        f.run(shown);
        for (std::size_t i = 0; i < y.size(); ++i)
            (shown[i] < y[i] ? a[i] : b[i]) = (a[i] + b[i]) / 2;
    }
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = to_light(b[i]);
}

/// Tables of the inverses of a run, at equal distances over its output.
/// @return false if a channel falls somewhere
bool append_inverse(const Pipeline& run, LoweredOps& ops) {
    std::array<double, 3> first{};
    std::array<double, 3> last{};
    std::array<std::vector<double>, 3> inverse;
    const bool is_uniform = is_per_channel(run);
    for (std::size_t c = 0; c < 3; ++c) {
        if (c > 0 && is_uniform) {
            first[c] = first[0];
            last[c] = last[0];
            inverse[c] = inverse[0];
            continue;
        }
        const ChannelCurve f(run, c);
        // If black is clamped to 0, values below it have no inverse.
        const double lo = f(-kHalfMax) == f(0) ? 0 : -kHalfMax;
        first[c] = f(lo);
        last[c] = f(kHalfMax);
        double previous = first[c];
        for (int i = -120; i <= 16 * 8; ++i) {
            const double y = f(std::exp2(i / 8.0));
            if (y < previous - 1e-9) return false;
            previous = y;
        }
        if (!(last[c] > first[c])) return false;
        constexpr int kEntries = 16384;
        for (int i = 0; i < kEntries; ++i) {
            inverse[c].push_back(first[c] + (last[c] - first[c]) * i / (kEntries - 1));
        }
        solve(f, inverse[c], lo, kHalfMax);
    }
    MatrixOp to_table{};
    std::array<std::vector<float>, 3> tables;
    for (std::size_t c = 0; c < 3; ++c) {
        to_table.m[c][c] = 1 / (last[c] - first[c]);
        to_table.offset[c] = -first[c] * to_table.m[c][c];
        tables[c].assign(inverse[c].begin(), inverse[c].end());
    }
    Lut1DOp lut = lut_1d(tables);
    lut.is_half_domain = false;
    ops.push_back({to_table});
    ops.push_back({std::move(lut)});
    return true;
}

bool treats_channels_apart(const Stage& stage) {
    return std::holds_alternative<CurveStage>(stage) || std::holds_alternative<ClampStage>(stage);
}

/// Stage by stage, from the last on.
std::optional<LoweredOps> invert_stages(const Pipeline& stages) {
    LoweredOps ops;
    std::size_t end = stages.size();
    while (end > 0) {
        if (const auto* m = std::get_if<MatrixStage>(&stages[end - 1])) {
            append(ops, lower_to_ocio({MatrixStage{inverse(m->m)}}).ops);
            --end;
            continue;
        }
        std::size_t begin = end;
        bool has_curve = false;
        while (begin > 0 && treats_channels_apart(stages[begin - 1])) {
            --begin;
            has_curve = has_curve || std::holds_alternative<CurveStage>(stages[begin]);
        }
        if (begin == end) return std::nullopt;
        const Pipeline run(stages.begin() + static_cast<std::ptrdiff_t>(begin),
                           stages.begin() + static_cast<std::ptrdiff_t>(end));
        if (!has_curve) {
            append(ops, lower_to_ocio(run).ops);
        } else if (!append_inverse(run, ops)) {
            return std::nullopt;
        }
        end = begin;
    }
    return ops;
}

/// Inverts every transform with OpenColorIO, for an operator that shows only infinite values as
/// white. Otherwise nothing, because OpenColorIO inverts the view itself.
std::optional<LoweredOps> invert_lowered(const Pipeline& forward, double peak) {
    const Vector3 brightest = ReferenceEngine(forward)({kHalfMax, kHalfMax, kHalfMax});
    if (!(*std::max_element(brightest.begin(), brightest.end()) < peak)) return std::nullopt;
    // Values grow without limit near white. Half-float tables have no entries there, and
    // interpolation is far too bright.
    const double last = peak * (1 - 0x1p-11);
    LoweredOps ops = lower_to_ocio({ClampStage{0, last}}).ops;
    append(ops, inverse(lower_to_ocio(forward).ops));
    return ops;
}

/// True if the stage, or a part of it, becomes a 3D LUT.
bool needs_cube(const Pipeline& stages) {
    return std::any_of(stages.begin(), stages.end(), [](const Stage& stage) {
        const auto* map = std::get_if<CrossTalkStage>(&stage);
        return std::holds_alternative<GridStage>(stage) || (map && !find_fixed_functions(*map));
    });
}

/// OpenColorIO's built-in inverse, if the operator equals one.
std::optional<LoweredOps> invert_builtin(const ResolvedOperator& op, const DisplayLimit& limit) {
    const std::string style = builtin_style(op);
    const auto registry = OCIO::BuiltinTransformRegistry::Get();
    for (std::size_t i = 0; i < registry->getNumBuiltins(); ++i) {
        if (style.empty() || style != registry->getBuiltinStyle(i)) continue;
        LoweredOps ops = lower_to_ocio({MatrixStage{rgb_to_xyz_d65(limit.primaries)}}).ops;
        ops.push_back({BuiltinOp{style}, true});
        append(ops, lower_to_ocio({MatrixStage{rgb_to_rgb(kAP0, op.op->working)}}).ops);
        return ops;
    }
    return std::nullopt;
}

}  // namespace

std::optional<LoweredOps> invert_light(const ResolvedOperator& op, const DisplayLimit& limit,
                                       const std::string& cache_folder) {
    if (auto ops = invert_builtin(op, limit)) return ops;
    Pipeline forward = op.build();
    const Pipeline light = display_light_stages(op, limit);
    forward.insert(forward.end(), light.begin(), light.end());
    forward = simplify(forward);
    if (auto ops = invert_stages(forward)) return ops;
    if (op.op->is_diagnostic) return std::nullopt;
    if (!needs_cube(forward)) return invert_lowered(forward, limit.peak);
    // In the operator's own gamut, so that displays with other gamuts share the table.
    const Primaries primaries = op.output_primaries();
    Pipeline back = {MatrixStage{rgb_to_rgb(limit.primaries, primaries)}};
    const auto append_stages = [](Pipeline& to, const Pipeline& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    if (op.op->build_inverse) {
        append_stages(back, op.op->build_inverse(op.params));
        return lower_to_ocio(sampled_inverse(back, limit.peak)).ops;
    }
    Pipeline own = op.build();
    append_stages(own, display_light_stages(op, {primaries, limit.peak}));
    append_stages(back, fitted_inverse(own, op.op->working, limit.peak, cache_folder));
    return lower_to_ocio(back).ops;
}

TONEWRIGHT_NAMESPACE_END
