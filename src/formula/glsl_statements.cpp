// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/strings.h"
#include "formula/characters.h"
#include "formula/glsl_parser.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {
namespace {

constexpr std::size_t kMostCalls = 64;  // inside each other

}  // namespace

Value Parser::call(const Function& function, std::vector<Value> in, const Token& at) {
    const Level level(*this);
    if (function.refusal) fail(function.refusal->offset, function.refusal->message);
    const std::string name = printable(function.name.text);
    if (frames_.has(function))
        fail(at.begin, "function " + name + " calls itself; expected no recursion");
    if (frames_.depth() >= kMostCalls) {
        fail(at.begin, "more than " + std::to_string(kMostCalls) +
                           " calls are inside each other; expected at most as many");
    }
    const std::size_t outer = at_;
    for (std::size_t i = in.size(); i < function.arguments.size(); ++i)
        in.push_back(default_of(function.arguments[i]));
    const auto body = [&](Frame& frame) {
        for (std::size_t i = 0; i < function.arguments.size(); ++i) {
            const Argument& argument = function.arguments[i];
            Value value =
                made(at, in[i].depth, [&] { return glsl_convert(in[i], *argument.type); });
            if (argument.name.kind == Kind::name)
                frames_.add_variable({argument.name.text, std::move(value), ~0U, false});
        }
        at_ = function.body;
        frames_.scope([&] {  // a body may hide its arguments, as in C
            while (at_ < function.end)
                statement();
        });
        if (!frame.is_done) {
            fail(function.name.begin,
                 "function " + name + " may end without a value; expected return on every path");
        }
    };
    const Frame frame = frames_.call(function, body);
    at_ = outer;
    return folded(frame.returned, at).value;
}

Returned Parser::folded(const std::vector<Returned>& all, const Token& at) {
    Returned result = all.back();
    for (std::size_t i = all.size() - 1; i-- > 0;) {
        const Expr& when = all[i].when;
        result.value = chosen(at, when, all[i].value, result.value);
        result.when = select(when, 1, result.when);
    }
    return result;
}

Value Parser::chosen(const Token& at, const Expr& condition, const Value& yes, const Value& no) {
    const int depth = std::max(yes.depth, no.depth);
    return made(at, depth, [&] {
        return glsl_select({{Base::boolean}, {condition}, depth}, yes, no);
    });
}

void Parser::statement() {
    const Level level(*this);
    count(token(), 1, true);
    if (skip(";")) return;
    if (token().is("{")) return block();
    if (token().kind != Kind::name) expected("a statement");
    const std::string_view word = token().text;
    constexpr std::string_view kLoops[] = {"for", "while", "do"};
    if (is_one_of(word, kLoops)) expected("straight-line code, without loops");
    constexpr std::string_view kJumps[] = {"switch",  "case",     "default", "break",
                                           "discard", "continue", "goto"};
    if (is_one_of(word, kJumps)) expected("if, return, declarations or assignments");
    if (word == "if") return branch();
    if (word == "return") return leave();
    if (word == "struct") expected("no struct");
    const bool is_declaration =
        is_qualifier(word) || after().kind == Kind::name || (glsl_type(word) && after().is("["));
    if (is_declaration) return declaration();
    assignment();
}

void Parser::block() {
    next();
    frames_.scope([&] {
        while (!token().is("}"))
            statement();
    });
    next();
}

void Parser::leave() {
    const Token at = token();
    next();
    Frame& frame = frames_.top();
    if (token().is(";")) expected("a value behind return");
    const Value given = expression(kChoice);
    end_statement();
    Value value =
        made(at, given.depth, [&] { return glsl_convert(given, *frame.function->returns); });
    if (frame.is_done) return;
    frame.returned.push_back({1, std::move(value)});
    frame.is_done = true;
}

Branch Parser::run_branch(bool is_there, const Token& at) {
    if (!is_there) return {};
    std::optional<Returned> returned;
    Branch result = frames_.branch([&] {
        statement();
        const std::vector<Returned>& all = frames_.top().returned;
        if (!all.empty()) returned = folded(all, at);
    });
    result.returned = std::move(returned);
    return result;
}

void Parser::branch() {
    const Token at = token();
    next();
    require("(");
    const Value condition = expression(kChoice);
    require(")");
    if (condition.type.base != Base::boolean || !condition.type.is_scalar())
        fail(at.begin,
             "condition is " + glsl_name(condition.type) + "; expected bool, such as x < 1.0");
    const Expr& when = condition.e[0];
    const Branch yes = run_branch(true, at);
    const bool has_else = token().is_name("else");
    if (has_else) next();
    const Branch no = run_branch(has_else, at);
    std::set<std::size_t> changed;
    for (const Branch* side : {&yes, &no}) {
        for (const auto& [index, variable] : side->changed)
            changed.insert(index);
    }
    for (const std::size_t index : changed) {
        count(at, 1, true);
        const auto after_side = [&](const Branch& side) {
            const auto found = side.changed.find(index);
            return found == side.changed.end() ? frames_.variable(index) : found->second;
        };
        const Variable a = after_side(yes);
        const Variable b = after_side(no);
        Variable joined = yes.is_done ? b : a;
        if (!yes.is_done && !no.is_done) {
            Value with_depth = a.value;
            with_depth.depth = std::max(with_depth.depth, condition.depth);
            joined.value = chosen(at, when, with_depth, b.value);
            joined.set = a.set & b.set;
        }
        frames_.set_variable(index, std::move(joined));
    }
    join_returns(at, condition, yes, no);
}

