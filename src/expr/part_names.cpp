// SPDX-License-Identifier: Apache-2.0
#include "expr/part_name_list.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::shared_ptr<const PartNameList> joined(const std::shared_ptr<const PartNameList>& a,
                                           const std::shared_ptr<const PartNameList>& b) {
    // A sum of many terms names one list again and again.
    const auto holds = [](const PartNameList& all, const std::shared_ptr<const PartNameList>& one) {
        return all.first == one || all.second == one;
    };
    if (!b || a == b || (a && holds(*a, b))) return a;
    if (!a || holds(*b, a)) return b;
    return std::make_shared<const PartNameList>(PartNameList{a, b, {}});
}

Expr named(const char* name, const Expr& part) {
    if (part.operand_count() == 0 && !part.is_constant()) return part;
    const auto& before = part.names_;
    if (before && !before->entries.empty() && same(before->entries.back().part, part)) {
        // A list inside of each list would be as deep as a formula is long.
        if (part.is_constant()) return part;
        PartNameList renamed = *before;
        renamed.entries.back().name = name;
        return Expr(part.node_, std::make_shared<const PartNameList>(std::move(renamed)));
    }
    PartNames own;
    own.add(name, part);
    return Expr(part.node_, std::make_shared<const PartNameList>(
                                PartNameList{before, nullptr, std::move(own.all_)}));
}

PartNames::PartNames(Span<const Expr> exprs) {
    for (const Expr& e : exprs)
        take(e);
}

void PartNames::take(const Expr& expr) { take(expr.names_); }

void PartNames::take(const std::shared_ptr<const PartNameList>& names) {
    if (!names || !taken_.insert(names).second) return;
    take(names->first);
    take(names->second);
    for (const Entry& entry : names->entries)
        add(entry.name, entry.part);
}

void PartNames::add(std::string_view name, const Expr& part) {
    const bool is_computed = part.operand_count() > 0 || part.is_constant();
    if (!is_computed) return;
    list_ = nullptr;
    const auto [known, is_new] = place_.emplace(part.node(), all_.size());
    if (is_new) {
        all_.push_back({Expr(part.node_), std::string(name)});
    } else if (!part.is_constant()) {  // two names may have one number
        all_[known->second].name = name;
    }
}

void PartNames::move(const Expr& before, const Expr& after) {
    if (same(before, after)) return;
    if (const std::string* name = of(before); name && !of(after)) add(std::string(*name), after);
}

const std::string* PartNames::of(const Expr& part) const {
    const auto found = place_.find(part.node());
    return found == place_.end() ? nullptr : &all_[found->second].name;
}

Expr PartNames::on(const Expr& expr) {
    if (!list_ && !all_.empty())
        list_ = std::make_shared<const PartNameList>(PartNameList{nullptr, nullptr, all_});
    return Expr(expr.node_, list_);
}

TONEWRIGHT_NAMESPACE_END
