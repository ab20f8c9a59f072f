// SPDX-License-Identifier: Apache-2.0
//
// Straight-line GLSL and HLSL -> expressions. Functions are read where they are called: each call
// reads the body again, with the values of its arguments.
#include "formula/glsl.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/strings.h"
#include "formula/characters.h"
#include "formula/glsl_tokens.h"
#include "formula/glsl_value.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Token = GlslToken;
using Kind = Token::Kind;
using Type = GlslType;
using Base = Type::Base;
using Value = GlslValue;

constexpr const char* kTypes = "float, vec2, vec3, vec4, mat3, int, bool or HLSL's names of them";
constexpr std::size_t kMostCalls = 64;  // inside each other
/// For numbers and colors, because folding into a number takes time, too.
constexpr int kMostSteps = 20 * kMostOperations;

Precedence precedence_of(const Token& token) {
    return token.kind == Kind::sign ? tonewright::precedence_of(token.text) : kNone;
}

template <std::size_t n>
bool is_one_of(std::string_view text, const std::string_view (&all)[n]) {
    return std::find(std::begin(all), std::end(all), text) != std::end(all);
}

bool is_qualifier(std::string_view name) {
    constexpr std::string_view kQualifiers[] = {"const",   "static",    "in",        "inline",
                                                "uniform", "highp",     "mediump",   "lowp",
                                                "precise", "flat",      "extern",    "volatile",
                                                "varying", "invariant", "attribute", "constexpr"};
    return is_one_of(name, kQualifiers);
}

/// A mistake that counts only where something uses the name.
struct Refusal {
    std::size_t offset = 0;
    std::string message;
};

struct Argument {
    std::optional<Type> type;
    Token name;
    std::size_t default_value = 0;  // its token; 0: none
};

struct Function {
    Token name;
    std::optional<Type> returns;
    std::vector<Argument> arguments;
    std::size_t body = 0;  // the tokens between its brackets
    std::size_t end = 0;
    std::optional<Refusal> refusal;
    std::set<std::pair<std::string_view, std::size_t>> calls;  // names and numbers of operands

    [[nodiscard]] std::size_t needed() const {
        return static_cast<std::size_t>(
            std::count_if(arguments.begin(), arguments.end(),
                          [](const Argument& a) { return a.default_value == 0; }));
    }
    [[nodiscard]] bool takes(std::size_t count) const {
        return needed() <= count && count <= arguments.size();
    }
    /// `float f(float)` or `vec3 f(vec3)`, with further numbers.
    [[nodiscard]] bool is_candidate() const {
        if (refusal || !returns || arguments.empty() || arguments[0].type != returns) return false;
        const bool is_rest_scalar =
            std::all_of(arguments.begin() + 1, arguments.end(),
                        [](const Argument& a) { return a.type && a.type->is_scalar(); });
        return is_rest_scalar && returns->base == Base::number && !returns->is_matrix &&
               (returns->size == 1 || returns->size == 3);
    }
};

struct Variable {
    std::string_view name;
    Value value;
    unsigned set = ~0U;  // components that have a value
    bool is_const = false;
};

struct Global {
    std::optional<Variable> variable;
    std::optional<Refusal> refusal;
    /// Value of a uniform, which is a parameter.
    std::optional<Type> uniform;
    Token at;
};

/// State inside one branch.
struct Changes {
    std::size_t variables;  // as many were there before
    std::map<std::size_t, Variable> old;
};

struct Returned {
    Expr when;
    Value value;
};

struct Frame {
    const Function* function;
    std::vector<std::map<std::string_view, std::size_t>> scopes;
    std::vector<Returned> returned;
    bool is_done = false;
};

class Parser {
  public:
    Parser(std::string_view text, const GlslSettings& settings) : text_(text), settings_(settings) {
        if (text.size() > kLongestShader) {
            fail(0, "shader has " + std::to_string(text.size()) + " bytes; expected at most " +
                        std::to_string(kLongestShader));
        }
        tokens_ = glsl_tokens(text);
    }

