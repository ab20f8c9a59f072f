// SPDX-License-Identifier: Apache-2.0
//
// A shader's function -> the stages of an operator -> a .tone file.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <unordered_map>

#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "definition/primaries_names.h"
#include "definition/recipe.h"
#include "expr/nodes.h"
#include "formula/glsl.h"
#include "tonewright/definition.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = StageRecipe::Kind;
using Output = ShaderImport::Output;
using Moved = std::unordered_map<const ExprNode*, Expr>;  // what nodes become

std::set<int> inputs_of(const std::vector<Expr>& exprs) {
    std::set<int> inputs;
    for (const Expr& e : nodes_of(exprs)) {
        if (e.op() == ExprOp::input) inputs.insert(e.input_index());
    }
    return inputs;
}

/// The function as stages, the last one first.
class Stages {
  public:
    explicit Stages(GlslFunction function) : function_(std::move(function)) {
        for (const GlslName& name : function_.names)
            names_.emplace(name.value.node(), &name);
        if (!function_.is_color) {
            add_values(function_.values, 0);
            return;
        }
        std::vector<Expr> now = function_.values;
        for (std::size_t k = function_.products.size(); k > 0; --k) {
            const GlslProduct& product = function_.products[k - 1];
            const int first = static_cast<int>(3 * k);
            const std::set<int> inputs = inputs_of(now);
            const auto is_of_product = [&](int i) { return i >= first && i < first + 3; };
            if (std::none_of(inputs.begin(), inputs.end(), is_of_product)) continue;
            const std::vector<Expr> color(product.color.begin(), product.color.end());
            if (std::all_of(inputs.begin(), inputs.end(), is_of_product)) {
                add_values(now, first);
                StageRecipe matrix;
                for (const auto& row : product.matrix)
                    matrix.f.insert(matrix.f.end(), row.begin(), row.end());
                add(std::move(matrix));
                now = color;
                continue;
            }
            // The function reads the color before the product, too: no stage of its own.
            Moved sums;
            for (int i = 0; i < 3; ++i) {
                const auto& row = product.matrix.at(static_cast<std::size_t>(i));
                sums.emplace(Expr::input(first + i).node(),
                             row[0] * color[0] + row[1] * color[1] + row[2] * color[2]);
            }
            now = moved(now, sums);
        }
        add_values(now, 0);
    }

    /// In their order.
    [[nodiscard]] std::vector<StageRecipe> stages() const {
        return {stages_.rbegin(), stages_.rend()};
    }
    [[nodiscard]] const GlslFunction& function() const { return function_; }

  private:
    void add(StageRecipe stage) {
        stage.at = function_.at;
        stages_.push_back(std::move(stage));
    }

