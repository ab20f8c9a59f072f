// SPDX-License-Identifier: Apache-2.0
//
// The variables of the functions that are called inside each other, and what branches make of them.
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
#include "formula/glsl_value.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

struct Function;

struct Variable {
    std::string_view name;
    GlslValue value;
    unsigned set = ~0U;  // components that have a value
    bool is_const = false;
};

struct Returned {
    Expr when;
    GlslValue value;
};

/// One call of a function.
struct Frame {
    const Function* function = nullptr;
    std::vector<std::map<std::string_view, std::size_t>> scopes = {{}};
    std::vector<Returned> returned = {};
    bool is_done = false;
};

/// One side of an if.
struct Branch {
    std::map<std::size_t, Variable> changed;
    std::optional<Returned> returned;
    bool is_done = false;
};

class Frames {
  public:
    /// Runs `body`, a call of the function.
    template <class Body>
    Frame call(const Function& function, const Body& body) {
        const std::size_t variables = variables_.size();
        Frame frame{&function};
        frames_.push_back(&frame);
        body(frame);
        frames_.pop_back();
        variables_.resize(variables);
        return frame;
    }
    /// Runs `body`, one side of an if, and undoes its assignments.
    template <class Body>
    Branch branch(const Body& body) {
        Branch result;
        Frame& frame = top();
        const bool was_done = std::exchange(frame.is_done, false);
        std::vector<Returned> returned = std::exchange(frame.returned, {});
        Changes changes{variables_.size(), {}};
        changes_.push_back(&changes);
        scope(body);
        changes_.pop_back();
        for (auto& [index, old] : changes.old)
            result.changed.emplace(index, std::exchange(variables_[index], old));
        frame.returned = std::move(returned);
        result.is_done = std::exchange(frame.is_done, was_done);
        return result;
    }
    template <class Body>
    void scope(const Body& body) {
        top().scopes.emplace_back();
        body();
        top().scopes.pop_back();
    }
    /// After an error that ends the calls.
    void clear();

    [[nodiscard]] std::size_t depth() const { return frames_.size(); }
    [[nodiscard]] bool has(const Function& function) const;
    [[nodiscard]] Frame& top() { return *frames_.back(); }

    void add_variable(Variable variable);
    void set_variable(std::size_t index, Variable variable);
    /// Remembers what the shader calls a value: the first name counts.
    void note(const Variable& variable);
    [[nodiscard]] const Variable& variable(std::size_t index) const { return variables_[index]; }
    [[nodiscard]] std::optional<std::size_t> find_variable(std::string_view name) const;
    /// The names that the running function may use.
    [[nodiscard]] std::vector<std::string> names() const;
    [[nodiscard]] std::vector<GlslName> take_noted() { return std::move(names_); }

  private:
    /// State inside one branch.
    struct Changes {
        std::size_t variables;  // as many were there before
        std::map<std::size_t, Variable> old;
    };

    std::vector<Frame*> frames_;
    std::vector<Variable> variables_;
    std::vector<Changes*> changes_;
    std::vector<GlslName> names_;
    std::set<const ExprNode*> noted_;
};

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