    GlslFunction run() {
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
        result.names = std::move(names_);
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

  private:
    [[noreturn]] void fail(std::size_t offset, const std::string& message) const {
        throw FormulaError(position_at(text_, offset), message);
    }
    [[noreturn]] void expected(const std::string& what) const {
        fail(token().begin, "found " + found() + "; expected " + what);
    }
    [[nodiscard]] std::string found() const {
        return token().kind == Kind::end ? "the end" : printable(token().text);
    }
    [[nodiscard]] const Token& token() const { return tokens_[at_]; }
    [[nodiscard]] const Token& after(std::size_t n = 1) const {
        return tokens_[std::min(at_ + n, tokens_.size() - 1)];
    }
    void next() {
        if (token().kind != Kind::end) ++at_;
    }
    bool skip(std::string_view sign) {
        if (!token().is(sign)) return false;
        next();
        return true;
    }
    void require(std::string_view sign) {
        if (!skip(sign)) expected(std::string(sign));
    }

    /// Calls glsl_...() functions, whose errors get the place.
    template <class Make>
    Value made(const Token& at, int depth, const Make& make) {
        try {
            Value value = make();
            const int operations =
                std::max(1, value.depth - depth) * static_cast<int>(value.e.size());
            count(at, operations, std::all_of(value.e.begin(), value.e.end(), [](const Expr& e) {
                      return e.is_constant();
                  }));
            if (value.depth > kDeepestFormula) {
                fail(at.begin, "more than " + std::to_string(kDeepestFormula) +
                                   " operations depend on each other; expected at most as many");
            }
            for (const Expr& e : value.e) {
                if (!e.is_constant() || std::isfinite(e.value())) continue;
                fail(at.begin, std::string("result is ") +
                                   (std::isnan(e.value()) ? "not a number" : "infinite") +
                                   " for every input; expected a finite number");
            }
            return value;
        } catch (const GlslMisuse& e) {
            fail(at.begin, e.text());
        }
    }
    void count(const Token& at, int operations, bool is_constant) {
        steps_ += operations;
        if (!is_constant) operations_ += operations;
        if (operations_ > kMostOperations || steps_ > kMostSteps) {
            fail(at.begin,
                 "function has more than " +
                     std::to_string(operations_ > kMostOperations ? kMostOperations : kMostSteps) +
                     " operations; expected at most as many");
        }
    }

    /// Counts what is inside each other.
    struct Level {
        explicit Level(Parser& parser) : depth(parser.nesting_) {
            if (++depth > kDeepestBrackets) {
                --depth;
                parser.fail(parser.token().begin,
                            "more than " + std::to_string(kDeepestBrackets) +
                                " brackets, signs, blocks or calls are inside each other; "
                                "expected variables");
            }
        }
        ~Level() { --depth; }
        Level(const Level&) = delete;
        Level& operator=(const Level&) = delete;
        int& depth;
    };

    // -- Declarations of the file

    /// Behind the bracket that closes the one here. Others count where something reads what is
    /// between.
    void skip_brackets() {
        const Token open = token();
        const std::string_view close = open.is("(") ? ")" : open.is("{") ? "}" : "]";
        std::size_t depth = 0;
        do {
            if (token().kind == Kind::end)
                fail(open.begin, "found " + std::string(open.text) +
                                     " that nothing closes; expected " + std::string(close));
            if (token().is(open.text)) ++depth;
            if (token().is(close)) --depth;
            next();
        } while (depth > 0);
    }
    void skip_to(std::string_view sign, std::string_view other) {
        while (!token().is(sign) && !token().is(other)) {
            if (token().kind == Kind::end) expected(std::string(sign));
            if (token().is("(") || token().is("{") || token().is("[")) {
                skip_brackets();
            } else {
                next();
            }
        }
    }

    void declare() {
        if (skip(";")) return;
        if (token().is_name("precision") || token().is_name("using")) return skip_to(";", ";");
        bool is_const = false;
        bool is_uniform = false;
        while (
            token().kind == Kind::name &&
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

    void declare_function(const Token& type) {
        Function function;
        function.name = token();
        function.returns = glsl_type(type.text);
        if (!function.returns) {
            function.refusal =
                Refusal{type.begin, "function " + printable(token().text) + " is " +
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

    void read_argument(Function& function) {
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

    void declare_globals(const Token& type_at, bool is_const, bool is_uniform) {
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
                    fail(type_at.begin,
                         "type is " + printable(type_at.text) + "; expected " + kTypes);
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
                changes_.clear();
                variables_.clear();
            }
            skip_to(",", ";");
            globals_.insert_or_assign(name.text, std::move(global));
        } while (skip(","));
        require(";");
    }

    // -- Which function

    void find_calls(Function& function) const {
        struct Open {
            std::string_view name;
            std::size_t operands;
        };
        std::vector<Open> open;
        for (std::size_t i = function.body; i < function.end; ++i) {
            const Token& at = tokens_[i];
            if (at.is("(")) {
                const bool is_call = tokens_[i - 1].kind == Kind::name;
                open.push_back(
                    {is_call ? tokens_[i - 1].text : "", tokens_[i + 1].is(")") ? 0U : 1U});
            } else if (at.is(",") && !open.empty()) {
                ++open.back().operands;
            } else if (at.is(")") && !open.empty()) {
                function.calls.emplace(open.back().name, open.back().operands);
                open.pop_back();
            }
        }
    }

    static bool calls(const Function& caller, const Function& called) {
        return std::any_of(caller.calls.begin(), caller.calls.end(), [&](const auto& call) {
            return call.first == called.name.text && called.takes(call.second);
        });
    }

    [[nodiscard]] const Function& choose(std::string_view name) {
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

    /// A further argument of the function that is read, or a uniform: what the user sets.
    Value parameter(const Type& type, const Token& at, const std::optional<double>& otherwise,
                    const char* what) {
        const std::string name(at.text);
        const auto set = settings_.parameters.find(name);
        if (set == settings_.parameters.end() && !otherwise) {
            fail(at.begin, std::string(what) + " " + printable(name) +
                               " has no value; expected one, as with <<parameter=" +
                               printable(name) + "=1>>");
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

    Value argument_of_user(const Argument& argument) {
        std::optional<double> otherwise;
        if (argument.default_value) otherwise = constant(default_of(argument), argument.name);
        return parameter(*argument.type, argument.name, otherwise, "argument");
    }

    Value default_of(const Argument& argument) {
        const std::size_t at = at_;
        at_ = argument.default_value;
        Value value = expression(kChoice);
        at_ = at;
        return value;
    }

    [[nodiscard]] double constant(const Value& value, const Token& at) const {
        if (!value.type.is_scalar() || !value.e[0].is_constant())
            fail(at.begin, "value of " + printable(at.text) + " is no constant; expected a number");
        return value.e[0].value();
    }

    // -- Functions

    Value call(const Function& function, std::vector<Value> in, const Token& at) {
        const Level level(*this);
        if (function.refusal) fail(function.refusal->offset, function.refusal->message);
        const std::string name = printable(function.name.text);
        for (const Frame* frame : frames_) {
            if (frame->function == &function)
                fail(at.begin, "function " + name + " calls itself; expected no recursion");
        }
        if (frames_.size() >= kMostCalls) {
            fail(at.begin, "more than " + std::to_string(kMostCalls) +
                               " calls are inside each other; expected at most as many");
        }
        const std::size_t outer = at_;
        const std::size_t variables = variables_.size();
        for (std::size_t i = in.size(); i < function.arguments.size(); ++i)
            in.push_back(default_of(function.arguments[i]));
        Frame frame{&function, {{}}, {}, false};
        frames_.push_back(&frame);
        for (std::size_t i = 0; i < function.arguments.size(); ++i) {
            const Argument& argument = function.arguments[i];
            Value value =
                made(at, in[i].depth, [&] { return glsl_convert(in[i], *argument.type); });
            if (argument.name.kind == Kind::name)
                add_variable({argument.name.text, std::move(value), ~0U, false});
        }
        at_ = function.body;
        frame.scopes.emplace_back();  // a body may hide its arguments, as in C
        while (at_ < function.end)
            statement();
        if (!frame.is_done) {
            fail(function.name.begin,
                 "function " + name + " may end without a value; expected return on every path");
        }
        frames_.pop_back();
        variables_.resize(variables);
        at_ = outer;
        return folded(frame.returned, at).value;
    }

    Returned folded(const std::vector<Returned>& all, const Token& at) {
        Returned result = all.back();
        for (std::size_t i = all.size() - 1; i-- > 0;) {
            const Expr& when = all[i].when;
            result.value = chosen(at, when, all[i].value, result.value);
            result.when = select(when, 1, result.when);
        }
        return result;
    }

    Value chosen(const Token& at, const Expr& condition, const Value& yes, const Value& no) {
        const int depth = std::max(yes.depth, no.depth);
        return made(at, depth, [&] {
            return glsl_select({{Base::boolean}, {condition}, depth}, yes, no);
        });
    }

    // -- Variables

    void add_variable(Variable variable) {
        std::map<std::string_view, std::size_t>& scope = frames_.back()->scopes.back();
        scope.insert_or_assign(variable.name, variables_.size());
        variables_.push_back(std::move(variable));
    }

    void set_variable(std::size_t index, Variable variable) {
        if (!changes_.empty() && index < changes_.back()->variables)
            changes_.back()->old.emplace(index, variables_[index]);
        variables_[index] = std::move(variable);
        note(variables_[index]);
    }

    /// Remembers what the shader calls a value: the first name counts.
    void note(const Variable& variable) {
        for (std::size_t i = 0; i < variable.value.e.size(); ++i) {
            const Expr& e = variable.value.e[i];
            if (e.operand_count() == 0 || variable.value.type.is_matrix ||
                !noted_.insert(e.node()).second)
                continue;
            names_.push_back({e, std::string(variable.name), i, variable.value.e.size()});
        }
    }

    [[nodiscard]] std::optional<std::size_t> find_variable(std::string_view name) const {
        if (frames_.empty()) return std::nullopt;
        const auto& scopes = frames_.back()->scopes;
        for (auto scope = scopes.rbegin(); scope != scopes.rend(); ++scope) {
            if (const auto found = scope->find(name); found != scope->end()) return found->second;
        }
        return std::nullopt;
    }

    // -- Statements

    void statement() {
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
        const bool is_declaration = is_qualifier(word) || after().kind == Kind::name ||
                                    (glsl_type(word) && after().is("["));
        if (is_declaration) return declaration();
        assignment();
    }

    void block() {
        next();
        frames_.back()->scopes.emplace_back();
        while (!token().is("}"))
            statement();
        frames_.back()->scopes.pop_back();
        next();
    }

    void leave() {
        const Token at = token();
        next();
        Frame& frame = *frames_.back();
        if (token().is(";")) expected("a value behind return");
        const Value given = expression(kChoice);
        end_statement();
        Value value =
            made(at, given.depth, [&] { return glsl_convert(given, *frame.function->returns); });
        if (frame.is_done) return;
        frame.returned.push_back({1, std::move(value)});
        frame.is_done = true;
    }

    struct Branch {
        std::map<std::size_t, Variable> changed;
        std::optional<Returned> returned;
        bool is_done = false;
    };

    /// One side of an if: its assignments, which are undone.
    Branch run_branch(bool is_there, const Token& at) {
        Branch result;
        if (!is_there) return result;
        Frame& frame = *frames_.back();
        const bool was_done = std::exchange(frame.is_done, false);
        std::vector<Returned> returned = std::exchange(frame.returned, {});
        Changes changes{variables_.size(), {}};
        changes_.push_back(&changes);
        frame.scopes.emplace_back();
        statement();
        frame.scopes.pop_back();
        changes_.pop_back();
        for (auto& [index, old] : changes.old)
            result.changed.emplace(index, std::exchange(variables_[index], old));
        if (!frame.returned.empty()) result.returned = folded(frame.returned, at);
        result.is_done = std::exchange(frame.is_done, was_done);
        frame.returned = std::move(returned);
        return result;
    }

    void branch() {
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
                return found == side.changed.end() ? variables_[index] : found->second;
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
            set_variable(index, std::move(joined));
        }
        join_returns(at, condition, yes, no);
    }

    void join_returns(const Token& at, const Value& condition, const Branch& yes,
                      const Branch& no) {
        Frame& frame = *frames_.back();
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

    void end_statement() {
        if (skip(";")) return;
        if (token().is("%") || token().is("^") || token().is("|") || token().is("&") ||
            token().is("<<") || token().is(">>") || token().is("^^"))
            expected("+, -, *, / or a function such as pow(a, b)");
        if (token().is("=")) expected("== to compare");
        expected("an operator or ;");
    }

    void declaration() {
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
            note(variable);
            add_variable(std::move(variable));
        } while (skip(","));
        end_statement();
    }

    /// The value after the = of a declaration.
    Value initial(const Type& type) {
        const Token at = token();
        if (!at.is("{")) {
            const Value value = expression(kChoice);
            return made(at, value.depth, [&] { return glsl_convert(value, type); });
        }
        std::vector<Value> parts;
        read_list(parts);
        return constructed(at, type, parts);
    }

    void read_list(std::vector<Value>& parts) {
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

    void assignment() {
        const Token name = token();
        next();
        if (token().is("(")) {
            fail(name.begin, "found a call whose value nothing takes; expected an assignment");
        }
        const std::optional<std::size_t> index = find_variable(name.text);
        if (!index) {
            if (globals_.contains(name.text))
                fail(name.begin, "name " + printable(name.text) +
                                     " is not of this function; expected a variable in it");
            unknown(name);
        }
        Variable variable = variables_[*index];
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
        set_variable(*index, std::move(variable));
    }

    void require_set(const Variable& variable, std::size_t i, const Token& at) const {
        if (variable.value.type.is_matrix ? variable.set != 0 : (variable.set >> i & 1U) != 0)
            return;
        fail(at.begin,
             "name " + printable(at.text) +
                 " is read before it has a value on every path; expected its value above");
    }

    // -- Expressions

    Value expression(Precedence weakest) {
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

    Value binary(const Token& at, std::string_view sign, const Value& a, const Value& b) {
        Value value = made(at, std::max(a.depth, b.depth), [&] { return glsl_binary(sign, a, b); });
        if (sign == "*") make_product(value, a, b);
        return value;
    }

    /// Where numbers multiply a color, what follows reads inputs of its own.
    void make_product(Value& value, const Value& a, const Value& b) {
        const bool is_row = b.type.is_matrix;
        const Value& matrix = is_row ? b : a;
        const Value& color = is_row ? a : b;
        const auto is_constant = [](const Expr& e) { return e.is_constant(); };
        const bool is_product = matrix.type.is_matrix && matrix.type.size == 3 &&
                                color.type.is_vector() &&
                                std::all_of(matrix.e.begin(), matrix.e.end(), is_constant) &&
                                !std::all_of(color.e.begin(), color.e.end(), is_constant);
        if (!is_product) return;
        GlslProduct product{{}, {color.e[0], color.e[1], color.e[2]}};
        for (std::size_t i = 0; i < 9; ++i)
            product.matrix.at(i / 3).at(i % 3) = matrix.e[is_row ? i % 3 * 3 + i / 3 : i].value();
        const auto is_same = [&](const GlslProduct& other) {
            return other.matrix == product.matrix && same(other.color[0], product.color[0]) &&
                   same(other.color[1], product.color[1]) && same(other.color[2], product.color[2]);
        };
        const auto known = std::find_if(products_.begin(), products_.end(), is_same);
        const auto k = 1 + static_cast<std::size_t>(known - products_.begin());
        if (known == products_.end()) products_.push_back(std::move(product));
        for (std::size_t i = 0; i < 3; ++i)
            value.e[i] = Expr::input(static_cast<int>(3 * k + i));
    }

    Value prefix() {
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

    Value primary() {
        const Token at = token();
        if (at.kind == Kind::number) {
            next();
            return number(at);
        }
        if (at.is("(")) {
            next();
            const std::optional<Type> cast = token().kind == Kind::name && after().is(")")
                                                 ? glsl_type(token().text)
                                                 : std::nullopt;
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

    Value number(const Token& at) {
        std::string_view digits = at.text;
        if (const char last = digits.back();
            last == 'h' || last == 'H' || last == 'u' || last == 'U')
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

    Value constructed(const Token& at, const Type& type, const std::vector<Value>& parts) {
        int depth = 1;
        for (const Value& value : parts)
            depth = std::max(depth, value.depth);
        return made(at, depth, [&] { return glsl_construct(type, parts); });
    }

    std::vector<Value> operands() {
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
    [[noreturn]] void end_operands() {
        if (token().is(";") || token().kind == Kind::end) expected(")");
        end_statement();
        expected(")");
    }

    Value call(const Token& at) {
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
        if (at.text == "mul") make_product(value, in[0], in[1]);
        return value;
    }

    static void limit_power(std::string_view name, std::vector<Value>& in) {
        // x*x has a value for every x, and so has what compilers make of pow(x, 2.0).
        const auto is_whole = [](const Expr& e) {
            return e.is_constant() && e.value() == std::floor(e.value());
        };
        const bool is_power = name == "pow" && in.size() == 2 &&
                              !std::all_of(in[1].e.begin(), in[1].e.end(), is_whole);
        if (in.empty() || (!is_power && name != "sqrt")) return;
        for (Expr& e : in[0].e)
            e = max(e, 0);
        ++in[0].depth;
    }

    [[nodiscard]] const Function& overload(const Token& at, const std::vector<Value>& in) const {
        const Function* best = nullptr;
        const Function* any = nullptr;
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
                    continue;
                }
                try {
                    (void)glsl_convert(in[i], *type);
                    score += type->size == in[i].type.size ? 1 : 0;
                } catch (const GlslMisuse&) {
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

    Value named(const Token& at) {
        if (const std::optional<std::size_t> index = find_variable(at.text)) {
            const Variable& variable = variables_[*index];
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

    [[noreturn]] void unknown(const Token& at) const {
        std::vector<std::string> known;
        if (!frames_.empty()) {
            for (const auto& scope : frames_.back()->scopes) {
                for (const auto& [name, index] : scope)
                    known.emplace_back(name);
            }
        }
        for (const auto& [name, global] : globals_)
            known.emplace_back(name);
        // One letter is as near to any other.
        const std::string hint = at.text.size() < 3 ? "" : did_you_mean(at.text, known);
        fail(at.begin, "name is " + printable(at.text) +
                           "; expected a variable, an argument or a constant of the shader" + hint);
    }

    // -- Parts of vectors

    /// Reads `.rgb` or `[1]`: the components of a vector of this size.
    std::vector<std::size_t> parts_of(std::size_t size) {
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

    Value part(const Value& value) {
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

    std::string_view text_;
    const GlslSettings& settings_;
    std::vector<Token> tokens_;
    std::size_t at_ = 0;
    std::vector<Function> functions_;
    std::map<std::string_view, Global> globals_;
    std::map<std::string_view, TextPosition> refused_at_;
    std::vector<Frame*> frames_;
    std::vector<Variable> variables_;
    std::vector<Changes*> changes_;
    std::vector<GlslProduct> products_;
    std::vector<GlslName> names_;
    std::set<const ExprNode*> noted_;
    std::vector<GlslParameter> parameters_;
    int nesting_ = 0;
    int operations_ = 0;
    int steps_ = 0;
};

}  // namespace

GlslFunction parse_glsl(std::string_view text, const GlslSettings& settings) {
    return Parser(text, settings).run();
}

TONEWRIGHT_NAMESPACE_END
