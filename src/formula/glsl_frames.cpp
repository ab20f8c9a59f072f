// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl_frames.h"

#include <algorithm>

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

void Frames::clear() {
    frames_.clear();
    changes_.clear();
    variables_.clear();
}

bool Frames::has(const Function& function) const {
    return std::any_of(frames_.begin(), frames_.end(),
                       [&](const Frame* frame) { return frame->function == &function; });
}

void Frames::add_variable(Variable variable) {
    std::map<std::string_view, std::size_t>& scope = frames_.back()->scopes.back();
    scope.insert_or_assign(variable.name, variables_.size());
    variables_.push_back(std::move(variable));
}

void Frames::set_variable(std::size_t index, Variable variable) {
    if (!changes_.empty() && index < changes_.back()->variables)
        changes_.back()->old.emplace(index, variables_[index]);
    variables_[index] = std::move(variable);
    note(variables_[index]);
}

void Frames::note(const Variable& variable) {
    for (std::size_t i = 0; i < variable.value.e.size(); ++i) {
        const Expr& e = variable.value.e[i];
        if (e.operand_count() == 0 || variable.value.type.is_matrix ||
            !noted_.insert(e.node()).second)
            continue;
        names_.push_back({e, std::string(variable.name), i, variable.value.e.size()});
    }
}

std::optional<std::size_t> Frames::find_variable(std::string_view name) const {
    if (frames_.empty()) return std::nullopt;
    const auto& scopes = frames_.back()->scopes;
    for (auto scope = scopes.rbegin(); scope != scopes.rend(); ++scope) {
        if (const auto found = scope->find(name); found != scope->end()) return found->second;
    }
    return std::nullopt;
}

std::vector<std::string> Frames::names() const {
    std::vector<std::string> result;
    if (frames_.empty()) return result;
    for (const auto& scope : frames_.back()->scopes) {
        for (const auto& [name, index] : scope)
            result.emplace_back(name);
    }
    return result;
}

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
