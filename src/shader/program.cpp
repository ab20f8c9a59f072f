// SPDX-License-Identifier: Apache-2.0
#include "shader/program.h"

#include <algorithm>
#include <span>

#include "shader/shared_functions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

using Channels = std::array<Expr, 3>;

Channels channels() { return {Expr::input(0), Expr::input(1), Expr::input(2)}; }

struct NamedStage {
    Stage stage;
    std::string name;
};

/// simplify() with the names of all merged stages.
std::vector<NamedStage> simplify_named(const Pipeline& pipeline) {
    std::vector<NamedStage> result;
    for (const Stage& stage : pipeline) {
        if (is_identity(stage)) continue;
        const std::string name =
            std::visit(Overloaded{[](const MatrixStage& s) { return s.name; },
                                  [](const CurveStage& s) { return s.name; },
                                  [](const CrossTalkStage& s) { return s.name; },
                                  [](const auto&) { return ""; }},
                       stage);
        const Pipeline both =
            result.empty() ? Pipeline{stage} : simplify({result.back().stage, stage});
        if (both.size() > 1 || result.empty()) {
            result.push_back({stage, name});
        } else if (both.empty()) {
            result.pop_back();
        } else {
            NamedStage& last = result.back();
            last.stage = both.front();
            last.name += (last.name.empty() || name.empty() ? "" : "_") + name;
        }
    }
    return result;
}

class ProgramMaker {
  public:
    explicit ProgramMaker(const UniformRanges& uniforms) : uniforms_(uniforms) {}

    ShaderProgram make(const Pipeline& pipeline) {
        range_.fill({-kInfinity, kInfinity});
        if (limits_input(pipeline)) limit({-kHalfMax, kHalfMax});
        for (const NamedStage& named : simplify_named(pipeline))
            std::visit([&](const auto& s) { add(s, named.name); }, named.stage);
        return std::move(program_);
    }

  private:
    void add(const MatrixStage& s, const std::string& name) {
        const bool is_scale = s.m == scale(kIdentity3, s.m[0][0]);
        std::array<Interval, 3> out;
        for (std::size_t i = 0; i < 3; ++i)
            out[i] = FloatForm(ranges(), uniforms_).range(apply_stage(s, channels())[i]);
        range_ = out;
        if (is_scale) {
            program_.steps.emplace_back(ScaleStep{s.m[0][0]});
            return;
        }
        program_.matrices.push_back({unique_name(name.empty() ? "matrix" : name), s.m});
        program_.steps.emplace_back(MatrixStep{program_.matrices.size() - 1});
    }

    void add(const ClampStage& s, const std::string&) { limit(s); }

    void add(const CurveStage& s, const std::string& given_name) {
        const std::string name = given_name.empty() ? "curve" : given_name;
        if (s.is_uniform()) {
            add_to_each_channel(name, s.f[0]);
        } else {
            const Channels c = channels();
            add_color_function(name, {}, apply_stage(s, c));
        }
    }

    void add(const ToneScaleStage& s, const std::string&) {
        const Channels c = channels();
        const bool is_max = s.norm == ToneScaleStage::Norm::max_rgb;
        const Expr n = is_max ? named("largest", max(max(c[0], c[1]), c[2]))
                              : named("luminance", s.weights[0] * c[0] + s.weights[1] * c[1] +
                                                       s.weights[2] * c[2]);
        const auto curve = add_scalar("curve", s.f, range_of(n));
        const Expr ratio = named("scale", select(less(0, n), Expr::input(3) / n, 0));
        add_color_function("tone_scale", {{curve, n, "tone"}},
                           {c[0] * ratio, c[1] * ratio, c[2] * ratio});
    }

    void add(const HuePreservingStage& s, const std::string&) {
        const Channels c = channels();
        const Expr hi = named("largest", max(max(c[0], c[1]), c[2]));
        const Expr lo = named("smallest", min(min(c[0], c[1]), c[2]));
        const Interval low = range_of(lo);
        const Interval high = range_of(hi);
        const auto curve =
            add_scalar("curve", s.f, {std::min(low.lo, high.lo), std::max(low.hi, high.hi)});
        const Expr f_hi = Expr::input(3);
        const Expr f_lo = Expr::input(4);
        const Expr spread = named("spread", hi - lo);
        Channels out = c;
        for (Expr& x : out)
            x = f_lo + (f_hi - f_lo) * select(less(0, spread), (x - lo) / spread, 0);
        add_color_function("hue_preserving", {{curve, hi, "top"}, {curve, lo, "bottom"}}, out);
    }

    void add(const HexconeStage& s, const std::string&) {
        add_color_function("hexcone", {}, apply_stage(s, channels()));
    }

