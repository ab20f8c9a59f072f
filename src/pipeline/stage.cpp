// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "base/format_number.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

const Expr& input0() {
    static const Expr x = Expr::input(0);
    return x;
}

std::string to_text(const Matrix3& m) {
    std::string s;
    for (const auto& row : m) {
        s += (s.empty() ? "[" : " | ") + shortest(row[0]) + " " + shortest(row[1]) + " " +
             shortest(row[2]);
    }
    return s + "]";
}

}  // namespace

MatrixStage exposure_stage(double stops) {
    return {scale(kIdentity3, std::exp2(stops)), "exposure"};
}
CurveStage curve_stage(const Expr& f) { return {{f, f, f}, std::nullopt}; }
CurveStage curve_stage(const Expr& f, const Expr& inverse) {
    return {{f, f, f}, std::array{inverse, inverse, inverse}};
}

std::string_view stage_kind(const Stage& stage) {
    return std::visit(Overloaded{[](const MatrixStage&) { return "matrix"; },
                                 [](const CurveStage&) { return "curve"; },
                                 [](const ToneScaleStage&) { return "tone scale"; },
                                 [](const HuePreservingStage&) { return "hue-preserving curve"; },
                                 [](const HexconeStage&) { return "hexcone"; },
                                 [](const ClampStage&) { return "clamp"; },
                                 [](const CrossTalkStage&) { return "cross-talk"; },
                                 [](const GridStage&) { return "grid"; }},
                      stage);
}

bool is_identity(const Stage& stage) {
    return std::visit(
        Overloaded{[](const MatrixStage& s) { return s.m == kIdentity3; },
                   [](const CurveStage& s) { return s.is_uniform() && same(s.f[0], input0()); },
                   // Even with f(n) = n, colors of norm 0 or below become black.
                   [](const ToneScaleStage&) { return false; },
                   [](const HuePreservingStage& s) { return same(s.f, input0()); },
                   [](const HexconeStage&) { return false; },
                   [](const GridStage&) { return false; },
                   [](const ClampStage& s) { return s.lo == -kInfinity && s.hi == kInfinity; },
                   [](const CrossTalkStage& s) {
                       return same(s.f[0], Expr::input(0)) && same(s.f[1], Expr::input(1)) &&
                              same(s.f[2], Expr::input(2));
                   }},
        stage);
}

bool mixes_channels(const Stage& stage) {
    if (is_identity(stage)) return false;
    return std::visit(
        Overloaded{[](const MatrixStage& s) {
                       for (std::size_t i = 0; i < 3; ++i) {
                           for (std::size_t j = 0; j < 3; ++j) {
                               if (i != j && s.m[i][j] != 0) return true;
                           }
                       }
                       return false;
                   },
                   [](const CurveStage&) { return false; },
                   [](const ToneScaleStage&) { return true; },
                   [](const HuePreservingStage&) { return true; },
                   [](const HexconeStage&) { return true; }, [](const GridStage&) { return true; },
                   [](const ClampStage&) { return false; },
                   [](const CrossTalkStage& s) {
                       for (int i = 0; i < 3; ++i) {
                           for (int j = 0; j < 3; ++j) {
                               if (i != j && depends_on(s.f[static_cast<std::size_t>(i)], j))
                                   return true;
                           }
                       }
                       return false;
                   }},
        stage);
}

bool is_per_channel(const Pipeline& pipeline) {
    const std::array<Expr, 3> rgb = compose(simplify(pipeline));
    const Expr x = Expr::input(0);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (i != j && depends_on(rgb[static_cast<std::size_t>(i)], j)) return false;
        }
    }
    const std::array<Expr, 3> all_first = {x, x, x};
    return same(substitute(rgb[1], all_first), rgb[0]) &&
           same(substitute(rgb[2], all_first), rgb[0]);
}

