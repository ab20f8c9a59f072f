// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

thread_local PartNames* innermost = nullptr;

}  // namespace

PartNames::PartNames() : outer_(innermost) { innermost = this; }

PartNames::~PartNames() { innermost = outer_; }

const std::string* PartNames::of(const Expr& part) {
    if (!innermost) return nullptr;
    const auto found = innermost->place_.find(part.node());
    return found == innermost->place_.end() ? nullptr : &innermost->all_[found->second].name;
}

void PartNames::move(const Expr& before, const Expr& after) {
    if (same(before, after)) return;
    if (const std::string* name = of(before); name && !of(after)) add(std::string(*name), after);
}

void PartNames::add(std::string_view name, const Expr& part) {
    const bool is_computed = part.operand_count() > 0 || part.is_constant();
    if (!innermost || !is_computed) return;
    const auto [known, is_new] = innermost->place_.emplace(part.node(), innermost->all_.size());
    if (is_new) {
        innermost->all_.push_back({part, std::string(name)});
    } else if (!part.is_constant()) {  // two names may have one number
        innermost->all_[known->second].name = name;
    }
}

TONEWRIGHT_NAMESPACE_END
