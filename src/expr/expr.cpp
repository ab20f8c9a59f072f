// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <span>
#include <unordered_map>
#include <utility>

#include "base/format_number.h"
#include "expr/grid_place.h"
#include "expr/node.h"
#include "expr/part_name_list.h"
#include "expr/scalar_ops.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

double at_positions(const Table& table, double x) noexcept {
    const std::vector<double>& at = table.positions;
    const std::vector<double>& samples = table.samples;
    if (!(x > at.front())) return samples.front();  // NaN too
    if (x >= at.back()) return samples.back();
    const auto next =
        static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
    const std::size_t i = next - 1;
    if (table.interpolation == Table::Interpolation::step) return samples[i];
    return samples[i] + (x - at[i]) / (at[next] - at[i]) * (samples[next] - samples[i]);
}

}  // namespace

double Table::operator()(double x) const noexcept {
    if (samples.empty()) return 0;
    if (!positions.empty()) return at_positions(*this, x);
    const std::size_t n = samples.size();
    const double t = x > 0 ? (x < 1 ? x : 1.0) : 0.0;  // NaN -> first sample
    if (interpolation == Interpolation::step) {
        const auto i = static_cast<std::size_t>(t * static_cast<double>(n));
        return samples[i < n ? i : n - 1];
    }
    const double position = t * static_cast<double>(n - 1);
    const auto i = static_cast<std::size_t>(position);
    if (i + 1 >= n) return samples[n - 1];
    return samples[i] + (position - static_cast<double>(i)) * (samples[i + 1] - samples[i]);
}

Grid::Grid(int edge, std::function<std::vector<double>()> make)
    : Grid(edge, std::move(make), nullptr) {}

Grid::Grid(int edge, std::function<std::vector<double>()> make,
           std::function<std::vector<Expr>()> formula)
    : edge_(edge), make_(std::move(make)), formula_(std::move(formula)) {
    if (edge < 2) {
        throw Error("grid: edge is " + std::to_string(edge) + "; expected at least 2");
    }
}

const std::vector<double>& Grid::nodes() const {
    std::call_once(made_, [this] {
        std::vector<double> nodes = make_();
        const auto n = static_cast<std::size_t>(edge_);
        if (nodes.size() != 3 * n * n * n) {
            throw Error("grid: it has " + std::to_string(nodes.size()) +
                        " numbers; expected 3 of each of " + std::to_string(edge_) + "^3 nodes");
        }
        nodes_ = std::move(nodes);
        make_ = nullptr;
    });
    return nodes_;
}

std::vector<Expr> Grid::formula() const { return formula_(); }

double Grid::operator()(int channel, double r, double g, double b) const {
    const GridPlace t(edge_, {r, g, b});
    const auto c = static_cast<std::size_t>(channel);
    const std::vector<double>& node = nodes();
    return t.interpolate(&node[c]);
}

std::array<double, 3> Grid::operator()(double r, double g, double b) const {
    return {(*this)(0, r, g, b), (*this)(1, r, g, b), (*this)(2, r, g, b)};
}

std::array<double, 3> Grid::gradient(int channel, double r, double g, double b) const {
    const std::array<double, 3> at = {r, g, b};
    return GridPlace(edge_, at).gradient(&nodes()[static_cast<std::size_t>(channel)], edge_, at);
}