std::array<Expr, 3> apply_stage(const Stage& stage, const std::array<Expr, 3>& rgb) {
    return std::visit(
        Overloaded{
            [&](const MatrixStage& s) {
                std::array<Expr, 3> out = rgb;
                for (std::size_t i = 0; i < 3; ++i) {
                    out[i] = s.m[i][0] * rgb[0] + s.m[i][1] * rgb[1] + s.m[i][2] * rgb[2];
                }
                return out;
            },
            [&](const CurveStage& s) {
                std::array<Expr, 3> out = rgb;
                for (std::size_t i = 0; i < 3; ++i)
                    out[i] = substitute(s.f[i], std::span(&rgb[i], 1));
                return out;
            },
            [&](const ToneScaleStage& s) {
                const Expr n =
                    s.norm == ToneScaleStage::Norm::max_rgb
                        ? max(max(rgb[0], rgb[1]), rgb[2])
                        : s.weights[0] * rgb[0] + s.weights[1] * rgb[1] + s.weights[2] * rgb[2];
                // At n = 0 the ratio has a limit, but all channels that it scales are 0.
                const Expr ratio = select(less(0, n), substitute(s.f, std::span(&n, 1)) / n, 0);
                return std::array<Expr, 3>{rgb[0] * ratio, rgb[1] * ratio, rgb[2] * ratio};
            },
            [&](const HuePreservingStage& s) {
                const Expr hi = max(max(rgb[0], rgb[1]), rgb[2]);
                const Expr lo = min(min(rgb[0], rgb[1]), rgb[2]);
                const Expr f_lo = substitute(s.f, std::span(&lo, 1));
                const Expr range = substitute(s.f, std::span(&hi, 1)) - f_lo;
                std::array<Expr, 3> out = rgb;
                // Grays are 0/0, but the range that it scales is 0. Tests the divisor itself,
                // because in float a difference may be 0 although its terms differ.
                const Expr spread = hi - lo;
                for (Expr& c : out)
                    c = f_lo + range * select(less(0, spread), (c - lo) / spread, 0);
                return out;
            },
            [&](const HexconeStage& s) {
                const Expr hi = max(max(rgb[0], rgb[1]), rgb[2]);
                const Expr lo = min(min(rgb[0], rgb[1]), rgb[2]);
                const Expr p = named("value_in", hi - substitute(s.offset, std::span(&lo, 1)));
                const Expr value = named("value_out", substitute(s.value, std::span(&p, 1)));
                const Expr chroma = named("chroma", substitute(s.chroma, std::span(&p, 1)));
                std::array<Expr, 3> out = rgb;
                for (Expr& c : out)
                    c = value - chroma * (hi - c);
                return out;
            },
            [&](const ClampStage& s) {
                std::array<Expr, 3> out = rgb;
                for (Expr& x : out) {
                    if (s.lo != -kInfinity) x = max(x, s.lo);
                    if (s.hi != kInfinity) x = min(x, s.hi);
                }
                return out;
            },
            [&](const GridStage& s) {
                std::array<Expr, 3> at = rgb;
                for (Expr& c : at)
                    c = substitute(s.shaper, std::span(&c, 1));
                std::array<Expr, 3> out = rgb;
                for (int c = 0; c < 3; ++c) {
                    out[static_cast<std::size_t>(c)] = interpolate(s.grid, c, at[0], at[1], at[2]);
                }
                return out;
            },
            [&](const CrossTalkStage& s) {
                return std::array<Expr, 3>{substitute(s.f[0], rgb), substitute(s.f[1], rgb),
                                           substitute(s.f[2], rgb)};
            }},
        stage);
}