    void add(const CrossTalkStage& s, const std::string& name) {
        const std::string own = name.empty() ? "mix" : name;
        const SharedFunctions shared = share_functions(s.f);
        std::vector<Interval> inputs = ranges();
        inputs.resize(3 + shared.calls.size(), {-kInfinity, kInfinity});
        std::vector<ColorFunction::Call> calls;
        for (const SharedFunctions::Call& call : shared.calls)
            calls.push_back({0, call.argument, call.name.empty() ? "curved" : call.name});
        for (std::size_t k = 0; k < shared.functions.size(); ++k) {
            Interval input{kInfinity, -kInfinity};
            for (const SharedFunctions::Call& call : shared.calls) {
                if (call.function != k) continue;
                const Interval range = FloatForm(inputs, uniforms_).range(call.argument);
                input = {std::min(input.lo, range.lo), std::max(input.hi, range.hi)};
            }
            const PartNames names(Span<const Expr>(&shared.functions[k], 1));
            const std::string* const part = names.of(shared.functions[k]);
            const std::size_t scalar =
                add_scalar(own + "_" + (part ? *part : "curve"), shared.functions[k], input);
            for (std::size_t i = 0; i < calls.size(); ++i) {
                if (shared.calls[i].function != k) continue;
                calls[i].function = scalar;
                inputs[3 + i] = scalar_range_[scalar];
            }
        }
        add_color_function(own, std::move(calls), shared.f);
    }

    void add(const GridStage& s, const std::string&) {
        add_to_each_channel("shaper", s.shaper);
        const Channels c = channels();
        Channels out = c;
        for (int i = 0; i < 3; ++i)
            out[static_cast<std::size_t>(i)] = interpolate(s.grid, i, c[0], c[1], c[2]);
        add_color_function("lattice", {}, out);
    }

    void limit(const ClampStage& s) {
        for (Interval& r : range_)
            r = {std::clamp(r.lo, s.lo, s.hi), std::clamp(r.hi, s.lo, s.hi)};
        auto* const last =
            program_.steps.empty() ? nullptr : std::get_if<ClampStage>(&program_.steps.back());
        if (last) {
            *last = {std::clamp(last->lo, s.lo, s.hi), std::clamp(last->hi, s.lo, s.hi)};
        } else {
            program_.steps.emplace_back(s);
        }
    }

    void add_to_each_channel(const std::string& name, const Expr& f) {
        Interval all = range_[0];
        for (const Interval& r : range_)
            all = {std::min(all.lo, r.lo), std::max(all.hi, r.hi)};
        program_.steps.emplace_back(ScalarStep{add_scalar(name, f, all)});
        range_.fill(range_over(f, all, uniforms_));
    }

    std::size_t add_scalar(const std::string& name, const Expr& f, const Interval& input) {
        program_.scalars.push_back({unique_name(name), FloatForm({input}, uniforms_)(f), input});
        scalar_range_.push_back(range_over(f, input, uniforms_));
        return program_.scalars.size() - 1;
    }

    void add_color_function(const std::string& name, std::vector<ColorFunction::Call> calls,
                            const Channels& f) {
        std::vector<Interval> inputs = ranges();
        for (const ColorFunction::Call& call : calls)
            inputs.push_back(scalar_range_[call.function]);
        FloatForm form(inputs, uniforms_);
        for (ColorFunction::Call& call : calls)
            call.argument = form(call.argument);
        Channels out = f;
        for (std::size_t i = 0; i < 3; ++i) {
            out[i] = form(f[i]);
            range_[i] = form.range(out[i]);
        }
        program_.colors.push_back({unique_name(name), std::move(calls), out});
        program_.steps.emplace_back(ColorStep{program_.colors.size() - 1});
    }

    [[nodiscard]] std::vector<Interval> ranges() const { return {range_.begin(), range_.end()}; }
    [[nodiscard]] Interval range_of(const Expr& e) const {
        return FloatForm(ranges(), uniforms_).range(e);
    }

    /// "curve", "curve2", ...
    std::string unique_name(const std::string& name) {
        const int count = ++uses_[name];
        return count == 1 ? name : name + std::to_string(count);
    }

    ShaderProgram program_;
    const UniformRanges& uniforms_;
    std::array<Interval, 3> range_;  // of the color
    std::vector<Interval> scalar_range_;
    std::map<std::string, int> uses_;
};

}  // namespace

ShaderProgram make_program(const Pipeline& pipeline, const UniformRanges& uniforms) {
    return ProgramMaker(uniforms).make(pipeline);
}

std::array<Expr, 3> compose(const ShaderProgram& program) {
    Channels c = channels();
    for (const ProgramStep& step : program.steps) {
        std::visit(Overloaded{
                       [&](const ScaleStep& s) {
                           for (Expr& x : c)
                               x = x * s.factor;
                       },
                       [&](const MatrixStep& s) {
                           c = apply_stage(MatrixStage{program.matrices[s.function].m}, c);
                       },
                       [&](const ClampStage& s) { c = apply_stage(s, c); },
                       [&](const ScalarStep& s) {
                           c = apply_stage(curve_stage(program.scalars[s.function].f), c);
                       },
                       [&](const ColorStep& s) {
                           const ColorFunction& function = program.colors[s.function];
                           std::vector<Expr> inputs(c.begin(), c.end());
                           for (const ColorFunction::Call& call : function.calls) {
                               const Expr argument = substitute(call.argument, inputs);
                               inputs.push_back(substitute(program.scalars[call.function].f,
                                                           std::span(&argument, 1)));
                           }
                           for (std::size_t i = 0; i < 3; ++i)
                               c[i] = substitute(function.f[i], inputs);
                       },
                   },
                   step);
    }
    return c;
}

TONEWRIGHT_NAMESPACE_END
