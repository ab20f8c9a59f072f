// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl_value.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "base/strings.h"
#include "formula/characters.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Type = GlslType;
using Base = Type::Base;
using Value = GlslValue;
using Values = std::vector<Value>;
using Operands = std::span<const Expr>;

/// Sums of differences come to what was subtracted from: mix(a, b, 1) is b.
Expr plus(const Expr& a, const Expr& b) {
    if (b.op() == ExprOp::subtract && same(b.operand(1), a)) return b.operand(0);
    return a + b;
}
Expr truncated(const Expr& a) { return select(less(a, 0), -floor(-a), floor(a)); }

struct Function {
    std::string_view name;
    std::size_t operands;
    int cost;  // operations of one component, at most
    Expr (*make)(Operands in);
};

// Component by component.
constexpr Function kFunctions[] = {
    {"abs", 1, 1, [](Operands in) { return abs(in[0]); }},
    {"acos", 1, 5, [](Operands in) { return atan2(sqrt(1 - in[0] * in[0]), in[0]); }},
    {"asin", 1, 5, [](Operands in) { return atan2(in[0], sqrt(1 - in[0] * in[0])); }},
    {"atan", 1, 1, [](Operands in) { return atan2(in[0], 1); }},
    {"atan", 2, 1, [](Operands in) { return atan2(in[0], in[1]); }},
    {"atan2", 2, 1, [](Operands in) { return atan2(in[0], in[1]); }},
    {"ceil", 1, 3, [](Operands in) { return -floor(-in[0]); }},
    {"clamp", 3, 2, [](Operands in) { return clamp(in[0], in[1], in[2]); }},
    {"cos", 1, 1, [](Operands in) { return cos(in[0]); }},
    {"cosh", 1, 6, [](Operands in) { return (exp(in[0]) + exp(-in[0])) * 0.5; }},
    {"degrees", 1, 1, [](Operands in) { return in[0] * (180 / std::numbers::pi); }},
    {"exp", 1, 2, [](Operands in) { return exp(in[0]); }},
    {"exp2", 1, 1, [](Operands in) { return exp2(in[0]); }},
    {"floor", 1, 1, [](Operands in) { return floor(in[0]); }},
    {"fma", 3, 2, [](Operands in) { return in[0] * in[1] + in[2]; }},
    {"fmod", 2, 8, [](Operands in) { return in[0] - in[1] * truncated(in[0] / in[1]); }},
    {"frac", 1, 2, [](Operands in) { return in[0] - floor(in[0]); }},
    {"fract", 1, 2, [](Operands in) { return in[0] - floor(in[0]); }},
    {"inversesqrt", 1, 2, [](Operands in) { return 1 / sqrt(in[0]); }},
    {"log", 1, 2, [](Operands in) { return log(in[0]); }},
    {"log10", 1, 2, [](Operands in) { return log10(in[0]); }},
    {"log2", 1, 1, [](Operands in) { return log2(in[0]); }},
    {"mad", 3, 2, [](Operands in) { return in[0] * in[1] + in[2]; }},
    {"max", 2, 1, [](Operands in) { return max(in[0], in[1]); }},
    {"min", 2, 1, [](Operands in) { return min(in[0], in[1]); }},
    {"mod", 2, 4, [](Operands in) { return in[0] - in[1] * floor(in[0] / in[1]); }},
    {"pow", 2, 1, [](Operands in) { return pow(in[0], in[1]); }},
    {"radians", 1, 1, [](Operands in) { return in[0] * (std::numbers::pi / 180); }},
    {"rcp", 1, 1, [](Operands in) { return 1 / in[0]; }},
    {"round", 1, 2, [](Operands in) { return floor(in[0] + 0.5); }},
    {"rsqrt", 1, 2, [](Operands in) { return 1 / sqrt(in[0]); }},
    {"saturate", 1, 2, [](Operands in) { return clamp(in[0], 0, 1); }},
    {"sign", 1, 4, [](Operands in) { return select(less(0, in[0]), 1, -less(in[0], 0)); }},
    {"sin", 1, 1, [](Operands in) { return sin(in[0]); }},
    {"sinh", 1, 6, [](Operands in) { return (exp(in[0]) - exp(-in[0])) * 0.5; }},
    {"smoothstep", 3, 9, [](Operands in) { return smoothstep(in[0], in[1], in[2]); }},
    {"sqrt", 1, 1, [](Operands in) { return sqrt(in[0]); }},
    {"step", 2, 1, [](Operands in) { return less_equal(in[0], in[1]); }},
    {"tan", 1, 3, [](Operands in) { return sin(in[0]) / cos(in[0]); }},
    {"tanh", 1, 6, [](Operands in) { return 1 - 2 / (exp(2 * in[0]) + 1); }},
    {"trunc", 1, 6, [](Operands in) { return truncated(in[0]); }},
};

