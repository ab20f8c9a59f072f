// SPDX-License-Identifier: Apache-2.0
#include "shader/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "formula/formula.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Binding strength, weakest first.
enum Precedence { kAny = 0, kComparison = 1, kSum = 2, kProduct = 3, kUnary = 4, kAtom = 5 };

/// Longer expressions become a variable before they are part of another one.
constexpr std::size_t kLongest = 72;

bool is_leaf(const Expr& e) { return e.operand_count() == 0; }

/// True when all leaves below operations of this kind are the channels of the color.
bool is_of_channels(const Expr& e, ExprOp op) {
    if (e.op() == ExprOp::input) return e.input_index() < 3;
    return e.op() == op && is_of_channels(e.operand(0), op) && is_of_channels(e.operand(1), op);
}

/// a r + b g + c b
bool is_weighted_sum(const Expr& e) {
    if (e.op() == ExprOp::add)
        return is_weighted_sum(e.operand(0)) && is_weighted_sum(e.operand(1));
    return e.op() == ExprOp::multiply && e.operand(0).is_constant() &&
           e.operand(1).op() == ExprOp::input && e.operand(1).input_index() < 3;
}

const char* word_for(const Expr& e) {
    if (e.op() == ExprOp::maximum && is_of_channels(e, ExprOp::maximum)) return "largest";
    if (e.op() == ExprOp::minimum && is_of_channels(e, ExprOp::minimum)) return "smallest";
    if (e.op() == ExprOp::add && is_weighted_sum(e)) return "weighted";
    switch (e.op()) {
        case ExprOp::add:
            return "sum";
        case ExprOp::subtract:
            return "difference";
        case ExprOp::multiply:
            return "product";
        case ExprOp::divide:
            return "ratio";
        case ExprOp::minimum:
        case ExprOp::maximum:
            return "limited";
        case ExprOp::power:
        case ExprOp::exp2:
            return "power";
        case ExprOp::log2:
            return "logarithm";
        case ExprOp::square_root:
            return "root";
        case ExprOp::negate:
            return "opposite";
        case ExprOp::absolute:
            return "magnitude";
        case ExprOp::atan2:
            return "angle";
        case ExprOp::sine:
            return "sine";
        case ExprOp::cosine:
            return "cosine";
        case ExprOp::floor:
            return "whole";
        case ExprOp::select:
            return "chosen";
        case ExprOp::lookup:
            return "entry";
        case ExprOp::less:
        case ExprOp::less_equal:
            return "is_below";
        case ExprOp::equal:
            return "is_equal";
        default:
            return "value";
    }
}

constexpr std::array kChannels = {"_r", "_g", "_b"};

/// Converts a name of a formula to one that every language accepts.
std::string as_variable(const std::string& name) {
    // Likely names that are reserved in one of the languages.
    static const std::set<std::string, std::less<>> reserved = {
        "active",    "auto",     "bool",      "break",     "buffer",    "case",    "cast",
        "centroid",  "char",     "class",     "closure",   "coherent",  "color",   "common",
        "const",     "constant", "continue",  "default",   "delete",    "device",  "discard",
        "do",        "double",   "else",      "emit",      "enum",      "export",  "extern",
        "external",  "false",    "filter",    "final",     "fixed",     "flat",    "float",
        "fn",        "for",      "from",      "function",  "get",       "global",  "goto",
        "half",      "highp",    "if",        "image",     "import",    "in",      "inline",
        "inout",     "input",    "int",       "interface", "kernel",    "let",     "line",
        "local",     "long",     "loop",      "lowp",      "matrix",    "mediump", "metal",
        "mod",       "module",   "move",      "mut",       "namespace", "new",     "noise",
        "normal",    "null",     "of",        "operator",  "out",       "output",  "override",
        "packed",    "param",    "partition", "pass",      "patch",     "point",   "precise",
        "precision", "private",  "protected", "public",    "read",      "ref",     "register",
        "resource",  "return",   "sample",    "sampler",   "self",      "set",     "shared",
        "short",     "signed",   "sizeof",    "smooth",    "static",    "storage", "string",
        "struct",    "super",    "switch",    "target",    "template",  "texture", "this",
        "thread",    "throw",    "triangle",  "true",      "try",       "type",    "typedef",
        "uniform",   "union",    "unsigned",  "use",       "using",     "var",     "varying",
        "vector",    "virtual",  "void",      "volatile",  "where",     "while",   "with",
        "write",     "yield",    "dot",       "cross",     "fract",     "frac",    "length",
        "lerp",      "saturate", "select",    "sign",      "step",      "vec3"};
    std::string result;
    for (const char c : name) {
        const bool is_sign = c == '_' || c == '.';
        if (is_sign && (result.empty() || result.back() == '_')) continue;
        result += is_sign ? '_' : c;
    }
    while (!result.empty() && result.back() == '_')
        result.pop_back();
    const bool is_taken = reserved.contains(result) || is_formula_function(result);
    for (const char* prefix : {"gl_", "tw_"}) {
        if (result.compare(0, 3, prefix) == 0) result.insert(0, "own_");
    }
    return result.empty() || is_taken ? result + "_value" : result;
}

}  // namespace