    /// Three values of inputs `first` and the next two, or one.
    void add_values(std::vector<Expr> values, int first) {
        while (peel_clamp(values)) {
        }
        bool is_identity = true;
        bool is_curve = true;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const int own = first + static_cast<int>(i);
            is_identity = is_identity && same(values[i], Expr::input(own));
            const std::set<int> inputs = inputs_of({values[i]});
            is_curve = is_curve && std::all_of(inputs.begin(), inputs.end(),
                                               [&](int input) { return input == own; });
        }
        if (is_identity) return;
        StageRecipe stage;
        stage.kind = is_curve ? Kind::curve : Kind::cross_talk;
        Moved inputs;
        for (int i = 0; i < 3; ++i)
            inputs.emplace(Expr::input(first + i).node(), Expr::input(is_curve ? 0 : i));
        stage.f = moved(values, inputs);
        const bool is_one = std::all_of(stage.f.begin(), stage.f.end(),
                                        [&](const Expr& e) { return same(e, stage.f[0]); });
        std::optional<StageRecipe> before;
        if (is_curve && is_one) {
            stage.f.resize(1, 0);
            before = take_clamp(stage.f);
        }
        PartNames texts;
        for (const Expr& e : nodes_of(stage.f)) {
            if (const auto named = names_.find(e.node()); named != names_.end())
                texts.add(text_of(*named->second, is_curve), e);
        }
        for (Expr& e : stage.f)
            e = texts.on(e);
        add(std::move(stage));
        // The first stage of all clamps to [0, 65504].
        if (before && (first != 0 || before->lo > 0 || before->hi < kHalfMax))
            add(*std::move(before));
    }

    /// The limits that a curve begins with, which leave it: of x, or of log2(x). A stage is exact
    /// where a table of the curve would have a kink.
    std::optional<StageRecipe> take_clamp(std::vector<Expr>& curve) {
        std::unordered_map<const ExprNode*, std::vector<Expr>> users;
        for (const Expr& e : nodes_of(curve)) {
            for (int i = 0; i < e.operand_count(); ++i)
                users[e.operand(i).node()].push_back(e);
        }
        StageRecipe clamp;
        clamp.kind = Kind::clamp;
        clamp.lo = -kInfinity;
        std::optional<Expr> limited;
        Expr unlimited = Expr::input(0);
        Expr inner = unlimited;
        Expr now = inner;
        while (!same(now, curve[0]) && users[now.node()].size() == 1) {
            now = users[now.node()][0];
            const bool is_log = inner.op() == ExprOp::log2;
            if (now.op() == ExprOp::log2 && !is_log) {
                inner = log2(inner);
                continue;
            }
            if (now.op() != ExprOp::minimum && now.op() != ExprOp::maximum) break;
            const Expr number = now.operand(now.operand(0).is_constant() ? 0 : 1);
            if (!number.is_constant()) break;
            const double end = is_log ? std::exp2(number.value()) : number.value();
            for (double* own : {&clamp.lo, &clamp.hi})
                *own = now.op() == ExprOp::minimum ? std::min(*own, end) : std::max(*own, end);
            limited = now;
            unlimited = inner;
        }
        if (!limited || clamp.lo >= clamp.hi) return std::nullopt;
        // So far below, floats would make 0 of the limit, and the logarithm infinite.
        constexpr double kLowest = 1e-30;
        if (unlimited.op() == ExprOp::log2 && clamp.lo < kLowest) return std::nullopt;
        curve = moved(curve, {{limited->node(), unlimited}});
        return clamp;
    }

    /// min(max(x, lo), hi) of all values, or a part of it, becomes a stage.
    bool peel_clamp(std::vector<Expr>& values) {
        const ExprOp op = values[0].op();
        if (op != ExprOp::minimum && op != ExprOp::maximum) return false;
        std::vector<Expr> inner;
        std::optional<double> end;
        for (const Expr& e : values) {
            if (e.op() != op) return false;
            const bool is_first = e.operand(0).is_constant();
            const Expr number = e.operand(is_first ? 0 : 1);
            if (!number.is_constant() || number.value() != end.value_or(number.value()))
                return false;
            end = number.value();
            inner.push_back(e.operand(is_first ? 1 : 0));
        }
        StageRecipe stage;
        stage.kind = Kind::clamp;
        (op == ExprOp::minimum ? stage.hi : stage.lo) = *end;
        if (op == ExprOp::maximum) stage.hi = kInfinity;
        if (op == ExprOp::minimum) stage.lo = -kInfinity;
        StageRecipe* const next = stages_.empty() ? nullptr : &stages_.back();
        const bool joins = next && next->kind == Kind::clamp && op == ExprOp::maximum &&
                           next->lo == -kInfinity && stage.lo <= next->hi;
        if (joins) {
            next->lo = stage.lo;
        } else {
            add(std::move(stage));
        }
        values = std::move(inner);
        return true;
    }

    /// The values with other nodes for some of them. Named parts keep their names.
    std::vector<Expr> moved(const std::vector<Expr>& values, Moved done) {
        for (const Expr& e : nodes_of(values)) {
            if (!done.contains(e.node())) {
                std::vector<Expr> operands;
                operands.reserve(static_cast<std::size_t>(e.operand_count()));
                for (int i = 0; i < e.operand_count(); ++i)
                    operands.push_back(done.at(e.operand(i).node()));
                done.emplace(e.node(), operands.empty() ? e : make_expr(e.op(), operands));
            }
            const Expr& result = done.at(e.node());
            const auto named = names_.find(e.node());
            if (named == names_.end()) continue;
            kept_.push_back(result);
            names_.emplace(result.node(), named->second);
        }
        std::vector<Expr> result;
        result.reserve(values.size());
        for (const Expr& e : values)
            result.push_back(done.at(e.node()));
        return result;
    }

    [[nodiscard]] std::string text_of(const GlslName& name, bool is_curve) const {
        constexpr std::size_t kLongest = 40;
        std::string text = name.variable.substr(0, kLongest);
        if (!is_curve && name.components > 1)
            text += std::string("_") + (name.components == 2 ? "xy" : "rgba")[name.component];
        const auto is_parameter = [&](const GlslParameter& p) { return p.name == text; };
        while (is_taken_name(text) || is_formula_function(text) ||
               std::any_of(function_.parameters.begin(), function_.parameters.end(), is_parameter))
            text += "_";
        return text;
    }

    GlslFunction function_;
    std::unordered_map<const ExprNode*, const GlslName*> names_;
    std::vector<StageRecipe> stages_;
    std::vector<Expr> kept_;
};