Pipeline bind_uniforms(const Pipeline& pipeline, const UniformValues& values) {
    const auto bind_all = [&](std::array<Expr, 3>& f) {
        for (Expr& e : f)
            e = bind_uniforms(e, values);
    };
    Pipeline bound = pipeline;
    for (Stage& stage : bound) {
        std::visit(Overloaded{[](MatrixStage&) {}, [](ClampStage&) {},
                              [&](CurveStage& s) {
                                  bind_all(s.f);
                                  if (s.inverse) bind_all(*s.inverse);
                              },
                              [&](ToneScaleStage& s) { s.f = bind_uniforms(s.f, values); },
                              [&](HuePreservingStage& s) { s.f = bind_uniforms(s.f, values); },
                              [&](HexconeStage& s) {
                                  s.offset = bind_uniforms(s.offset, values);
                                  s.value = bind_uniforms(s.value, values);
                                  s.chroma = bind_uniforms(s.chroma, values);
                              },
                              [&](CrossTalkStage& s) { bind_all(s.f); },
                              [&](GridStage& s) { s.shaper = bind_uniforms(s.shaper, values); }},
                   stage);
    }
    return bound;
}

bool limits_input(const Pipeline& pipeline) {
    return std::none_of(pipeline.begin(), pipeline.end(), [](const Stage& stage) {
        const auto* clamp = std::get_if<ClampStage>(&stage);
        return clamp && clamp->is_input_limit;
    });
}

std::array<Expr, 3> compose(const Pipeline& pipeline) {
    std::array<Expr, 3> rgb = {Expr::input(0), Expr::input(1), Expr::input(2)};
    for (const Stage& stage : pipeline)
        rgb = apply_stage(stage, rgb);
    return rgb;
}

Pipeline simplify(const Pipeline& pipeline) {
    Pipeline out;
    for (const Stage& stage : pipeline) {
        if (is_identity(stage)) continue;
        const auto* matrix = std::get_if<MatrixStage>(&stage);
        auto* before = out.empty() ? nullptr : std::get_if<MatrixStage>(&out.back());
        if (matrix && before) {
            before->m = multiply(matrix->m, before->m);
            if (is_identity(out.back())) out.pop_back();
            continue;
        }
        const auto* clamp = std::get_if<ClampStage>(&stage);
        auto* clamp_before = out.empty() ? nullptr : std::get_if<ClampStage>(&out.back());
        if (clamp && clamp_before && clamp->lo <= clamp_before->hi &&
            clamp_before->lo <= clamp->hi) {
            *clamp_before = {std::max(clamp->lo, clamp_before->lo),
                             std::min(clamp->hi, clamp_before->hi),
                             clamp->is_input_limit || clamp_before->is_input_limit};
            continue;
        }
        out.push_back(stage);
    }
    return out;
}

std::string to_string(const Pipeline& pipeline) {
    std::string s;
    for (const Stage& stage : pipeline) {
        s += std::string(stage_kind(stage)) + ": ";
        s += std::visit(
            Overloaded{[](const MatrixStage& m) { return to_text(m.m); },
                       [](const CurveStage& c) {
                           if (c.is_uniform()) return to_string(c.f[0]);
                           return to_string(c.f[0]) + " | " + to_string(c.f[1]) + " | " +
                                  to_string(c.f[2]);
                       },
                       [](const ToneScaleStage& t) {
                           return std::string(t.norm == ToneScaleStage::Norm::max_rgb
                                                  ? "of max(r, g, b): "
                                                  : "of luminance: ") +
                                  to_string(t.f);
                       },
                       [](const HuePreservingStage& h) { return to_string(h.f); },
                       [](const HexconeStage& h) {
                           return "offset " + to_string(h.offset) + ", value " +
                                  to_string(h.value) + ", chroma " + to_string(h.chroma);
                       },
                       [](const GridStage& l) {
                           return std::to_string(l.grid->edge()) + "^3 at " + to_string(l.shaper);
                       },
                       [](const ClampStage& c) {
                           return "[" + shortest(c.lo) + ", " + shortest(c.hi) + "]";
                       },
                       [](const CrossTalkStage& m) {
                           static const std::array<std::string, 3> rgb = {"r", "g", "b"};
                           return to_string(m.f[0], rgb) + " | " + to_string(m.f[1], rgb) + " | " +
                                  to_string(m.f[2], rgb);
                       }},
            stage);
        s += "\n";
    }
    return s;
}

TONEWRIGHT_NAMESPACE_END