namespace {

/// Key of a shared node. Constants are compared by their bits, because 0 and -0 differ.
struct NodeKey {
    ExprOp op;
    std::uint64_t bits;  // of the constant, or the input's index, or the grid's channel
    std::array<const ExprNode*, 3> operands;
    const void* data;  // table or grid
    std::string name;  // of the uniform
    friend bool operator==(const NodeKey&, const NodeKey&) = default;
};

struct NodeKeyHash {
    std::size_t operator()(const NodeKey& key) const noexcept {
        std::size_t h =
            std::hash<std::uint64_t>{}(key.bits) ^ (static_cast<std::size_t>(key.op) << 7);
        for (const ExprNode* p : key.operands) {
            h = h * 1000003U ^ std::hash<const void*>{}(p);
        }
        h = h * 1000003U ^ std::hash<const void*>{}(key.data);
        return key.name.empty() ? h : h * 1000003U ^ std::hash<std::string>{}(key.name);
    }
};

struct SharedNodes {
    std::mutex mutex;
    std::unordered_map<NodeKey, std::weak_ptr<const ExprNode>, NodeKeyHash> nodes;
};

// Never destroyed, because expressions in static objects may outlive this one.
SharedNodes& shared_nodes() {
    static auto* shared = new SharedNodes;
    return *shared;
}

std::shared_ptr<const ExprNode> share(ExprNode node) {
    NodeKey key{node.op, 0, {}, node.table.get(), node.name};
    if (node.grid) key.data = node.grid.get();
    key.bits = node.op == ExprOp::input || node.op == ExprOp::grid
                   ? static_cast<std::uint64_t>(node.input)
                   : std::bit_cast<std::uint64_t>(node.value);
    for (std::size_t i = 0; i < node.operands.size(); ++i)
        key.operands[i] = node.operands[i].node();

    SharedNodes& shared = shared_nodes();
    const auto known = [&]() -> std::shared_ptr<const ExprNode> {
        const auto it = shared.nodes.find(key);
        return it == shared.nodes.end() ? nullptr : it->second.lock();
    };
    {
        const std::lock_guard lock(shared.mutex);
        if (auto alive = known()) return alive;
    }
    // The deleter removes the entry before it releases the operands, whose addresses are in the
    // key. It locks, so `made` is created and destroyed without the lock, even if memory runs out.
    auto deleter = [key](const ExprNode* p) {
        {
            SharedNodes& all = shared_nodes();
            const std::lock_guard inner(all.mutex);
            auto it = all.nodes.find(key);
            if (it != all.nodes.end() && it->second.expired()) all.nodes.erase(it);
        }
        delete p;
    };
    std::shared_ptr<const ExprNode> made(new ExprNode(std::move(node)), deleter);
    const std::lock_guard lock(shared.mutex);
    if (auto alive = known()) return alive;  // another thread was faster
    shared.nodes[key] = made;
    return made;
}

/// x+0, x*1, select of a constant, ...: the operand that equals the operation, if any.
const Expr* neutral(ExprOp op, std::span<const Expr> in, Expr& zero) {
    const auto is = [&](std::size_t i, double v) { return in[i].is_constant(v); };
    switch (op) {
        case ExprOp::add:
            if (is(0, 0)) return &in[1];
            if (is(1, 0)) return &in[0];
            break;
        case ExprOp::subtract:
            if (is(1, 0)) return &in[0];
            break;
        case ExprOp::multiply:
            if (is(0, 1)) return &in[1];
            if (is(1, 1)) return &in[0];
            if (is(0, 0) || is(1, 0)) return &zero;
            break;
        case ExprOp::divide:
            if (is(1, 1)) return &in[0];
            if (is(0, 0) && !in[1].is_constant(0)) return &zero;
            break;
        case ExprOp::power:
            if (is(1, 1)) return &in[0];
            break;
        case ExprOp::minimum:
        case ExprOp::maximum:
            if (same(in[0], in[1])) return &in[0];
            break;
        case ExprOp::negate:
            break;
        case ExprOp::select:
            if (in[0].is_constant()) return in[0].value() != 0 ? &in[1] : &in[2];
            if (same(in[1], in[2])) return &in[1];
            break;
        default:
            break;
    }
    return nullptr;
}

}  // namespace

Expr::Expr(double value) {
    ExprNode node;
    node.op = ExprOp::constant;
    node.value = value;
    node_ = share(std::move(node));
}

Expr Expr::input(int index) {
    ExprNode node;
    node.op = ExprOp::input;
    node.input = index;
    return Expr(share(std::move(node)));
}

Expr Expr::uniform(std::string name) {
    ExprNode node;
    node.op = ExprOp::uniform;
    node.name = std::move(name);
    return Expr(share(std::move(node)));
}

ExprOp Expr::op() const noexcept { return node_->op; }
bool Expr::is_constant(double v) const noexcept {
    return node_->op == ExprOp::constant && node_->value == v;
}
double Expr::value() const noexcept { return node_->value; }
int Expr::input_index() const noexcept { return node_->input; }
const std::string& Expr::uniform_name() const noexcept { return node_->name; }
const std::shared_ptr<const Table>& Expr::table() const noexcept { return node_->table; }
const std::shared_ptr<const Grid>& Expr::grid() const noexcept { return node_->grid; }
int Expr::channel() const noexcept { return node_->input; }
int Expr::operand_count() const noexcept { return static_cast<int>(node_->operands.size()); }
Expr Expr::operand(int i) const {
    return Expr(node_->operands[static_cast<std::size_t>(i)].node_, names_);
}

