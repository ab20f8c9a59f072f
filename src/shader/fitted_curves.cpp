// SPDX-License-Identifier: Apache-2.0
#include "shader/fitted_curves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "engine/curve_fitting.h"
#include "expr/nodes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Expr limited(const Expr& x, const ClampStage& s) {
    Expr result = x;
    if (s.lo != -kInfinity) result = max(result, s.lo);
    if (s.hi != kInfinity) result = min(result, s.hi);
    return result;
}

/// The curve as coefficient tables with the same positions, and their polynomial.
Expr expr_of(const CompiledCurve& curve, const Expr& x) {
    const std::vector<float> begins = curve.segment_begins();
    // The search needs a power of two; no value lies after the padding positions.
    const std::size_t count = std::bit_ceil(begins.size());
    std::vector<double> positions(begins.begin(), begins.end());
    while (positions.size() < count)
        positions.push_back(1e38 * (1 + static_cast<double>(positions.size()) / 64));
    const Expr at = min(max(x, static_cast<double>(curve.lo)), static_cast<double>(curve.hi));
    const auto table = [&](const auto& numbers) {
        std::vector<double> samples(numbers.begin(),
                                    numbers.begin() + static_cast<std::ptrdiff_t>(begins.size()));
        samples.resize(count, samples.back());
        return lookup(std::make_shared<const Table>(
                          Table{std::move(samples), Table::Interpolation::step, positions}),
                      at);
    };
    const Expr t = at * table(curve.scale) + table(curve.offset);
    Expr y = table(curve.coefficient[static_cast<std::size_t>(curve.degree)]);
    for (auto k = static_cast<std::size_t>(curve.degree); k-- > 0;)
        y = y * t + table(curve.coefficient[k]);
    y = limited(y, {static_cast<double>(curve.least), static_cast<double>(curve.most)});
    return select(less(static_cast<double>(curve.lo), x), y, curve.at_lo);
}

/// Replaces formulas by the engine's curves where it finds some.
Expr fitted(const Expr& f) {
    const Tape tape({f, f, f});
    std::vector<TapeInstruction> code = tape.code();
    std::array<std::uint32_t, 3> outputs = tape.outputs();
    CurveCache cache;
    fit_curves(code, outputs, measure_sensitivity(code, outputs), cache, CurveForm::segments);
    std::map<const Table*, std::shared_ptr<const Table>> tables;
    for (const Expr& e : nodes_of(std::span(&f, 1))) {
        if (e.op() == ExprOp::grid) return f;
        if (e.op() == ExprOp::lookup) tables[e.table().get()] = e.table();
    }
    std::vector<Expr> values;
    for (const TapeInstruction& step : code) {
        std::vector<Expr> operands;
        operands.reserve(static_cast<std::size_t>(operand_count(step.op)));
        for (int i = 0; i < operand_count(step.op); ++i)
            operands.push_back(values[i == 0 ? step.a : i == 1 ? step.b : step.c]);
        if (step.curve) {
            values.push_back(expr_of(*step.curve, operands[0]));
        } else if (step.op == ExprOp::constant) {
            values.emplace_back(step.value);
        } else if (step.op == ExprOp::input) {
            values.push_back(Expr::input(step.input));
        } else {
            values.push_back(
                make_expr(step.op, operands, step.table ? tables.at(step.table) : nullptr));
        }
    }
    return values[outputs[0]];
}

class Fitter {
  public:
    explicit Fitter(const ShaderProgram& program) : old_(program) {}

    ShaderProgram fit() {
        new_.matrices = old_.matrices;
        for (const ColorFunction& function : old_.colors) {
            new_.colors.push_back(function);
            for (ColorFunction::Call& call : new_.colors.back().calls) {
                const ScalarFunction& f = old_.scalars[call.function];
                const Expr x = f.input.lo >= 0 ? max(Expr::input(), 0) : Expr::input();
                const std::optional<Expr> curve = fit(substitute(f.f, std::span(&x, 1)), f.f);
                call.function = added({f.name, curve.value_or(f.f)});
            }
        }
        for (const ProgramStep& step : old_.steps) {
            if (is_of_each_channel(step)) {
                run_.push_back(step);
                continue;
            }
            finish_run();
            push(step);
        }
        finish_run();
        return std::move(new_);
    }