[[noreturn]] void misuse(const std::string& message) { throw GlslMisuse(message); }

Base wider(Base a, Base b) { return std::max(a, b); }

std::string operand_names(const Value& a, const Value& b) {
    return glsl_name(a.type) + " and " + glsl_name(b.type);
}

/// The type of what is computed of both, component by component.
Type common(std::string_view what, const Value& a, const Value& b) {
    const bool is_same = a.type.size == b.type.size && a.type.is_matrix == b.type.is_matrix &&
                         a.type.is_hlsl == b.type.is_hlsl;
    if (!is_same && !a.type.is_scalar() && !b.type.is_scalar()) {
        misuse(std::string(what) + " has " + operand_names(a, b) +
               "; expected two of one size, or a number beside them");
    }
    Type type = a.type.is_scalar() ? b.type : a.type;
    type.base = wider(a.type.base, b.type.base);
    return type;
}

const Expr& component(const Value& value, std::size_t i) {
    return value.e[value.type.is_scalar() ? 0 : i];
}

template <class Make>
Value each(const Type& type, int depth, const Make& make) {
    Value result{type, {}, depth};
    for (std::size_t i = 0; i < type.components(); ++i)
        result.e.push_back(make(i));
    return result;
}

Value combined(std::string_view what, const Value& a, const Value& b,
               Expr (*make)(const Expr& a, const Expr& b)) {
    return each(common(what, a, b), std::max(a.depth, b.depth) + 1,
                [&](std::size_t i) { return make(component(a, i), component(b, i)); });
}

Value compared(std::string_view what, const Value& a, const Value& b,
               Expr (*make)(const Expr& a, const Expr& b)) {
    if (a.type.is_matrix || b.type.is_matrix)
        misuse(std::string(what) + " has " + operand_names(a, b) + "; expected numbers or vectors");
    Value result = combined(what, a, b, make);
    result.type.base = Base::boolean;
    result.depth += 1;
    return result;
}

Expr not_equal(const Expr& a, const Expr& b) { return select(equal(a, b), 0, 1); }
Expr greater(const Expr& a, const Expr& b) { return less(b, a); }
Expr greater_equal(const Expr& a, const Expr& b) { return less_equal(b, a); }
Expr both(const Expr& a, const Expr& b) { return select(a, truth(b), 0); }
Expr either(const Expr& a, const Expr& b) { return select(a, 1, truth(b)); }

Value product_of_matrices(const Value& a, const Value& b) {
    const std::size_t n = a.type.size;
    return each(a.type, std::max(a.depth, b.depth) + static_cast<int>(n), [&](std::size_t i) {
        Expr sum = 0;
        for (std::size_t k = 0; k < n; ++k)
            sum = sum + a.e[i / n * n + k] * b.e[k * n + i % n];
        return sum;
    });
}

// -- Functions that are not computed component by component. `what` is their name for messages.

void require_vectors(const std::string& what, const Values& in) {
    for (const Value& value : in) {
        const bool is_right = !value.type.is_matrix && value.type.base != Base::boolean &&
                              value.type.size == in[0].type.size;
        if (!is_right)
            misuse(what + " has " + glsl_name(value.type) + "; expected vectors of one size");
    }
}

Value dot(const std::string& what, const Values& in) {
    require_vectors(what, in);
    const Value &a = in[0], &b = in[1];
    Expr sum = 0;
    for (std::size_t i = 0; i < a.e.size(); ++i)
        sum = sum + a.e[i] * b.e[i];
    return {{}, {sum}, std::max(a.depth, b.depth) + static_cast<int>(a.e.size())};
}

