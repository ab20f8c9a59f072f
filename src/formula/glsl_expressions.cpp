// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/strings.h"
#include "formula/characters.h"
#include "formula/glsl_parser.h"
#include "formula/glsl_products.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {
namespace {

Precedence precedence_of(const Token& token) {
    return token.kind == Kind::sign ? tonewright::precedence_of(token.text) : kNone;
}

}  // namespace

Value Parser::parameter(const Type& type, const Token& at, const std::optional<double>& otherwise,
                        const char* what) {
    const std::string name(at.text);
    const auto set = settings_.parameters.find(name);
    if (set == settings_.parameters.end() && !otherwise) {
        fail(at.begin, std::string(what) + " " + printable(name) +
                           " has no value; expected one, as with <<parameter=" + printable(name) +
                           "=1>>");
    }
    const double value = set == settings_.parameters.end() ? *otherwise : set->second;
    if (!type.is_scalar())
        fail(at.begin, std::string(what) + " " + printable(name) + " is " + glsl_name(type) +
                           "; expected float");
    if (type.base != Base::number) return {type, {std::trunc(value)}, 1};  // it chooses
    const bool is_known =
        std::any_of(parameters_.begin(), parameters_.end(),
                    [&](const GlslParameter& known) { return known.name == name; });
    if (!is_known) parameters_.push_back({name, value, position_at(text_, at.begin)});
    return {type, {Expr::uniform(name)}, 1};
}

Value Parser::argument_of_user(const Argument& argument) {
    std::optional<double> otherwise;
    if (argument.default_value) otherwise = constant(default_of(argument), argument.name);
    return parameter(*argument.type, argument.name, otherwise, "argument");
}

Value Parser::default_of(const Argument& argument) {
    const std::size_t at = at_;
    at_ = argument.default_value;
    Value value = expression(kChoice);
    at_ = at;
    return value;
}

double Parser::constant(const Value& value, const Token& at) const {
    if (!value.type.is_scalar() || !value.e[0].is_constant())
        fail(at.begin, "value of " + printable(at.text) + " is no constant; expected a number");
    return value.e[0].value();
}

Value Parser::expression(Precedence weakest) {
    const Level level(*this);
    Value left = prefix();
    while (true) {
        const Token at = token();
        const Precedence strength = precedence_of(at);
        if (strength == kNone || strength < weakest) return left;
        next();
        if (strength == kChoice) {
            const Value yes = expression(kChoice);
            require(":");
            const Value no = expression(kChoice);
            left = made(at, std::max({left.depth, yes.depth, no.depth}),
                        [&] { return glsl_select(left, yes, no); });
        } else {
            const Value right = expression(static_cast<Precedence>(strength + 1));
            left = binary(at, at.text, left, right);
        }
    }
}

Value Parser::binary(const Token& at, std::string_view sign, const Value& a, const Value& b) {
    Value value = made(at, std::max(a.depth, b.depth), [&] { return glsl_binary(sign, a, b); });
    if (sign == "*") make_product(products_, value, a, b);
    return value;
}

Value Parser::prefix() {
    const Token at = token();
    if (at.is("-") || at.is("+") || at.is("!")) {
        next();
        Value a = expression(kSign);
        if (at.is("+")) return a;
        return made(at, a.depth, [&] { return at.is("-") ? glsl_negative(a) : glsl_not(a); });
    }
    Value value = primary();
    while (token().is(".") || token().is("["))
        value = part(value);
    return value;
}

Value Parser::primary() {
    const Token at = token();
    if (at.kind == Kind::number) {
        next();
        return number(at);
    }
    if (at.is("(")) {
        next();
        const std::optional<Type> cast =
            token().kind == Kind::name && after().is(")") ? glsl_type(token().text) : std::nullopt;
        if (cast) {  // (float3)0.5, of HLSL
            next();
            next();
            return constructed(at, *cast, {expression(kSign)});
        }
        Value inner = expression(kChoice);
        require(")");
        return inner;
    }
    if (at.kind != Kind::name) expected("an expression");
    next();
    if (at.text == "true" || at.text == "false")
        return {{Base::boolean}, {at.text == "true" ? 1.0 : 0.0}, 1};
    if (token().is("(")) return call(at);
    return named(at);
}

