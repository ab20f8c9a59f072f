// SPDX-License-Identifier: Apache-2.0
//
// Straight-line GLSL and HLSL -> expressions. Functions are read where they are called: each call
// reads the body again, with the values of its arguments.
#include "formula/glsl.h"

#include <algorithm>

#include "base/strings.h"
#include "formula/characters.h"
#include "formula/glsl_parser.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

GlslFunction Parser::run() {
    while (token().kind != Kind::end)
        declare();
    const Function& function = choose(settings_.function);
    GlslFunction result;
    result.name = function.name.text;
    result.at = position_at(text_, function.name.begin);
    result.is_color = function.returns->size == 3;
    std::vector<Value> in = {{*function.returns, {}, 1}};
    for (std::size_t i = 0; i < function.returns->size; ++i)
        in[0].e.push_back(Expr::input(static_cast<int>(i)));
    for (std::size_t i = 1; i < function.arguments.size(); ++i)
        in.push_back(argument_of_user(function.arguments[i]));
    result.values = call(function, std::move(in), function.name).e;
    result.products = std::move(products_);
    result.names = frames_.take_noted();
    result.parameters = std::move(parameters_);
    for (const Function& other : functions_) {
        const std::string own(other.name.text);
        const bool is_known =
            own == result.name ||
            std::find(result.others.begin(), result.others.end(), own) != result.others.end();
        if (other.is_candidate() && !is_known) result.others.push_back(own);
    }
    return result;
}

void Parser::declare() {
    if (skip(";")) return;
    if (token().is_name("precision") || token().is_name("using")) return skip_to(";", ";");
    bool is_const = false;
    bool is_uniform = false;
    while (token().kind == Kind::name &&
           (is_qualifier(token().text) || token().is_name("layout") || token().is_name("out"))) {
        is_const = is_const || token().is_name("const");
        is_uniform = is_uniform || token().is_name("uniform");
        const bool is_layout = token().is_name("layout");
        next();
        if (is_layout && token().is("(")) skip_brackets();
    }
    if (token().is("[")) {  // an attribute
        skip_brackets();
        return;
    }
    if (token().kind != Kind::name) expected("a function, a constant or a uniform");
    const Token type = token();
    next();
    constexpr std::string_view kOpenBlocks[] = {"cbuffer", "tbuffer", "namespace"};
    if (type.text == "struct" || is_one_of(type.text, kOpenBlocks) || token().is("{")) {
        skip_to("{", ";");
        if (token().is("{")) skip_brackets();
        if (is_one_of(type.text, kOpenBlocks)) return;
        return skip_to(";", ";");
    }
    if (token().is("<")) skip_to(">", ";"), (void)skip(">");  // Texture2D<float4>
    if (token().is("[")) expected("no array");
    if (token().kind != Kind::name) expected("a function, a constant or a uniform");
    if (after().is("(")) return declare_function(type);
    declare_globals(type, is_const, is_uniform);
}

void Parser::declare_function(const Token& type) {
    Function function;
    function.name = token();
    function.returns = glsl_type(type.text);
    if (!function.returns) {
        function.refusal = Refusal{type.begin, "function " + printable(token().text) + " is " +
                                                   printable(type.text) + "; expected " + kTypes};
    }
    next();
    require("(");
    while (!token().is(")")) {
        if (token().kind == Kind::end) expected(")");
        read_argument(function);
        if (!skip(",") && !token().is(")")) expected(", or ) behind an argument");
    }
    next();
    if (skip(":")) next();  // what HLSL binds it to
    if (skip(";")) return;
    if (!token().is("{")) expected("{ or ;");
    function.body = at_ + 1;
    skip_brackets();
    function.end = at_ - 1;
    find_calls(function);
    functions_.push_back(std::move(function));
}

void Parser::read_argument(Function& function) {
    const auto refuse = [&](const std::string& message) {
        if (!function.refusal) function.refusal = Refusal{token().begin, message};
    };
    while (token().kind == Kind::name &&
           (is_qualifier(token().text) || token().is_name("out") || token().is_name("inout"))) {
        if (token().is_name("out") || token().is_name("inout")) {
            refuse("argument is " + std::string(token().text) +
                   "; expected arguments that only go in, and a value that is returned");
        }
        next();
    }
    if (token().kind != Kind::name) expected("the type of an argument");
    Argument argument;
    argument.type = glsl_type(token().text);
    const bool is_void = token().is_name("void");
    if (!argument.type && !is_void) {
        refuse("type is " + printable(token().text) + "; expected " + kTypes);
    }
    next();
    if (is_void) return;
    if (token().is("<")) skip_to(">", ")"), (void)skip(">");
    argument.name = token();
    if (token().kind == Kind::name) next();
    if (token().is("[")) {
        refuse("argument is an array; expected no arrays");
        skip_brackets();
    }
    if (skip(":")) next();
    if (token().is("=")) {
        next();
        argument.default_value = at_;
        skip_to(",", ")");
    }
    function.arguments.push_back(argument);
}