/// The last operation of the function, if it encodes light for a display.
std::string encoding_of(const GlslFunction& function) {
    for (const Expr& e : nodes_of(function.values)) {
        const bool is_srgb = e.op() == ExprOp::multiply &&
                             (e.operand(0).is_constant(12.92) || e.operand(1).is_constant(12.92));
        if (is_srgb) return "has the curve of sRGB";
    }
    Expr last = function.values[0];
    while ((last.op() == ExprOp::minimum || last.op() == ExprOp::maximum) &&
           (last.operand(0).is_constant() || last.operand(1).is_constant()))
        last = last.operand(last.operand(0).is_constant() ? 1 : 0);
    if (last.op() == ExprOp::square_root) return "ends with a square root";
    if (last.op() != ExprOp::power || !last.operand(1).is_constant()) return "";
    // From the power 1/2.6 of cinemas to 1/1.8 of early displays.
    const double exponent = last.operand(1).value();
    if (exponent < 1 / 2.61 || exponent > 1 / 1.79) return "";
    return "ends with the power 1/" + shortest(std::round(100 / exponent) / 100);
}

std::string id_of(const std::string& requested) {
    std::string id;
    for (const char c : lowercase(requested)) {
        const bool is_right = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
        id += is_right ? c : '_';
    }
    if (id.empty() || !(id[0] >= 'a' && id[0] <= 'z')) id = "imported_" + id;
    return id.substr(0, kLongestName);
}

ParameterSpec parameter_of(const GlslParameter& parameter, const ImportedParameter& set) {
    const double a = parameter.value;
    // A range that holds what people try; the file can say another.
    const double near = a == 0 ? -1 : std::min(a / 16, a * 16);
    const double far = a == 0 ? 1 : std::max(a / 16, a * 16);
    const double min = set.min.value_or(near);
    const double max = set.max.value_or(far);
    if (!(min <= a && a <= max)) {
        throw Error("import: parameter " + parameter.name + " is " + shortest(a) + "; expected [" +
                    shortest(min) + ", " + shortest(max) + "]");
    }
    return number_parameter(parameter.name, "", a, min, max, "");
}

const char* output_text(Output output) {
    switch (output) {
        case Output::srgb:
            return "sRGB code values, which the last stage decodes";
        case Output::gamma22:
            return "code values of the power 2.2";
        case Output::gamma24:
            return "code values of the power 2.4";
        case Output::display_linear:
            break;
    }
    return "display-linear";
}

std::string without_folder(const std::string& path) {
    return printable(std::filesystem::path(path).filename().string());
}

/// The function gives no finite number for some color.
class NotFinite : public FormulaError {
  public:
    using FormulaError::FormulaError;
};

/// Adds the parameters of the function, with those values and limits of them that the settings
/// have.
void add_parameters(Operator& op, const GlslFunction& function, const ShaderImport& settings) {
    std::vector<std::string> known;
    for (const GlslParameter& parameter : function.parameters) {
        if (op.parameters.size() == kMostNames) {
            throw FormulaError(parameter.at,
                               "function has " + std::to_string(function.parameters.size()) +
                                   " parameters; expected at most " + std::to_string(kMostNames));
        }
        const std::string why = why_no_parameter(parameter.name, op.parameters);
        if (!why.empty()) throw FormulaError(parameter.at, why);
        const auto set = settings.parameters.find(parameter.name);
        op.parameters.push_back(parameter_of(
            parameter, set == settings.parameters.end() ? ImportedParameter{} : set->second));
        known.push_back(parameter.name);
    }
    for (const auto& [key, parameter] : settings.parameters) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        throw Error("import: <<parameter>> is " + printable(key) + "; expected " +
                    (known.empty() ? "none: the function has no further argument or uniform"
                                   : join_choices(known) + did_you_mean(key, known)));
    }
}

/// The operator without its functions.
Operator described(const GlslFunction& function, const std::string& name,
                   const ShaderImport& settings) {
    const auto& all = named_primaries();
    std::vector<std::string> names;
    names.reserve(all.size());
    for (const auto& primaries : all)
        names.emplace_back(primaries.first);
    Operator op;
    op.working = all[find_choice("primaries", settings.primaries, names)].second;
    op.id = id_of(settings.id.empty() ? function.name : settings.id);
    op.title = printable(function.name);
    op.view = op.title;
    const std::string file = without_folder(name);
    const std::string type = function.is_color ? "vec3" : "float";
    op.source = file + ": " + type + " " + op.title + "(" + type + ")";
    op.negatives = "clamped at 0 before the function";
    add_parameters(op, function, settings);
    return op;
}