Value length(const std::string& what, const Values& in) {
    const Value square = dot(what, {in[0], in[0]});
    return {{}, {sqrt(square.e[0])}, square.depth + 1};
}

Value distance(const std::string& what, const Values& in) {
    require_vectors(what, in);
    return length(what, {glsl_binary("-", in[0], in[1])});
}

Value normalize(const std::string& what, const Values& in) {
    return glsl_binary("/", in[0], length(what, in));
}

Value cross(const std::string& what, const Values& in) {
    require_vectors(what, in);
    const Value &a = in[0], &b = in[1];
    if (a.type.size != 3) misuse(what + " has " + glsl_name(a.type) + "; expected vec3");
    return each(a.type, std::max(a.depth, b.depth) + 2, [&](std::size_t i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        return a.e[j] * b.e[k] - a.e[k] * b.e[j];
    });
}

Value mix_or_lerp(const std::string& what, const Values& in) {
    const Value &a = in[0], &b = in[1], &t = in[2];
    if (t.type.base == Base::boolean) return glsl_select(t, b, a);
    const Type type = common(what, {common(what, a, b), {}, 1}, t);
    return each(type, std::max({a.depth, b.depth, t.depth}) + 3, [&](std::size_t i) {
        return plus(component(a, i), component(t, i) * (component(b, i) - component(a, i)));
    });
}

Value joined(const std::string& what, const Values& in,
             Expr (*join)(const Expr& a, const Expr& b)) {
    if (in[0].type.base != Base::boolean)
        misuse(what + " has " + glsl_name(in[0].type) + "; expected bvec2, bvec3 or bvec4");
    Expr result = in[0].e[0];
    for (std::size_t i = 1; i < in[0].e.size(); ++i)
        result = join(result, in[0].e[i]);
    return {{Base::boolean}, {result}, in[0].depth + 8};
}

Value transpose(const std::string& what, const Values& in) {
    if (!in[0].type.is_matrix)
        misuse(what + " has " + glsl_name(in[0].type) + "; expected a matrix");
    const std::size_t n = in[0].type.size;
    return each(in[0].type, in[0].depth, [&](std::size_t i) { return in[0].e[i % n * n + i / n]; });
}

/// HLSL's mul(), and GLSL's * of matrices.
Value mul(const std::string& what, const Values& in) {
    const Value &a = in[0], &b = in[1];
    if (a.type.is_scalar() || b.type.is_scalar()) return glsl_binary("*", a, b);
    if (!a.type.is_matrix && !b.type.is_matrix) return dot(what, in);
    if (a.type.size != b.type.size)
        misuse(what + " has " + operand_names(a, b) + "; expected two of one size");
    if (a.type.is_matrix && b.type.is_matrix) return product_of_matrices(a, b);
    const bool is_row = b.type.is_matrix;  // a row of numbers times a matrix
    const Value& vector = is_row ? a : b;
    const Value& matrix = is_row ? b : a;
    const std::size_t n = vector.type.size;
    return each({Base::number, n}, std::max(a.depth, b.depth) + static_cast<int>(n),
                [&](std::size_t i) {
                    Expr sum = 0;
                    for (std::size_t k = 0; k < n; ++k)
                        sum = sum + matrix.e[is_row ? k * n + i : i * n + k] * vector.e[k];
                    return sum;
                });
}

template <Expr (*compare)(const Expr& a, const Expr& b)>
Value compare_each(const std::string& what, const Values& in) {
    return compared(what, in[0], in[1], compare);
}

struct VectorFunction {
    std::string_view name;
    std::size_t operands;
    Value (*make)(const std::string& what, const Values& in);
};

constexpr VectorFunction kVectorFunctions[] = {
    {"all", 1, [](const std::string& what, const Values& in) { return joined(what, in, both); }},
    {"any", 1, [](const std::string& what, const Values& in) { return joined(what, in, either); }},
    {"cross", 2, cross},
    {"distance", 2, distance},
    {"dot", 2, dot},
    {"equal", 2, compare_each<equal>},
    {"greaterThan", 2, compare_each<greater>},
    {"greaterThanEqual", 2, compare_each<greater_equal>},
    {"length", 1, length},
    {"lerp", 3, mix_or_lerp},
    {"lessThan", 2, compare_each<less>},
    {"lessThanEqual", 2, compare_each<less_equal>},
    {"mix", 3, mix_or_lerp},
    {"mul", 2, mul},
    {"normalize", 1, normalize},
    {"not", 1, [](const std::string&, const Values& in) { return glsl_not(in[0]); }},
    {"notEqual", 2, compare_each<not_equal>},
    {"transpose", 1, transpose},
};