void Parser::declare_globals(const Token& type_at, bool is_const, bool is_uniform) {
    const std::optional<Type> type = glsl_type(type_at.text);
    do {
        const Token name = token();
        if (name.kind != Kind::name) expected("a name");
        next();
        Global global;
        global.at = name;
        const std::size_t begin = at_;
        try {
            if (!type)
                fail(type_at.begin, "type is " + printable(type_at.text) + "; expected " + kTypes);
            if (token().is("[")) expected("no array");
            if (is_uniform) {
                global.uniform = type;
                if (skip("=")) global.variable = Variable{name.text, initial(*type), ~0U, true};
            } else if (skip("=")) {
                global.variable = Variable{name.text, initial(*type), ~0U, is_const};
            } else {
                fail(name.begin, "name " + printable(name.text) +
                                     " has no value; expected a constant or a uniform");
            }
        } catch (const FormulaError& e) {
            global.refusal = Refusal{0, e.text()};
            refused_at_.insert_or_assign(name.text, e.at);
            at_ = begin;
            frames_.clear();
        }
        skip_to(",", ";");
        globals_.insert_or_assign(name.text, std::move(global));
    } while (skip(","));
    require(";");
}

void Parser::find_calls(Function& function) const {
    struct Open {
        std::string_view name;
        std::size_t operands;
    };
    std::vector<Open> open;
    for (std::size_t i = function.body; i < function.end; ++i) {
        const Token& at = tokens_[i];
        if (at.is("(")) {
            const bool is_call = tokens_[i - 1].kind == Kind::name;
            open.push_back({is_call ? tokens_[i - 1].text : "", tokens_[i + 1].is(")") ? 0U : 1U});
        } else if (at.is(",") && !open.empty()) {
            ++open.back().operands;
        } else if (at.is(")") && !open.empty()) {
            function.calls.emplace(open.back().name, open.back().operands);
            open.pop_back();
        }
    }
}

bool Parser::calls(const Function& caller, const Function& called) {
    return std::any_of(caller.calls.begin(), caller.calls.end(), [&](const auto& call) {
        return call.first == called.name.text && called.takes(call.second);
    });
}

const Function& Parser::choose(std::string_view name) {
    constexpr std::size_t kMostFunctions = 500;
    if (functions_.size() > kMostFunctions) {
        fail(functions_.back().name.begin, "shader has more than " +
                                               std::to_string(kMostFunctions) +
                                               " functions; expected at most as many");
    }
    std::vector<const Function*> candidates;
    std::vector<std::string> names;
    for (const Function& function : functions_) {
        names.emplace_back(printable(function.name.text));
        if (function.is_candidate()) candidates.push_back(&function);
    }
    if (name.empty()) {
        std::vector<const Function*> first;
        for (const Function* called : candidates) {
            const bool is_called =
                std::any_of(candidates.begin(), candidates.end(), [&](const Function* caller) {
                    return caller != called && calls(*caller, *called);
                });
            if (!is_called) first.push_back(called);
        }
        if (first.empty()) first = candidates;
        if (!first.empty()) name = first.back()->name.text;
        candidates = first;
    }
    const Function* chosen = nullptr;
    const Function* any = nullptr;
    for (const Function& function : functions_) {
        if (!name.empty() && function.name.text == name) any = &function;
    }
    // If two functions have this name, the one for colors.
    for (const Function* function : candidates) {
        if (function->name.text != name) continue;
        if (!chosen || function->returns->size >= chosen->returns->size) chosen = function;
    }
    if (chosen) return *chosen;
    const std::string wanted = "float " + (any ? printable(name) : "f") + "(float) or vec3 " +
                               (any ? printable(name) : "f") + "(vec3)";
    if (any && any->refusal) fail(any->refusal->offset, any->refusal->message);
    if (any) fail(any->name.begin, "function has other types; expected " + wanted);
    if (!name.empty() && !names.empty()) {
        throw Error({.parameter = "function",
                     .value = printable(name),
                     .expected = join_choices(names),
                     .suggestion = suggested_names(name, names)});
    }
    const Function* last = functions_.empty() ? nullptr : &functions_.back();
    if (last && last->refusal) fail(last->refusal->offset, last->refusal->message);
    fail(last ? last->name.begin : 0, "shader has no function of a color; expected " + wanted);
}

}  // namespace glsl

GlslFunction parse_glsl(std::string_view text, const GlslSettings& settings) {
    return glsl::Parser(text, settings).run();
}

TONEWRIGHT_NAMESPACE_END