Value Parser::number(const Token& at) {
    std::string_view digits = at.text;
    if (const char last = digits.back(); last == 'h' || last == 'H' || last == 'u' || last == 'U')
        digits.remove_suffix(1);
    if (digits.size() > 2 &&
        (digits.substr(digits.size() - 2) == "lf" || digits.substr(digits.size() - 2) == "LF"))
        digits.remove_suffix(2);
    const NumberText value = number_of(digits);
    if (value.expected)
        fail(at.begin, "number is " + printable(at.text) + "; expected " + value.expected);
    const bool is_integer = at.text.find_first_not_of("0123456789uU") == std::string_view::npos;
    return {{is_integer ? Base::integer : Base::number}, {value.value}, 1};
}

Value Parser::constructed(const Token& at, const Type& type, const std::vector<Value>& parts) {
    int depth = 1;
    for (const Value& value : parts)
        depth = std::max(depth, value.depth);
    return made(at, depth, [&] { return glsl_construct(type, parts); });
}

std::vector<Value> Parser::operands() {
    require("(");
    std::vector<Value> in;
    if (skip(")")) return in;
    do {
        in.push_back(expression(kChoice));
        count(token(), 1, true);
    } while (skip(","));
    if (!token().is(")")) end_operands();
    next();
    return in;
}

void Parser::end_operands() {
    if (token().is(";") || token().kind == Kind::end) expected(")");
    end_statement();
    expected(")");
}

Value Parser::call(const Token& at) {
    if (const std::optional<Type> type = glsl_type(at.text)) {
        const std::vector<Value> parts = operands();
        return constructed(at, *type, parts);
    }
    const bool is_own = std::any_of(functions_.begin(), functions_.end(),
                                    [&](const Function& f) { return f.name.text == at.text; });
    const std::string name = printable(at.text);
    if (!is_own && !is_glsl_function(at.text)) {
        if (const std::string why = why_no_glsl_function(at.text); !why.empty())
            fail(at.begin, "function is " + name + "; " + why);
        std::vector<std::string> known = glsl_functions();
        for (const Function& f : functions_)
            known.emplace_back(f.name.text);
        fail(at.begin, "function is " + name +
                           "; expected one of the shader, or one of GLSL or HLSL for numbers "
                           "and vectors" +
                           did_you_mean(at.text, known));
    }
    std::vector<Value> in = operands();
    if (is_own) return call(overload(at, in), in, at);
    int depth = 1;
    for (const Value& value : in)
        depth = std::max(depth, value.depth);
    if (settings_.limits_powers) limit_power(at.text, in);
    Value value = made(at, depth, [&] { return glsl_call(at.text, in); });
    if (at.text == "mul") make_product(products_, value, in[0], in[1]);
    return value;
}

void Parser::limit_power(std::string_view name, std::vector<Value>& in) {
    // x*x has a value for every x, and so has what compilers make of pow(x, 2.0).
    const auto is_whole = [](const Expr& e) {
        return e.is_constant() && e.value() == std::floor(e.value());
    };
    const bool is_power =
        name == "pow" && in.size() == 2 && !std::all_of(in[1].e.begin(), in[1].e.end(), is_whole);
    if (in.empty() || (!is_power && name != "sqrt")) return;
    for (Expr& e : in[0].e)
        e = max(e, 0);
    ++in[0].depth;
}

const Function& Parser::overload(const Token& at, const std::vector<Value>& in) const {
    const Function* best = nullptr;
    const Function* any = &functions_.front();  // the caller has found one of that name
    std::size_t best_score = 0;
    for (const Function& function : functions_) {
        if (function.name.text != at.text) continue;
        any = &function;
        if (!function.takes(in.size())) continue;
        std::size_t score = 1;  // and one more for each exact type
        for (std::size_t i = 0; i < in.size() && score; ++i) {
            const std::optional<Type>& type = function.arguments[i].type;
            if (!type) continue;
            if (*type == in[i].type) {
                score += in.size();
            } else if (glsl_converts(in[i].type, *type)) {
                score += type->size == in[i].type.size ? 1 : 0;
            } else {
                score = 0;
            }
        }
        if (score > best_score) best = &function, best_score = score;
    }
    if (best) return *best;
    std::string types;
    for (const Value& value : in)
        types += (types.empty() ? "" : ", ") + glsl_name(value.type);
    std::string wanted;
    for (const Argument& argument : any->arguments) {
        wanted += (wanted.empty() ? "" : ", ") +
                  (argument.type ? glsl_name(*argument.type) : "another type");
    }
    fail(at.begin,
         "function " + printable(at.text) + " has (" + types + "); expected (" + wanted + ")");
}

