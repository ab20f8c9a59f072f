// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formula/glsl.h"
#include "formula/glsl_cursor.h"
#include "formula/glsl_frames.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

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

struct Global {
    std::optional<Variable> variable;
    std::optional<Refusal> refusal;
    /// Value of a uniform, which is a parameter.
    std::optional<Type> uniform;
    Token at;
};

/// Reads and evaluates a shader in one pass. Declarations are in glsl.cpp, statements in
/// glsl_statements.cpp, expressions in glsl_expressions.cpp.
class Parser : Cursor {
  public:
    Parser(std::string_view text, const GlslSettings& settings)
        : Cursor(text), settings_(settings) {}

    GlslFunction run();

  private:
    // Declarations of the file
    void declare();
    void declare_function(const Token& type);
    void read_argument(Function& function);
    void declare_globals(const Token& type_at, bool is_const, bool is_uniform);
    void find_calls(Function& function) const;
    static bool calls(const Function& caller, const Function& called);
    [[nodiscard]] const Function& choose(std::string_view name);

    // Calls, statements
    Value call(const Function& function, std::vector<Value> in, const Token& at);
    Returned folded(const std::vector<Returned>& all, const Token& at);
    Value chosen(const Token& at, const Expr& condition, const Value& yes, const Value& no);
    void statement();
    void block();
    void leave();
    /// One side of an if: its assignments, which are undone.
    Branch run_branch(bool is_there, const Token& at);
    void branch();
    void join_returns(const Token& at, const Value& condition, const Branch& yes, const Branch& no);
    void end_statement();
    void declaration();
    /// The value after the = of a declaration.
    Value initial(const Type& type);
    void read_list(std::vector<Value>& parts);
    void assignment();
    void require_set(const Variable& variable, std::size_t i, const Token& at) const;

    // Expressions
    /// A further argument of the function that is read, or a uniform: what the user sets.
    Value parameter(const Type& type, const Token& at, const std::optional<double>& otherwise,
                    const char* what);
    Value argument_of_user(const Argument& argument);
    Value default_of(const Argument& argument);
    [[nodiscard]] double constant(const Value& value, const Token& at) const;
    Value expression(Precedence weakest);
    Value binary(const Token& at, std::string_view sign, const Value& a, const Value& b);
    Value prefix();
    Value primary();
    Value number(const Token& at);
    Value constructed(const Token& at, const Type& type, const std::vector<Value>& parts);
    std::vector<Value> operands();
    [[noreturn]] void end_operands();
    Value call(const Token& at);
    static void limit_power(std::string_view name, std::vector<Value>& in);
    [[nodiscard]] const Function& overload(const Token& at, const std::vector<Value>& in) const;
    Value named(const Token& at);
    [[noreturn]] void unknown(const Token& at) const;
    /// Reads `.rgb` or `[1]`: the components of a vector of this size.
    std::vector<std::size_t> parts_of(std::size_t size);
    Value part(const Value& value);

    const GlslSettings& settings_;
    std::vector<Function> functions_;
    std::map<std::string_view, Global> globals_;
    std::map<std::string_view, TextPosition> refused_at_;
    Frames frames_;
    std::vector<GlslProduct> products_;
    std::vector<GlslParameter> parameters_;
};

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