  private:
    static std::optional<Expr> fit(const Expr& f, const Expr& formula) {
        const Expr curve = fitted(f);
        if (shader_cost(curve) < shader_cost(formula)) return curve;
        return std::nullopt;
    }

    [[nodiscard]] bool is_of_each_channel(const ProgramStep& step) const {
        if (const auto* scalar = std::get_if<ScalarStep>(&step))
            return uniforms_of(std::span(&old_.scalars[scalar->function].f, 1)).empty();
        return std::holds_alternative<ScaleStep>(step) || std::holds_alternative<ClampStage>(step);
    }

    /// The steps since the last channel-mixing step, as one function.
    void finish_run() {
        Expr f = Expr::input();
        std::string name;
        for (const ProgramStep& step : run_) {
            if (const auto* scale = std::get_if<ScaleStep>(&step)) f = f * scale->factor;
            if (const auto* clamp = std::get_if<ClampStage>(&step)) f = limited(f, *clamp);
            if (const auto* scalar = std::get_if<ScalarStep>(&step)) {
                const ScalarFunction& function = old_.scalars[scalar->function];
                f = substitute(function.f, std::span(&f, 1));
                name += (name.empty() ? "" : "_") + function.name;
            }
        }
        const std::optional<Expr> curve = name.empty() ? std::nullopt : fit(f, f);
        if (curve) {
            new_.steps.emplace_back(ScalarStep{added({name, *curve})});
        } else {
            for (const ProgramStep& step : run_)
                push(step);
        }
        run_.clear();
    }

    void push(ProgramStep step) {
        if (auto* const scalar = std::get_if<ScalarStep>(&step))
            scalar->function = added(old_.scalars[scalar->function]);
        new_.steps.push_back(step);
    }

    std::size_t added(ScalarFunction function) {
        for (std::size_t i = 0; i < new_.scalars.size(); ++i) {
            if (new_.scalars[i].name == function.name) return i;
        }
        new_.scalars.push_back(std::move(function));
        return new_.scalars.size() - 1;
    }

    const ShaderProgram& old_;
    ShaderProgram new_;
    std::vector<ProgramStep> run_;
};

}  // namespace

int shader_cost(const Expr& f) {
    int cost = 0;
    std::vector<std::pair<const ExprNode*, const std::vector<double>*>> searches;
    for (const Expr& e : nodes_of(std::span(&f, 1))) {
        switch (e.op()) {
            case ExprOp::constant:
            case ExprOp::input:
            case ExprOp::uniform:
                break;
            case ExprOp::power:
                cost += 9;  // a logarithm, a product, a power of 2
                break;
            case ExprOp::log2:
            case ExprOp::exp2:
            case ExprOp::sine:
            case ExprOp::cosine:
            case ExprOp::square_root:
                cost += 4;
                break;
            case ExprOp::divide:
                cost += 5;
                break;
            case ExprOp::atan2:
                cost += 20;
                break;
            case ExprOp::lookup: {
                cost += e.table()->interpolation == Table::Interpolation::step ? 1 : 3;
                const auto& positions = e.table()->positions;
                const bool is_known =
                    std::any_of(searches.begin(), searches.end(), [&](const auto& search) {
                        return search.first == e.operand(0).node() && *search.second == positions;
                    });
                if (positions.empty() || is_known) break;
                searches.emplace_back(e.operand(0).node(), &positions);
                // A load, a comparison and a sum, at each step of the search.
                cost += 3 * static_cast<int>(std::bit_width(positions.size() - 1));
                break;
            }
            default:
                ++cost;
        }
    }
    return cost;
}

ShaderProgram with_fitted_curves(const ShaderProgram& program) { return Fitter(program).fit(); }

TONEWRIGHT_NAMESPACE_END