Value call_each(const Function& f, const std::string& what, const Values& in) {
    Value so_far{in[0].type, {}, 1};
    int depth = 0;
    for (const Value& value : in) {
        if (value.type.base == Base::boolean || value.type.is_matrix)
            misuse(what + " has " + glsl_name(value.type) + "; expected numbers or vectors");
        so_far.type = common(what, so_far, value);
        depth = std::max(depth, value.depth);
    }
    constexpr std::string_view kOfIntegers[] = {"abs", "clamp", "max", "min", "sign"};
    const bool keeps_integers =
        std::find(std::begin(kOfIntegers), std::end(kOfIntegers), f.name) != std::end(kOfIntegers);
    if (!keeps_integers) so_far.type.base = Base::number;
    return each(so_far.type, depth + f.cost, [&](std::size_t i) {
        std::vector<Expr> operands;
        for (const Value& value : in)
            operands.push_back(component(value, i));
        return f.make(operands);
    });
}

}  // namespace

std::optional<GlslType> glsl_type(std::string_view name) {
    struct Named {
        std::string_view name;
        Base base;
    };
    constexpr Named kScalars[] = {{"float", Base::number},  {"half", Base::number},
                                  {"real", Base::number},   {"fixed", Base::number},
                                  {"double", Base::number}, {"int", Base::integer},
                                  {"uint", Base::integer},  {"bool", Base::boolean}};
    constexpr Named kVectors[] = {
        {"vec", Base::number}, {"ivec", Base::integer}, {"bvec", Base::boolean}};
    const auto digit = [](std::string_view text) -> std::size_t {
        return text.size() == 1 && text[0] >= '2' && text[0] <= '4'
                   ? static_cast<std::size_t>(text[0] - '0')
                   : 0;
    };
    for (const Named& scalar : kScalars) {
        if (name.substr(0, scalar.name.size()) != scalar.name) continue;
        const std::string_view rest = name.substr(scalar.name.size());
        if (rest.empty()) return Type{scalar.base};
        if (const std::size_t n = digit(rest)) return Type{scalar.base, n};
        const std::size_t n = digit(rest.substr(0, 1));
        if (n && rest.size() == 3 && rest[1] == 'x' && digit(rest.substr(2)) == n &&
            scalar.base == Base::number)
            return Type{scalar.base, n, true, true};
    }
    for (const Named& vector : kVectors) {
        if (name.substr(0, vector.name.size()) != vector.name) continue;
        if (const std::size_t n = digit(name.substr(vector.name.size())))
            return Type{vector.base, n};
    }
    if (name.substr(0, 3) == "mat") {
        const std::string_view rest = name.substr(3);
        const std::size_t n = digit(rest.substr(0, 1));
        const bool is_square =
            rest.size() == 1 || (rest.size() == 3 && rest[1] == 'x' && digit(rest.substr(2)) == n);
        if (n && is_square) return Type{Base::number, n, true};
    }
    return std::nullopt;
}

std::string glsl_name(const GlslType& type) {
    const std::string size = std::to_string(type.size);
    if (type.is_matrix) return type.is_hlsl ? "float" + size + "x" + size : "mat" + size;
    const bool is_scalar = type.is_scalar();
    switch (type.base) {
        case Base::boolean:
            return is_scalar ? "bool" : "bvec" + size;
        case Base::integer:
            return is_scalar ? "int" : "ivec" + size;
        case Base::number:
            break;
    }
    return is_scalar ? "float" : "vec" + size;
}