Value Parser::named(const Token& at) {
    if (const std::optional<std::size_t> index = frames_.find_variable(at.text)) {
        const Variable& variable = frames_.variable(*index);
        // A swizzle may read the components that are there.
        if (variable.set != ~0U) {
            std::vector<std::size_t> places;
            for (std::size_t i = 0; i < variable.value.e.size(); ++i)
                places.push_back(i);
            const std::size_t begin = at_;
            while (!variable.value.type.is_matrix && (token().is(".") || token().is("["))) {
                std::vector<std::size_t> of;
                for (const std::size_t i : parts_of(places.size()))
                    of.push_back(places[i]);
                places = of;
            }
            at_ = begin;
            for (const std::size_t i : places)
                require_set(variable, i, at);
        }
        return variable.value;
    }
    const auto found = globals_.find(at.text);
    if (found == globals_.end()) unknown(at);
    const Global& global = found->second;
    if (global.refusal) throw FormulaError(refused_at_.at(at.text), global.refusal->message);
    if (!global.uniform) return global.variable->value;
    std::optional<double> otherwise;
    if (global.variable) otherwise = constant(global.variable->value, global.at);
    return parameter(*global.uniform, global.at, otherwise, "uniform");
}

void Parser::unknown(const Token& at) const {
    std::vector<std::string> known = frames_.names();
    for (const auto& [name, global] : globals_)
        known.emplace_back(name);
    // One letter is as near to any other.
    const std::string hint = at.text.size() < 3 ? "" : did_you_mean(at.text, known);
    fail(at.begin, "name is " + printable(at.text) +
                       "; expected a variable, an argument or a constant of the shader" + hint);
}

std::vector<std::size_t> Parser::parts_of(std::size_t size) {
    const Token at = token();
    next();
    if (at.is("[")) {
        const Token index = token();
        const Value value = expression(kChoice);
        require("]");
        const bool is_index = value.type.is_scalar() && value.e[0].is_constant() &&
                              value.e[0].value() >= 0 &&
                              value.e[0].value() < static_cast<double>(size);
        if (!is_index)
            fail(index.begin,
                 "index is no constant below " + std::to_string(size) + "; expected one");
        return {static_cast<std::size_t>(value.e[0].value())};
    }
    const Token name = token();
    if (name.kind != Kind::name) expected("components, such as .rgb");
    next();
    for (const std::string_view letters : {"xyzw", "rgba", "stpq"}) {
        std::vector<std::size_t> places;
        for (const char c : name.text) {
            const std::size_t place = letters.find(c);
            if (place < size) places.push_back(place);
        }
        if (places.size() == name.text.size() && places.size() <= 4) return places;
    }
    fail(name.begin, "components are " + printable(name.text) + "; expected " +
                         (size == 1   ? "x or r, of a number"
                          : size == 2 ? "x and y, or r and g"
                          : size == 3 ? "x, y and z, or r, g and b"
                                      : "x, y, z and w, or r, g, b and a"));
}

Value Parser::part(const Value& value) {
    const Token at = token();
    count(at, 1, true);
    const Type& type = value.type;
    if (type.is_matrix) {
        if (at.is(".")) fail(at.begin, "found part of a matrix; expected m[0] or m[0][1]");
        const std::size_t i = parts_of(type.size)[0];
        Value vector{{type.base, type.size}, {}, value.depth};
        for (std::size_t k = 0; k < type.size; ++k)
            vector.e.push_back(value.e[type.is_hlsl ? i * type.size + k : k * type.size + i]);
        return vector;
    }
    Value result{type, {}, value.depth};
    for (const std::size_t i : parts_of(type.size))
        result.e.push_back(value.e[i]);
    result.type.size = result.e.size();
    return result;
}

}  // namespace glsl

TONEWRIGHT_NAMESPACE_END
