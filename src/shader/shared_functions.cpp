// SPDX-License-Identifier: Apache-2.0
#include "shader/shared_functions.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <unordered_map>

#include "expr/nodes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);
/// Fewer operations are more readable inline.
constexpr std::size_t kFewestOperations = 6;
/// One root per channel.
constexpr std::size_t kFewestUses = 3;

class Sharer {
  public:
    explicit Sharer(const std::array<Expr, 3>& f) : names_(f), nodes_(nodes_of(f)) {
        for (Expr& e : nodes_)
            e = PartNames().on(e);
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            number_.emplace(nodes_[i].node(), i);
            dominator_.push_back(dominator_of(i));
        }
        users_.resize(nodes_.size());
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            for (int k = 0; k < nodes_[i].operand_count(); ++k)
                users_[number_.at(nodes_[i].operand(k).node())].push_back(i);
        }
        for (const Expr& e : f)
            users_[number_.at(e.node())].push_back(kNone);
    }

    SharedFunctions share(const std::array<Expr, 3>& f) {
        // Groups values by the function of an earlier value that they compute.
        std::map<std::string, std::vector<std::size_t>> alike;
        std::map<std::string, std::size_t> size;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const std::size_t root = root_of(i);
            if (root == kNone || is_condition(nodes_[i]) || is_condition(nodes_[root])) continue;
            std::map<std::size_t, std::size_t> seen = {{root, 0}};
            const std::string text = text_of(i, seen);
            if (seen.size() <= kFewestOperations || is_read_outside(i, root, seen)) continue;
            alike[text].push_back(i);
            size[text] = seen.size();
        }
        std::vector<std::string> texts;
        for (const auto& [text, values] : alike) {
            std::set<std::size_t> roots;
            for (const std::size_t i : values)
                roots.insert(root_of(i));
            if (roots.size() >= kFewestUses) texts.push_back(text);
        }
        std::stable_sort(texts.begin(), texts.end(),
                         [&](const auto& a, const auto& b) { return size.at(a) > size.at(b); });
        SharedFunctions result;
        std::map<std::size_t, std::size_t> function_of;  // by value
        std::set<std::size_t> inside;
        for (const std::string& text : texts) {
            const std::vector<std::size_t>& values = alike.at(text);
            if (std::any_of(values.begin(), values.end(),
                            [&](std::size_t i) { return inside.contains(i); }))
                continue;
            for (const std::size_t i : values) {
                function_of[i] = result.functions.size();
                std::map<std::size_t, std::size_t> seen = {{root_of(i), 0}};
                (void)text_of(i, seen);
                for (const auto& [value, place] : seen)
                    inside.insert(value);
            }
            std::map<std::size_t, Expr> known = {{root_of(values[0]), Expr::input()}};
            result.functions.push_back(named_rebuilt(values[0], known));
        }
        std::map<std::size_t, Expr> known;
        for (const auto& [value, function] : function_of) {
            const std::string* const name = names_.of(nodes_[value]);
            result.calls.push_back(
                {function, named_rebuilt(root_of(value), known), name ? *name : ""});
            known.insert_or_assign(value, Expr::input(2 + static_cast<int>(result.calls.size())));
        }
        for (std::size_t c = 0; c < 3; ++c)
            result.f[c] = named_rebuilt(number_.at(f[c].node()), known);
        return result;
    }

  private:
    static bool is_condition(const Expr& e) {
        return e.op() == ExprOp::less || e.op() == ExprOp::less_equal || e.op() == ExprOp::equal;
    }
    static bool is_constant(const Expr& e) {
        return e.op() == ExprOp::constant || e.op() == ExprOp::uniform;
    }

    /// True if other expressions read values between the root and value i, and would recompute
    /// them.
    [[nodiscard]] bool is_read_outside(std::size_t i, std::size_t root,
                                       const std::map<std::size_t, std::size_t>& seen) const {
        return std::any_of(seen.begin(), seen.end(), [&](const auto& value) {
            const std::vector<std::size_t>& users = users_[value.first];
            return value.first != i && value.first != root &&
                   std::any_of(users.begin(), users.end(),
                               [&](std::size_t user) { return !seen.contains(user); });
        });
    }

    /// Immediate dominator: the last value through which all inputs reach value i.
    [[nodiscard]] std::size_t dominator_of(std::size_t i) const {
        std::size_t common = kNone;
        for (int k = 0; k < nodes_[i].operand_count(); ++k) {
            if (is_constant(nodes_[i].operand(k))) continue;
            std::size_t other = number_.at(nodes_[i].operand(k).node());
            if (common == kNone) common = other;
            while (common != other) {  // dominators have smaller numbers
                std::size_t& later = common > other ? common : other;
                later = dominator_[later];
                if (later == kNone) return kNone;
            }
        }
        return common;
    }
    /// The first dominator.
    [[nodiscard]] std::size_t root_of(std::size_t i) const {
        std::size_t root = dominator_[i];
        while (root != kNone && dominator_[root] != kNone)
            root = dominator_[root];
        return root;
    }

    /// Key of value i relative to the root at index 0.
    [[nodiscard]] std::string text_of(std::size_t i,
                                      std::map<std::size_t, std::size_t>& seen) const {
        const Expr& e = nodes_[i];
        if (const auto known = seen.find(i); known != seen.end())
            return "#" + std::to_string(known->second);
        if (e.op() == ExprOp::constant) return std::to_string(i);  // equal ones are one node
        if (e.op() == ExprOp::uniform) return e.uniform_name();
        std::string text = std::to_string(static_cast<int>(e.op())) + "(";
        if (e.op() == ExprOp::lookup)
            text += std::to_string(reinterpret_cast<std::uintptr_t>(e.table().get())) + ":";
        for (int k = 0; k < e.operand_count(); ++k)
            text += text_of(number_.at(e.operand(k).node()), seen) + ",";
        seen.emplace(i, seen.size());
        return text + ")";
    }

    [[nodiscard]] Expr named_rebuilt(std::size_t i, std::map<std::size_t, Expr>& known) {
        const Expr result = rebuilt(i, known);
        return names_.on(result);
    }
    [[nodiscard]] Expr rebuilt(std::size_t i, std::map<std::size_t, Expr>& known) {
        if (const auto found = known.find(i); found != known.end()) return found->second;
        const Expr& e = nodes_[i];
        if (e.operand_count() == 0) return e;
        std::vector<Expr> operands;
        operands.reserve(static_cast<std::size_t>(e.operand_count()));
        for (int k = 0; k < e.operand_count(); ++k)
            operands.push_back(rebuilt(number_.at(e.operand(k).node()), known));
        Expr result =
            e.op() == ExprOp::grid
                ? interpolate(e.grid(), e.channel(), operands[0], operands[1], operands[2])
                : make_expr(e.op(), operands, e.op() == ExprOp::lookup ? e.table() : nullptr);
        names_.move(e, result);
        known.insert_or_assign(i, result);
        return result;
    }

    PartNames names_;
    std::vector<Expr> nodes_;  // without names
    std::unordered_map<const ExprNode*, std::size_t> number_;
    std::vector<std::size_t> dominator_;
    std::vector<std::vector<std::size_t>> users_;
};

}  // namespace

SharedFunctions share_functions(const std::array<Expr, 3>& f) { return Sharer(f).share(f); }

TONEWRIGHT_NAMESPACE_END