void Parser::join_returns(const Token& at, const Value& condition, const Branch& yes,
                          const Branch& no) {
    Frame& frame = frames_.top();
    const Expr& when = condition.e[0];
    if (frame.is_done || (!yes.returned && !no.returned)) return;
    Returned joined = yes.returned ? *yes.returned : *no.returned;
    if (yes.returned && no.returned) {
        joined.when = select(when, yes.returned->when, no.returned->when);
        joined.value = chosen(at, when, yes.returned->value, no.returned->value);
    } else {
        joined.when = yes.returned ? select(when, truth(joined.when), 0)
                                   : select(when, 0, truth(joined.when));
        // `c` for `c ? 1 : 0`
        if (yes.returned && joined.when.op() == ExprOp::select && yes.is_done)
            joined.when = truth(when);
    }
    joined.value.depth = std::max(joined.value.depth, condition.depth + 2);
    if (!joined.when.is_constant(0)) frame.returned.push_back(joined);
    frame.is_done = joined.when.is_constant(1);
}

void Parser::end_statement() {
    if (skip(";")) return;
    if (token().is("%") || token().is("^") || token().is("|") || token().is("&") ||
        token().is("<<") || token().is(">>") || token().is("^^"))
        expected("+, -, *, / or a function such as pow(a, b)");
    if (token().is("=")) expected("== to compare");
    expected("an operator or ;");
}

void Parser::declaration() {
    bool is_const = false;
    while (token().kind == Kind::name && is_qualifier(token().text)) {
        is_const = is_const || token().is_name("const");
        next();
    }
    const std::optional<Type> type = glsl_type(token().text);
    if (!type) {
        fail(token().begin, "type is " + found() + "; expected " + std::string(kTypes));
    }
    next();
    do {
        const Token name = token();
        if (name.is("[")) expected("no array");
        if (name.kind != Kind::name) expected("a name");
        next();
        if (token().is("[")) expected("no array");
        Variable variable{name.text, {*type, {}, 1}, ~0U, is_const};
        if (skip("=")) {
            variable.value = initial(*type);
        } else {
            variable.value.e.assign(type->components(), Expr(0));
            variable.set = 0;
        }
        frames_.note(variable);
        frames_.add_variable(std::move(variable));
    } while (skip(","));
    end_statement();
}

Value Parser::initial(const Type& type) {
    const Token at = token();
    if (!at.is("{")) {
        const Value value = expression(kChoice);
        return made(at, value.depth, [&] { return glsl_convert(value, type); });
    }
    std::vector<Value> parts;
    read_list(parts);
    return constructed(at, type, parts);
}

void Parser::read_list(std::vector<Value>& parts) {
    const Level level(*this);
    require("{");
    while (!token().is("}")) {
        if (token().is("{")) {
            read_list(parts);
        } else {
            parts.push_back(expression(kChoice));
        }
        if (!skip(",") && !token().is("}")) expected(", or }");
    }
    next();
}

void Parser::assignment() {
    const Token name = token();
    next();
    if (token().is("(")) {
        fail(name.begin, "found a call whose value nothing takes; expected an assignment");
    }
    const std::optional<std::size_t> index = frames_.find_variable(name.text);
    if (!index) {
        if (globals_.contains(name.text))
            fail(name.begin, "name " + printable(name.text) +
                                 " is not of this function; expected a variable in it");
        unknown(name);
    }
    Variable variable = frames_.variable(*index);
    if (variable.is_const)
        fail(name.begin, "name " + printable(name.text) + " is const; expected a variable");
    // Indices of the components.
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < variable.value.e.size(); ++i)
        places.push_back(i);
    const Token part = token();
    while (token().is(".") || token().is("[")) {
        if (variable.value.type.is_matrix)
            fail(part.begin, "found part of a matrix; expected the whole of it to be set");
        std::vector<std::size_t> of;
        for (const std::size_t i : parts_of(places.size()))
            of.push_back(places[i]);
        places = of;
    }
    if (std::set<std::size_t>(places.begin(), places.end()).size() != places.size())
        fail(part.begin, "component is set twice; expected each once");
    Type type = variable.value.type;
    if (places.size() != variable.value.e.size() || places.size() == 1)
        type = {type.base, places.size()};
    const Token sign = token();
    constexpr std::string_view kSigns[] = {"=", "+=", "-=", "*=", "/="};
    if (sign.kind != Kind::sign || !is_one_of(sign.text, kSigns))
        expected(sign.is("++") || sign.is("--") ? "+= 1.0 or -= 1.0" : "=, +=, -=, *= or /=");
    next();
    Value value = expression(kChoice);
    if (sign.text.size() == 2) {
        Value old{type, {}, variable.value.depth};
        for (const std::size_t i : places) {
            require_set(variable, i, name);
            old.e.push_back(variable.value.e[i]);
        }
        value = binary(sign, sign.text.substr(0, 1), old, value);
    }
    end_statement();
    value = made(sign, value.depth, [&] { return glsl_convert(value, type); });
    for (std::size_t k = 0; k < places.size(); ++k) {
        variable.value.e[places[k]] = value.e[k];
        variable.set |= 1U << places[k];
    }
    variable.value.depth = places.size() == variable.value.e.size()
                               ? value.depth
                               : std::max(variable.value.depth, value.depth);
    frames_.set_variable(*index, std::move(variable));
}

void Parser::require_set(const Variable& variable, std::size_t i, const Token& at) const {
    if (variable.value.type.is_matrix ? variable.set != 0 : (variable.set >> i & 1U) != 0) return;
    fail(at.begin, "name " + printable(at.text) +
                       " is read before it has a value on every path; expected its value above");
}

}  // namespace glsl

TONEWRIGHT_NAMESPACE_END