FunctionBody::FunctionBody(const LanguageFacts& language, std::vector<std::string> inputs,
                           std::set<std::string> taken, std::map<double, std::string> names,
                           std::map<const void*, TableText> tables)
    : language_(language),
      inputs_(std::move(inputs)),
      taken_(std::move(taken)),
      names_(std::move(names)),
      tables_(std::move(tables)) {}

void FunctionBody::count(const Expr& e) {
    parts_.take(e);
    if (++uses_[e.node()] > 1) return;
    if (const std::string* name = parts_.of(e); name && !is_leaf(e))
        named_[*name].push_back(e.node());
    if (const auto name = e.is_constant() ? names_.find(e.value()) : names_.end();
        name != names_.end()) {
        const std::string variable = unique(as_variable(name->second));
        add_line(language_.number, variable, float_literal(e.value(), language_));
        variables_.emplace(e.value(), variable);
    }
    for (int i = 0; i < e.operand_count(); ++i)
        count(e.operand(i));
    // The search reads the number, too, which so becomes a variable.
    if (e.op() != ExprOp::lookup) return;
    const auto table = tables_.find(e.table().get());
    if (table != tables_.end() && !table->second.cell_function.empty()) count(e.operand(0));
}

std::string FunctionBody::value(const Expr& e) {
    const bool is_variable = uses_[e.node()] > 1 || known_.contains(e.node());
    return number(is_variable ? print(e) : compose(e), kAny);
}

void FunctionBody::add_input(const std::string& name, const std::string& value) {
    const std::string own = unique(name);
    add_line(language_.number, own, value);
    inputs_.push_back(own);
}

FunctionBody::Text FunctionBody::print(const Expr& e) {
    if (const auto known = known_.find(e.node()); known != known_.end()) return known->second;
    Text text = compose(e);
    // Names of the source become variables.
    if (is_leaf(e) || (uses_[e.node()] < 2 && !parts_.of(e))) return text;
    const std::string name = name_for(e);
    add_line(text.is_condition ? language_.boolean : language_.number, name, text.text);
    text = {name, kAtom, text.is_condition};
    known_.emplace(e.node(), text);
    return text;
}