Expr make_expr(ExprOp op, Span<const Expr> in, std::shared_ptr<const Table> table) {
    bool all_constant = true;
    std::shared_ptr<const PartNameList> names;
    for (const Expr& e : in) {
        all_constant = all_constant && e.is_constant();
        names = joined(names, e.names_);
    }
    if (all_constant) {
        const double a = in[0].value();
        const double b = in.size() > 1 ? in[1].value() : 0;
        const double c = in.size() > 2 ? in[2].value() : 0;
        return Expr(Expr(scalar_op(op, a, b, c, table.get())).node_, std::move(names));
    }
    Expr zero(0.0);
    if (const Expr* simpler = neutral(op, in, zero)) return Expr(simpler->node_, std::move(names));
    if (op == ExprOp::negate && in[0].op() == ExprOp::negate) return in[0].operand(0);

    ExprNode node;
    node.op = op;
    // Other expressions share the node: it holds no names.
    for (const Expr& e : in)
        node.operands.push_back(Expr(e.node_));
    node.table = std::move(table);
    return Expr(share(std::move(node)), std::move(names));
}

namespace {
Expr make1(ExprOp op, const Expr& a) { return make_expr(op, std::array{a}); }
Expr make2(ExprOp op, const Expr& a, const Expr& b) { return make_expr(op, std::array{a, b}); }
}  // namespace

Expr operator+(const Expr& a, const Expr& b) { return make2(ExprOp::add, a, b); }
Expr operator-(const Expr& a, const Expr& b) { return make2(ExprOp::subtract, a, b); }
Expr operator*(const Expr& a, const Expr& b) { return make2(ExprOp::multiply, a, b); }
Expr operator/(const Expr& a, const Expr& b) { return make2(ExprOp::divide, a, b); }
Expr operator-(const Expr& a) { return make1(ExprOp::negate, a); }
Expr min(const Expr& a, const Expr& b) { return make2(ExprOp::minimum, a, b); }
Expr max(const Expr& a, const Expr& b) { return make2(ExprOp::maximum, a, b); }
Expr abs(const Expr& a) { return make1(ExprOp::absolute, a); }
Expr sqrt(const Expr& a) { return make1(ExprOp::square_root, a); }
Expr exp2(const Expr& a) { return make1(ExprOp::exp2, a); }
Expr log2(const Expr& a) { return make1(ExprOp::log2, a); }
Expr pow(const Expr& base, const Expr& exponent) { return make2(ExprOp::power, base, exponent); }
Expr sin(const Expr& radians) { return make1(ExprOp::sine, radians); }
Expr cos(const Expr& radians) { return make1(ExprOp::cosine, radians); }
Expr atan2(const Expr& y, const Expr& x) { return make2(ExprOp::atan2, y, x); }
Expr floor(const Expr& a) { return make1(ExprOp::floor, a); }
Expr less(const Expr& a, const Expr& b) { return make2(ExprOp::less, a, b); }
Expr less_equal(const Expr& a, const Expr& b) { return make2(ExprOp::less_equal, a, b); }
Expr equal(const Expr& a, const Expr& b) { return make2(ExprOp::equal, a, b); }
Expr select(const Expr& condition, const Expr& if_true, const Expr& if_false) {
    return make_expr(ExprOp::select, std::array{condition, if_true, if_false});
}
Expr lookup(std::shared_ptr<const Table> table, const Expr& index) {
    const std::vector<double>& at = table->positions;
    if (!at.empty() && at.size() != table->samples.size()) {
        throw Error("table: it has " + std::to_string(table->samples.size()) + " samples at " +
                    std::to_string(at.size()) + " positions; expected as many");
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (!std::isfinite(at[i]) || (i > 0 && !(at[i] > at[i - 1]))) {
            throw Error("table: position " + std::to_string(i) + " is " + shortest(at[i]) +
                        "; expected finite positions, each larger than the one before");
        }
    }
    return make_expr(ExprOp::lookup, std::array{index}, std::move(table));
}

Expr interpolate(std::shared_ptr<const Grid> grid, int channel, const Expr& r, const Expr& g,
                 const Expr& b) {
    if (r.is_constant() && g.is_constant() && b.is_constant())
        return (*grid)(channel, r.value(), g.value(), b.value());
    ExprNode node;
    node.op = ExprOp::grid;
    node.input = channel;
    node.operands = {Expr(r.node_), Expr(g.node_), Expr(b.node_)};
    node.grid = std::move(grid);
    return Expr(share(std::move(node)), joined(joined(r.names_, g.names_), b.names_));
}

Expr exp(const Expr& a) { return exp2(a * std::numbers::log2e); }
Expr log(const Expr& a) { return log2(a) * std::numbers::ln2; }
Expr clamp(const Expr& a, const Expr& lo, const Expr& hi) { return min(max(a, lo), hi); }
Expr mix(const Expr& a, const Expr& b, const Expr& t) { return a + t * (b - a); }
Expr smoothstep(const Expr& edge0, const Expr& edge1, const Expr& x) {
    const Expr t = named("t", clamp((x - edge0) / (edge1 - edge0), 0, 1));
    return t * t * (3 - 2 * t);
}

TONEWRIGHT_NAMESPACE_END