GlslValue glsl_binary(std::string_view sign, const GlslValue& a, const GlslValue& b) {
    if (sign == "&&" || sign == "||") {
        for (const Value* value : {&a, &b}) {
            if (value->type.base != Base::boolean || value->type.is_matrix)
                misuse("operator " + std::string(sign) + " has " + operand_names(a, b) +
                       "; expected bool");
        }
        Value result = combined(sign, a, b, sign == "&&" ? both : either);
        result.depth += 2;
        return result;
    }
    const std::string what = "operator " + std::string(sign);
    if (sign == "<") return compared(what, a, b, less);
    if (sign == "<=") return compared(what, a, b, less_equal);
    if (sign == ">") return compared(what, a, b, greater);
    if (sign == ">=") return compared(what, a, b, greater_equal);
    if (sign == "==" || sign == "!=") {
        if (!a.type.is_scalar() || !b.type.is_scalar())
            misuse(what + " has " + operand_names(a, b) + "; expected two numbers");
        return compared(what, a, b, sign == "==" ? equal : not_equal);
    }
    if (a.type.base == Base::boolean || b.type.base == Base::boolean)
        misuse(what + " has " + operand_names(a, b) + "; expected numbers, vectors or matrices");
    if (sign == "+") return combined(what, a, b, plus);
    if (sign == "-") {
        return combined(what, a, b, [](const Expr& x, const Expr& y) { return x - y; });
    }
    if (sign == "/") {
        if (a.type.base == Base::integer && b.type.base == Base::integer)
            misuse(what + " has two integers, whose quotient is an integer; expected 1.0/2.0");
        if (b.type.is_matrix)
            misuse(what + " has " + operand_names(a, b) + "; expected a matrix before it only");
        return combined(what, a, b, [](const Expr& x, const Expr& y) { return x / y; });
    }
    const bool is_product_of_matrix =
        (a.type.is_matrix && !b.type.is_scalar()) || (b.type.is_matrix && !a.type.is_scalar());
    if (!is_product_of_matrix)
        return combined(what, a, b, [](const Expr& x, const Expr& y) { return x * y; });
    if (a.type.is_hlsl || b.type.is_hlsl)
        misuse(what + " has " + operand_names(a, b) + "; expected mul(a, b), as HLSL has it");
    if (a.type.size != b.type.size)
        misuse(what + " has " + operand_names(a, b) + "; expected two of one size");
    return mul(what, {a, b});
}

GlslValue glsl_negative(const GlslValue& a) {
    if (a.type.base == Base::boolean) misuse("operator - has bool; expected a number");
    return each(a.type, a.depth + 1, [&](std::size_t i) { return -a.e[i]; });
}

GlslValue glsl_not(const GlslValue& a) {
    if (a.type.base != Base::boolean)
        misuse("operator ! has " + glsl_name(a.type) + "; expected bool");
    return each(a.type, a.depth + 1, [&](std::size_t i) { return select(a.e[i], 0, 1); });
}

GlslValue glsl_select(const GlslValue& condition, const GlslValue& yes, const GlslValue& no) {
    if (condition.type.base != Base::boolean)
        misuse("condition is " + glsl_name(condition.type) + "; expected bool, such as x < 1.0");
    const Type type = common("choice", yes, no);
    if (!condition.type.is_scalar() && condition.type.components() != type.components()) {
        misuse("condition is " + glsl_name(condition.type) + " for a choice of " + glsl_name(type) +
               "; expected bool, or one for each component");
    }
    return each(type, std::max({condition.depth, yes.depth, no.depth}) + 1, [&](std::size_t i) {
        return select(component(condition, i), component(yes, i), component(no, i));
    });
}

