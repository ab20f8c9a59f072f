// SPDX-License-Identifier: Apache-2.0
#include "definition/recipe.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "base/format_number.h"
#include "base/strings.h"
#include "expr/nodes.h"
#include "expr/scalar_ops.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = StageRecipe::Kind;

/// Recursion over expressions has room for many times as many, on every thread's stack.
constexpr std::size_t kDeepestOperator = 2000;

/// Values of all parameters that are not live, of choices and of the look.
UniformValues values_of(const OperatorRecipe& recipe, const Params& params) {
    UniformValues values;
    const auto index_of = [](const std::vector<std::string>& names, const std::string& name) {
        const auto found = std::find(names.begin(), names.end(), name);
        return static_cast<double>(found - names.begin());
    };
    for (const ParameterSpec& spec : recipe.parameters) {
        if (spec.kind == ParameterSpec::Kind::choice) {
            values.emplace(spec.name, index_of(spec.choices, params.choice(spec.name)));
        } else if (const Expr e = params.expr(spec.name); e.is_constant()) {
            values.emplace(spec.name, e.value());
        }
    }
    values.emplace(kLookName,
                   params.look().empty() ? 0 : 1 + index_of(recipe.looks, params.look()));
    return values;
}

Stage matrix_of(const std::vector<Expr>& m, const char* name) {
    if (std::all_of(m.begin(), m.end(), [](const Expr& e) { return e.is_constant(); })) {
        MatrixStage stage{{}, name};
        for (std::size_t i = 0; i < 9; ++i)
            stage.m.at(i / 3).at(i % 3) = m[i].value();
        return stage;
    }
    CrossTalkStage stage{{0, 0, 0}, name};
    for (std::size_t i = 0; i < 3; ++i) {
        stage.f.at(i) = m[3 * i] * Expr::input(0) + m[3 * i + 1] * Expr::input(1) +
                        m[3 * i + 2] * Expr::input(2);
    }
    return stage;
}

Stage stage_of(const StageRecipe& recipe, const UniformValues& values) {
    const auto bound = [&](const std::vector<Expr>& exprs) {
        std::vector<Expr> result;
        result.reserve(exprs.size());
        for (const Expr& e : exprs)
            result.push_back(bind_uniforms(e, values));
        return result;
    };
    const std::vector<Expr> f = bound(recipe.f);
    const auto three = [](const std::vector<Expr>& of) {
        return of.size() == 1 ? std::array{of[0], of[0], of[0]} : std::array{of[0], of[1], of[2]};
    };
    switch (recipe.kind) {
        case Kind::matrix:
            return matrix_of(f, recipe.name);
        case Kind::curve: {
            CurveStage stage{three(f), std::nullopt, recipe.name};
            if (!recipe.inverse.empty()) stage.inverse = three(bound(recipe.inverse));
            return stage;
        }
        case Kind::tone_scale:
            return ToneScaleStage{recipe.norm, recipe.weights, f[0]};
        case Kind::hue_preserving:
            return HuePreservingStage{f[0]};
        case Kind::hexcone:
            return HexconeStage{f[0], f[1], f[2]};
        case Kind::cross_talk:
            return CrossTalkStage{three(f), recipe.name};
        case Kind::clamp:
        case Kind::lut:
            break;
    }
    return ClampStage{recipe.lo, recipe.hi};
}

Pipeline stages_of(const StageRecipe& recipe, const UniformValues& values) {
    return recipe.kind == Kind::lut ? recipe.lut.stages : Pipeline{stage_of(recipe, values)};
}

/// The expressions' values for many inputs, each node once.
std::array<std::vector<double>, 3> values_at(const std::array<Expr, 3>& f,
                                             const std::array<std::vector<double>, 3>& inputs) {
    const std::vector<Expr> nodes = nodes_of(f);
    const std::size_t count = inputs[0].size();
    std::map<const ExprNode*, std::vector<double>> values;
    for (const Expr& e : nodes) {
        std::vector<double>& out = values[e.node()];
        if (e.op() == ExprOp::input) {
            out = inputs.at(static_cast<std::size_t>(e.input_index()));
            continue;
        }
        out.assign(count, e.is_constant() ? e.value() : 0);
        if (e.operand_count() == 0) continue;
        std::array<const std::vector<double>*, 3> in{};
        for (int i = 0; i < 3; ++i)
            in.at(static_cast<std::size_t>(i)) =
                &values.at(e.operand(std::min(i, e.operand_count() - 1)).node());
        if (e.op() == ExprOp::grid) {
            for (std::size_t i = 0; i < count; ++i)
                out[i] = (*e.grid())(e.channel(), (*in[0])[i], (*in[1])[i], (*in[2])[i]);
            continue;
        }
        for (std::size_t i = 0; i < count; ++i)
            out[i] = scalar_op(e.op(), (*in[0])[i], (*in[1])[i], (*in[2])[i], e.table().get());
    }
    return {values.at(f[0].node()), values.at(f[1].node()), values.at(f[2].node())};
}