/// A clamp of the input, the stages of the function, and those of its output.
std::shared_ptr<const OperatorRecipe> recipe_of(const Stages& made, Operator& op, Output output) {
    const auto recipe = std::make_shared<OperatorRecipe>();
    const TextPosition at = made.function().at;
    recipe->parameters = op.parameters;
    StageRecipe limit;
    limit.kind = Kind::clamp;
    limit.hi = kHalfMax;
    limit.at = at;
    recipe->stages = made.stages();
    recipe->stages.insert(recipe->stages.begin(), limit);
    if (output == Output::srgb) {
        StageRecipe decode;
        decode.kind = Kind::curve;
        decode.f = {srgb_decode(Expr::input())};
        decode.at = at;
        recipe->stages.push_back(decode);
    } else if (output != Output::display_linear) {
        op.output = OutputKind::code_value;
        op.code_power = output == Output::gamma22 ? 2.2 : 2.4;
    }
    if (recipe->stages.size() > kMostStages) {
        throw FormulaError(at, "function becomes " + std::to_string(recipe->stages.size()) +
                                   " stages; expected at most " + std::to_string(kMostStages));
    }
    return recipe;
}

/// Warnings about assumptions; the definition states the others.
void add_warnings(ImportedShader& result, const GlslFunction& function,
                  const ShaderImport& settings, bool limits_powers) {
    const std::string title = "function " + printable(function.name);
    if (const std::string encoding = encoding_of(function); !settings.output && !encoding.empty()) {
        result.warnings.push_back(title + " " + encoding +
                                  ", so its result may be encoded; expected what it is: linear, "
                                  "srgb, gamma22 or gamma24");
    }
    if (limits_powers) {
        result.warnings.push_back(title +
                                  " has powers or square roots of negatives, which GLSL does not "
                                  "define; here they are 0");
    }
}

ImportedShader imported(std::string_view text, const std::string& name,
                        const ShaderImport& settings, bool limits_powers) {
    GlslSettings read;
    read.function = settings.function;
    read.limits_powers = limits_powers;
    for (const auto& [key, parameter] : settings.parameters)
        read.parameters.emplace(key, parameter.value);
    const Stages made(parse_glsl(text, read));
    const GlslFunction& function = made.function();
    const Output output = settings.output.value_or(Output::display_linear);
    Operator op = described(function, name, settings);
    const auto recipe = recipe_of(made, op, output);
    // resolve() makes its own message of what build() throws.
    const auto wrong = std::make_shared<std::string>();
    op.build = [recipe, wrong](const Params& params) {
        try {
            return build_stages(*recipe, recipe->stages, params);
        } catch (const StageError& e) {
            constexpr std::string_view kStage = "stage";
            *wrong = "function" + std::string(e.text()).substr(kStage.size());
            throw;
        }
    };
    ImportedShader result;
    result.function = function.name;
    result.others = function.others;
    add_warnings(result, function, settings, limits_powers);
    std::string assumed = "# Assumed: the input is scene-linear " + std::string(op.working.name) +
                          ", negatives count as 0, the result is " + output_text(output) + ".\n";
    if (limits_powers)
        assumed += "# Powers and square roots of negatives, which GLSL does not define, are 0.\n";
    try {
        const ResolvedOperator resolved = resolve(op, nullptr, {}, "");
        for (const Stage& stage : resolved.build())
            result.stages.emplace_back(stage_kind(stage));
        result.definition = "# From " + op.source + ".\n" + assumed + definition_of(resolved);
        (void)parse_operator(result.definition, "the definition");  // it must be readable
    } catch (const Error& e) {
        if (!wrong->empty()) throw NotFinite(function.at, *wrong);
        throw FormulaError(function.at, e.text());
    }
    return result;
}

}  // namespace

ImportedShader import_shader(std::string_view text, const std::string& name,
                             const ShaderImport& settings) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark)
        text.remove_prefix(kByteOrderMark.size());
    try {
        try {
            return imported(text, name, settings, false);
        } catch (const NotFinite&) {
            return imported(text, name, settings, true);
        }
    } catch (const FormulaError& e) {
        throw DefinitionError(name + ":" + std::to_string(e.at.line) + ":" +
                                  std::to_string(e.at.column) + ": " + e.text(),
                              caret_lines(text, e.at));
    }
}

ImportedShader load_shader(const std::string& path, const ShaderImport& settings) {
    const std::string text = read_file(path, kLongestShader, [&](const Problem& why) {
        throw FileError(within("read: " + path, why));
    });
    return with_memory_for(path, [&] { return import_shader(text, path, settings); });
}

TONEWRIGHT_NAMESPACE_END
