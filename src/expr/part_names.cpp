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
    if (const std::string* name = of(before)) add(std::string(*name), after);
}

void PartNames::add(const std::string& name, const Expr& part) {
    if (innermost && part.operand_count() > 0 &&
        innermost->place_.emplace(part.node(), innermost->all_.size()).second)
        innermost->all_.push_back({part, name});
}

TONEWRIGHT_NAMESPACE_END