/// Black, grays and saturated colors of both signs, up to the ends of the range.
std::array<std::vector<double>, 3> sample_colors() {
    std::array<std::vector<double>, 3> rgb;
    const auto add = [&](double r, double g, double b) {
        rgb[0].push_back(r);
        rgb[1].push_back(g);
        rgb[2].push_back(b);
    };
    add(0, 0, 0);
    for (const double size : {1e-9, 1e-4, 0.01, 0.18, 0.5, 1.0, 4.0, 100.0, kHalfMax}) {
        for (const double v : {size, -size}) {
            add(v, v, v);
            add(v, 0, 0);
            add(0, v, 0);
            add(0, 0, v);
            add(v, v / 2, -v / 4);
        }
    }
    return rgb;
}

struct Size {
    std::size_t operations = 0;
    int depth = 0;  // operations that depend on each other
};

Size size_of(const std::array<Expr, 3>& f) {
    std::map<const ExprNode*, int> depths;
    Size size;
    for (const Expr& e : nodes_of(f)) {
        int& depth = depths[e.node()];
        for (int i = 0; i < e.operand_count(); ++i)
            depth = std::max(depth, depths.at(e.operand(i).node()) + 1);
        size.depth = std::max(size.depth, depth);
    }
    size.operations = depths.size();
    return size;
}

}  // namespace

std::vector<const StageRecipe*> stages_used(const OperatorRecipe& recipe,
                                            const std::vector<StageRecipe>& stages,
                                            const Params& params) {
    const UniformValues values = values_of(recipe, params);
    std::vector<const StageRecipe*> used;
    for (const StageRecipe& stage : stages) {
        if (!bind_uniforms(stage.when, values).is_constant(0)) used.push_back(&stage);
    }
    return used;
}

Pipeline build_stages(const OperatorRecipe& recipe, const std::vector<StageRecipe>& stages,
                      const Params& params) {
    const UniformValues values = values_of(recipe, params);
    Pipeline pipeline;
    std::array<std::vector<double>, 3> rgb = sample_colors();
    bool is_bound = true;
    Size size;
    for (const StageRecipe* const stage : stages_used(recipe, stages, params)) {
        const Pipeline stages_here = stages_of(*stage, values);
        pipeline.insert(pipeline.end(), stages_here.begin(), stages_here.end());
        const std::array<Expr, 3> f = compose(stages_here);
        const Size own = size_of(f);
        size = {size.operations + own.operations, size.depth + own.depth};
        const auto limit = [&](std::size_t count, std::size_t most, const char* what) {
            if (count <= most) return;
            throw StageError(stage->at, "stages up to here have " + std::to_string(count) + " " +
                                            what + "; expected at most " + std::to_string(most));
        };
        limit(size.operations, kMostOperations, "operations");
        limit(static_cast<std::size_t>(size.depth), kDeepestOperator,
              "operations that depend on each other");
        is_bound = is_bound && uniforms_of(f).empty();
        if (!is_bound) continue;
        const std::array<std::vector<double>, 3> in = rgb;
        rgb = values_at(f, in);
        for (std::size_t i = 0; i < rgb[0].size(); ++i) {
            for (const std::vector<double>& channel : rgb) {
                if (std::isfinite(channel[i])) continue;
                throw StageError(stage->at,
                                 std::string("stage gives ") +
                                     (std::isnan(channel[i]) ? "no number" : "infinity") +
                                     " for the color " + shortest(in[0][i]) + " " +
                                     shortest(in[1][i]) + " " + shortest(in[2][i]) +
                                     "; expected a finite number, as with max(x, 1e-10)");
            }
        }
    }
    return pipeline;
}

double number_of(const OperatorRecipe& recipe, const Expr& e, const Params& params) {
    const Expr value = bind_uniforms(e, values_of(recipe, params));
    return value.is_constant() ? value.value() : 1;
}

bool is_id(std::string_view text) {
    return !text.empty() && text.size() <= kLongestName && is_formula_name(text) &&
           text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") ==
               std::string_view::npos;
}

bool is_taken_name(std::string_view name) {
    static const std::set<std::string_view> taken = {"x", "r", "g", "b", kLookName};
    return taken.contains(name);
}

std::string why_no_parameter(const std::string& name, const std::vector<ParameterSpec>& others) {
    const auto is_same = [&](const ParameterSpec& spec) { return is_same_name(spec.name, name); };
    if (is_id(lowercase(name)) && !is_formula_function(name) && !is_taken_name(name) &&
        std::none_of(others.begin(), others.end(), is_same))
        return "";
    return "parameter is " + printable(name) +
           "; expected at most 63 letters, digits and _, and no function, input or other parameter";
}

const char* kept_name(const std::string& name) {
    static std::mutex mutex;
    static auto* names = new std::set<std::string>;  // never destroyed: stages may outlive statics
    const std::lock_guard lock(mutex);
    return names->insert(name).first->c_str();
}

TONEWRIGHT_NAMESPACE_END