GlslValue glsl_construct(const GlslType& type, const std::vector<GlslValue>& parts) {
    const std::size_t n = type.components();
    if (parts.empty()) misuse(glsl_name(type) + "() has no operands; expected some");
    Value result{type, {}, 1};
    for (const Value& part : parts)
        result.depth = std::max(result.depth, part.depth);
    const auto as_base = [&](const Value& part, const Expr& e) {
        if (type.base == Base::integer && part.type.base == Base::number) return truncated(e);
        return type.base == Base::boolean ? truth(e) : e;
    };
    result.depth += type.base == Base::number ? 0 : 6;
    const Value& first = parts[0];
    if (parts.size() == 1 && first.type.is_scalar()) {
        for (std::size_t i = 0; i < n; ++i) {
            const bool is_set = !type.is_matrix || i % (type.size + 1) == 0;
            result.e.push_back(is_set ? as_base(first, first.e[0]) : Expr(0));
        }
        return result;
    }
    if (parts.size() == 1 && first.type.is_matrix) {
        if (!type.is_matrix || first.type.size < type.size) {
            misuse(glsl_name(type) + "() has " + glsl_name(first.type) +
                   "; expected numbers and vectors");
        }
        for (std::size_t i = 0; i < n; ++i)
            result.e.push_back(first.e[i / type.size * first.type.size + i % type.size]);
        return result;
    }
    std::size_t given = 0;
    for (const Value& part : parts) {
        if (part.type.is_matrix)
            misuse(glsl_name(type) + "() has " + glsl_name(part.type) +
                   " beside others; expected numbers and vectors");
        // The last vector may have more than are needed: vec3(v4).
        if (given >= n) given = n + 1;
        for (std::size_t i = 0; i < part.e.size() && given < n; ++i, ++given)
            result.e.push_back(as_base(part, part.e[i]));
    }
    const bool is_cut = parts.size() == 1 && first.e.size() > n;
    if (given != n || (type.is_matrix && is_cut)) {
        misuse(glsl_name(type) + "() has " + (given > n ? "more than " : "") +
               std::to_string(std::min(given, n)) + " numbers; expected " + std::to_string(n));
    }
    if (type.is_matrix && !type.is_hlsl) {  // they came column by column
        Value rows = result;
        for (std::size_t i = 0; i < n; ++i)
            rows.e[i] = result.e[i % type.size * type.size + i / type.size];
        return rows;
    }
    return result;
}

bool glsl_converts(const GlslType& from, const GlslType& to) {
    const bool is_base =
        from.base == to.base || (from.base == Base::integer && to.base == Base::number);
    const bool is_size =
        from.size == to.size && from.is_matrix == to.is_matrix && from.is_hlsl == to.is_hlsl;
    const bool is_spread = from.is_scalar() && to.is_vector();
    return is_base && (is_size || is_spread);
}

GlslValue glsl_convert(const GlslValue& value, const GlslType& type) {
    if (value.type == type) return value;
    if (!glsl_converts(value.type, type))
        misuse("value is " + glsl_name(value.type) + "; expected " + glsl_name(type));
    return each(type, value.depth, [&](std::size_t i) { return component(value, i); });
}

bool is_glsl_function(std::string_view name) {
    const auto has_name = [&](const auto& f) { return f.name == name; };
    return std::any_of(std::begin(kFunctions), std::end(kFunctions), has_name) ||
           std::any_of(std::begin(kVectorFunctions), std::end(kVectorFunctions), has_name);
}

std::vector<std::string> glsl_functions() {
    std::vector<std::string> names;
    for (const Function& f : kFunctions)
        names.emplace_back(f.name);
    for (const VectorFunction& f : kVectorFunctions)
        names.emplace_back(f.name);
    return names;
}

std::string why_no_glsl_function(std::string_view name) {
    constexpr std::string_view kTextures[] = {"tex", "sample", "Sample", "Load", "imageLoad"};
    for (const std::string_view texture : kTextures) {
        if (name.substr(0, texture.size()) == texture)
            return "expected no texture: a color comes from the color before it alone";
    }
    constexpr std::string_view kDerivatives[] = {"dFdx", "dFdy", "fwidth", "ddx", "ddy"};
    if (std::find(std::begin(kDerivatives), std::end(kDerivatives), name) != std::end(kDerivatives))
        return "expected no derivative: a color comes from the color before it alone";
    constexpr std::string_view kTests[] = {"isnan", "isinf", "isfinite"};
    if (std::find(std::begin(kTests), std::end(kTests), name) != std::end(kTests))
        return "expected none: colors are finite when they come in";
    return "";
}

GlslValue glsl_call(std::string_view name, const std::vector<GlslValue>& in) {
    const std::string what = "function " + std::string(name);
    std::size_t wanted = 0;
    for (const Function& f : kFunctions) {
        if (f.name != name) continue;
        if (f.operands == in.size()) return call_each(f, what, in);
        wanted = f.operands;
    }
    for (const VectorFunction& f : kVectorFunctions) {
        if (f.name != name) continue;
        if (f.operands == in.size()) return f.make(what, in);
        wanted = f.operands;
    }
    misuse(what + " has " + std::to_string(in.size()) +
           (in.size() == 1 ? " operand" : " operands") + "; expected " + std::to_string(wanted));
}

TONEWRIGHT_NAMESPACE_END