FunctionBody::Text FunctionBody::compose(const Expr& e) {
    const auto part = [&](int i) { return e.operand(i); };
    // A right operand of the same strength keeps its brackets: a + (b + c) rounds differently from
    // (a + b) + c.
    const auto binary = [&](const char* sign, int precedence) -> Text {
        std::string a = operand(part(0), precedence);
        return {a + sign + operand(part(1), precedence + 1), precedence};
    };
    const auto call = [&](const char* name) -> Text {
        std::string text = std::string(name) + "(";
        for (int i = 0; i < e.operand_count(); ++i)
            text += (i ? ", " : "") + operand(part(i), kAny);
        return {text + ")", kAtom};
    };
    const auto compare = [&](const char* sign) -> Text {
        std::string a = operand(part(0), kSum);
        return {a + sign + operand(part(1), kSum), kComparison, true};
    };
    /// Operator of two conditions; otherwise a call.
    const auto both = [&](const char* sign) -> Text {
        const Text a = print(part(0));
        const Text b = print(part(1));
        if (!a.is_condition || !b.is_condition) return {};
        return {"(" + a.text + sign + b.text + ")", kAtom, true};
    };
    switch (e.op()) {
        case ExprOp::constant: {
            std::string text = literal(e.value());
            const int precedence = text.front() == '-' ? kUnary : kAtom;
            return {std::move(text), precedence};
        }
        case ExprOp::input:
            return {inputs_.at(static_cast<std::size_t>(e.input_index())), kAtom};
        case ExprOp::uniform:
            return {e.uniform_name(), kAtom};
        case ExprOp::add:
            if (part(1).is_constant() && part(1).value() < 0) {
                return {operand(part(0), kSum) + " - " + literal(-part(1).value()), kSum};
            }
            if (const Expr& b = part(1); b.op() == ExprOp::multiply && uses_[b.node()] < 2 &&
                                         b.operand(0).is_constant() && b.operand(0).value() < 0) {
                const std::string a = operand(part(0), kSum);
                return {fmt::format("{} - {} * {}", a, literal(-b.operand(0).value()),
                                    operand(b.operand(1), kProduct + 1)),
                        kSum};
            }
            return binary(" + ", kSum);
        case ExprOp::subtract:
            if (part(1).is_constant() && part(1).value() < 0) {
                return {operand(part(0), kSum) + " + " + literal(-part(1).value()), kSum};
            }
            return binary(" - ", kSum);
        case ExprOp::multiply:
            if (Text text = both(" && "); text.is_condition) return text;
            return binary(" * ", kProduct);
        case ExprOp::divide:
            return binary(" / ", kProduct);
        case ExprOp::negate:
            return {"-" + operand(part(0), kAtom), kUnary};
        case ExprOp::minimum:
            if (Text text = both(" && "); text.is_condition) return text;
            return call(language_.minimum);
        case ExprOp::maximum:
            if (Text text = both(" || "); text.is_condition) return text;
            return call(language_.maximum);
        case ExprOp::power:
            return call(language_.power);
        case ExprOp::atan2:
            return call(language_.atan2);
        case ExprOp::absolute:
            return call(language_.absolute);
        case ExprOp::square_root:
            return call(language_.square_root);
        case ExprOp::exp2:
            if (*language_.exp2) return call(language_.exp2);
            return {fmt::format("{}({}, {})", language_.power, float_literal(2, language_),
                                operand(part(0), kAny)),
                    kAtom};
        case ExprOp::log2:
            return call(language_.log2);
        case ExprOp::sine:
            return call(language_.sine);
        case ExprOp::cosine:
            return call(language_.cosine);
        case ExprOp::floor:
            return call(language_.floor);
        case ExprOp::less:
            return compare(" < ");
        case ExprOp::less_equal:
            return compare(" <= ");
        case ExprOp::equal:
            return compare(" == ");
        case ExprOp::select:
            return {choose(e), *language_.choose == '{' ? kAny : kAtom};
        case ExprOp::lookup:
            return {table_value(e), kAtom};
        case ExprOp::grid:
            return {grid_channel(e), kAtom};
    }
    return {};
}

std::string FunctionBody::table_value(const Expr& e) {
    const TableText& table = tables_.at(e.table().get());
    const std::string x = operand(e.operand(0), kAny);
    const std::string argument =
        "(" + x + (table.texture.empty() ? "" : ", ") + table.texture + ")";
    if (table.cell_function.empty()) return table.function + argument;
    std::string& cell = cells_[table.cell_function + argument];
    if (cell.empty()) {
        cell = unique("cell");
        add_line(language_.integer, cell, table.cell_function + argument);
    }
    return fmt::format(fmt::runtime(table.function), fmt::arg("cell", cell), fmt::arg("x", x));
}

std::string FunctionBody::grid_channel(const Expr& e) {
    std::string color;
    for (int i = 0; i < 3; ++i)
        color += (i ? ", " : "") + operand(e.operand(i), kAny);
    const TableText& grid = tables_.at(e.grid().get());
    const std::string call = fmt::format("{}({}({}){}{})", grid.function, language_.make_color,
                                         color, grid.texture.empty() ? "" : ", ", grid.texture);
    std::string& name = grid_colors_[call];
    if (name.empty()) {
        name = unique("node");
        add_line(language_.color, name, call);
    }
    return name + language_.channel[static_cast<std::size_t>(e.channel())];
}

std::string FunctionBody::operand(const Expr& e, int precedence) {
    Text text = print(e);
    if (text.text.size() > kLongest && !is_leaf(e)) {
        const std::string name = name_for(e);
        add_line(text.is_condition ? language_.boolean : language_.number, name, text.text);
        text = {name, kAtom, text.is_condition};
        known_.emplace(e.node(), text);
    }
    return number(text, precedence);
}

std::string FunctionBody::number(const Text& t, int precedence) const {
    if (!t.is_condition) return t.precedence < precedence ? "(" + t.text + ")" : t.text;
    const std::string text = fmt::format(
        fmt::runtime(language_.choose), fmt::arg("condition", t.text),
        fmt::arg("yes", float_literal(1, language_)), fmt::arg("no", float_literal(0, language_)));
    return precedence > kAny && *language_.choose == '{' ? "(" + text + ")" : text;
}

std::string FunctionBody::condition(const Text& t) const {
    if (t.is_condition) return t.text;
    return number(t, kSum) + " != " + float_literal(0, language_);
}

std::string FunctionBody::choose(const Expr& e) {
    const std::string is_true = condition(print(e.operand(0)));
    const std::string yes = operand(e.operand(1), kComparison);
    const std::string no = operand(e.operand(2), kComparison);
    return fmt::format(fmt::runtime(language_.choose), fmt::arg("condition", is_true),
                       fmt::arg("yes", yes), fmt::arg("no", no));
}

std::string FunctionBody::name_for(const Expr& e) {
    if (const std::string* name = parts_.of(e)) {
        // Per-channel expressions of a source have the same name three times.
        const std::vector<const ExprNode*>& alike = named_[*name];
        const auto place = std::find(alike.begin(), alike.end(), e.node()) - alike.begin();
        const bool is_channel = inputs_.size() >= 3 && alike.size() == 3;
        return unique(as_variable(*name) + (is_channel ? kChannels.at(std::size_t(place)) : ""));
    }
    // x2, x4, x6 of x: the powers of a polynomial.
    if (e.op() == ExprOp::multiply) {
        const auto power_of = [&](const Expr& factor) -> std::pair<std::string, int> {
            if (const auto power = powers_.find(factor.node()); power != powers_.end())
                return power->second;
            const auto known = known_.find(factor.node());
            if (known != known_.end()) return {known->second.text, 1};
            if (factor.op() == ExprOp::input && inputs_.size() == 1) return {inputs_[0], 1};
            return {"", 0};
        };
        const auto [a, m] = power_of(e.operand(0));
        const auto [b, n] = power_of(e.operand(1));
        const std::string name = a + std::to_string(m + n);
        if (m > 0 && a == b && !taken_.contains(name)) {
            powers_.emplace(e.node(), std::pair(a, m + n));
            return unique(name);
        }
    }
    return unique(word_for(e));
}

std::string FunctionBody::unique(const std::string& name) {
    std::string result = name;
    for (int number = 2; !taken_.insert(result).second; ++number)
        result = name + "_" + std::to_string(number);
    return result;
}

std::string FunctionBody::literal(double value) const {
    const auto variable = variables_.find(value);
    return variable != variables_.end() ? variable->second : float_literal(value, language_);
}

void FunctionBody::add_line(const char* type, const std::string& name, const std::string& value) {
    lines_ += "    " +
              fmt::format(fmt::runtime(language_.let), fmt::arg("type", type),
                          fmt::arg("name", name), fmt::arg("value", value)) +
              "\n";
}

TONEWRIGHT_NAMESPACE_END
