// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "tonewright/span.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Operation of a node of an expression.
enum class ExprOp : unsigned char {
    constant,
    input,
    add,
    subtract,
    multiply,
    divide,
    minimum,
    maximum,
    power,
    atan2,
    less,        // 1 where a < b, else 0
    less_equal,  // 1 where a <= b, else 0
    equal,       // 1 where a == b, else 0
    negate,
    absolute,
    square_root,
    exp2,
    log2,
    sine,
    cosine,
    floor,
    select,   // b where a is not 0, else c
    lookup,   // table, index
    grid,     // one channel of a grid at three coordinates
    uniform,  // a number with a name and no value yet
};

/// Samples of a function, at equal distances over [0, 1] or at `positions`. Outside, the first or
/// the last sample holds.
struct Table {
    enum class Interpolation : unsigned char {
        linear,  // straight lines between samples
        step,    // sample i holds over [i/n, (i+1)/n), or from its position up to the next: the
                 // slope of a linear table
    };
    std::vector<double> samples;
    Interpolation interpolation = Interpolation::linear;
    /// Empty: equal distances. Otherwise one for each sample: finite and increasing.
    std::vector<double> positions = {};

    /// NaN gives the first sample.
    [[nodiscard]] double operator()(double x) const noexcept;
};

class Expr;

/// A 3D LUT: colors on a grid of edge^3 nodes over the unit cube, interpolated in tetrahedra along
/// the gray diagonal. Outside, the nearest face holds.
class TONEWRIGHT_API Grid {
  public:
    /// @param make  gives red, green, blue of each node, the third coordinate running fastest.
    ///              It is called once, at the first use of a node.
    /// @throws Error  for an edge below 2.
    Grid(int edge, std::function<std::vector<double>()> make);
    /// @param formula  gives three expressions that compute the same node. Inputs 0, 1, 2: the
    ///                 coordinates of the node in [0, 1].
    Grid(int edge, std::function<std::vector<double>()> make,
         std::function<std::vector<Expr>()> formula);

    [[nodiscard]] int edge() const noexcept { return edge_; }
    /// Safe to call from several threads.
    /// @throws Error  `make` does not give 3 edge^3 numbers; exceptions of `make` pass through. The
    ///                next call tries again.
    [[nodiscard]] const std::vector<double>& nodes() const;
    [[nodiscard]] bool has_formula() const noexcept { return formula_ != nullptr; }
    /// @pre has_formula()
    [[nodiscard]] std::vector<Expr> formula() const;

    /// NaN counts as 0. These throw as nodes() does; after nodes() has returned once, they do not
    /// throw.
    [[nodiscard]] std::array<double, 3> operator()(double r, double g, double b) const;
    [[nodiscard]] double operator()(int channel, double r, double g, double b) const;
    /// d channel / d each coordinate, in the tetrahedron that contains the point; 0 along a
    /// coordinate outside [0, 1].
    [[nodiscard]] std::array<double, 3> gradient(int channel, double r, double g, double b) const;

  private:
    int edge_;
    mutable std::once_flag made_;
    mutable std::function<std::vector<double>()> make_;
    mutable std::vector<double> nodes_;
    std::function<std::vector<Expr>()> formula_;
};

struct ExprNode;
struct PartNameList;

/// An immutable scalar expression over numbered inputs.
///
/// Operators are written as expressions, which read like the formula of the paper. Building one
/// folds constants, drops neutral elements (x+0, x*1, x*0, ...; inputs are finite by contract, so
/// 0*x is 0) and shares equal nodes: two expressions built the same way are the same node. Nothing
/// else is rewritten, so the reference engine computes the formula in its own order.
///
/// There is no conversion to bool: an `if` on a pixel value does not compile. `select` is the
/// branch.
class TONEWRIGHT_API Expr {
  public:
    Expr(double value);  // NOLINT(google-explicit-constructor): constants read as numbers

    /// The value of input `index` (of a curve: 0; of a three-channel stage: 0, 1, 2 = red, green,
    /// blue).
    [[nodiscard]] static Expr input(int index = 0);

    /// A number that bind_uniforms() gives a value, or that becomes an argument of a shader or an
    /// engine.
    [[nodiscard]] static Expr uniform(std::string name);

    [[nodiscard]] ExprOp op() const noexcept;
    [[nodiscard]] bool is_constant() const noexcept { return op() == ExprOp::constant; }
    [[nodiscard]] bool is_constant(double value) const noexcept;
    /// @pre op() is constant
    [[nodiscard]] double value() const noexcept;
    /// @pre op() is input
    [[nodiscard]] int input_index() const noexcept;
    /// @pre op() is uniform
    [[nodiscard]] const std::string& uniform_name() const noexcept;
    /// @pre op() is lookup
    [[nodiscard]] const std::shared_ptr<const Table>& table() const noexcept;
    /// @pre op() is grid
    [[nodiscard]] const std::shared_ptr<const Grid>& grid() const noexcept;
    /// @pre op() is grid
    [[nodiscard]] int channel() const noexcept;
    [[nodiscard]] int operand_count() const noexcept;
    [[nodiscard]] Expr operand(int i) const;
    /// The shared node: the same for two expressions exactly if they were built in the same way,
    /// whatever names their parts have.
    [[nodiscard]] const ExprNode* node() const noexcept { return node_.get(); }

  private:
    friend Expr make_expr(ExprOp op, Span<const Expr> operands, std::shared_ptr<const Table> table);
    friend Expr interpolate(std::shared_ptr<const Grid> grid, int channel, const Expr& r,
                            const Expr& g, const Expr& b);
    friend class PartNames;
    friend Expr named(const char* name, const Expr& part);
    explicit Expr(std::shared_ptr<const ExprNode> node,
                  std::shared_ptr<const PartNameList> names = nullptr)
        : node_(std::move(node)), names_(std::move(names)) {}
    std::shared_ptr<const ExprNode> node_;
    std::shared_ptr<const PartNameList> names_;  // of its parts; null: none
};

/// Builds a node from its operation and operands, with the same folding as the functions below.
TONEWRIGHT_API Expr make_expr(ExprOp op, Span<const Expr> operands,
                              std::shared_ptr<const Table> table = nullptr);

[[nodiscard]] inline bool same(const Expr& a, const Expr& b) { return a.node() == b.node(); }

TONEWRIGHT_API Expr operator+(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr operator-(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr operator*(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr operator/(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr operator-(const Expr& a);
TONEWRIGHT_API Expr min(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr max(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr abs(const Expr& a);
TONEWRIGHT_API Expr sqrt(const Expr& a);
TONEWRIGHT_API Expr exp2(const Expr& a);
TONEWRIGHT_API Expr log2(const Expr& a);
TONEWRIGHT_API Expr pow(const Expr& base, const Expr& exponent);
TONEWRIGHT_API Expr sin(const Expr& radians);
TONEWRIGHT_API Expr cos(const Expr& radians);
TONEWRIGHT_API Expr atan2(const Expr& y, const Expr& x);
TONEWRIGHT_API Expr floor(const Expr& a);
TONEWRIGHT_API Expr less(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr less_equal(const Expr& a, const Expr& b);
TONEWRIGHT_API Expr equal(const Expr& a, const Expr& b);
/// `if_true` where `condition` is not 0, else `if_false`. Both are evaluated.
TONEWRIGHT_API Expr select(const Expr& condition, const Expr& if_true, const Expr& if_false);
/// @throws Error  the table's positions are not finite and increasing
TONEWRIGHT_API Expr lookup(std::shared_ptr<const Table> table, const Expr& index);
/// Channel 0, 1 or 2 of the grid at coordinates in [0, 1].
TONEWRIGHT_API Expr interpolate(std::shared_ptr<const Grid> grid, int channel, const Expr& r,
                                const Expr& g, const Expr& b);

// Functions that papers use, composed of the ones above.
TONEWRIGHT_API Expr exp(const Expr& a);                                    // exp2(a * log2(e))
TONEWRIGHT_API Expr log(const Expr& a);                                    // log2(a) * ln(2)
TONEWRIGHT_API Expr clamp(const Expr& a, const Expr& lo, const Expr& hi);  // min(max(a, lo), hi)
TONEWRIGHT_API Expr mix(const Expr& a, const Expr& b, const Expr& t);      // a + t*(b - a)
TONEWRIGHT_API Expr smoothstep(const Expr& edge0, const Expr& edge1, const Expr& x);

/// Gives a part of a formula the name that it has in its source, and returns the part. Every
/// expression that is built of it carries the name. Shaders and .tone files show it; results do not
/// depend on it. Inputs and uniforms get none.
[[nodiscard]] TONEWRIGHT_API Expr named(const char* name, const Expr& part);

/// Names of parts, as expressions carry them. A part keeps the last name, a number the first.
class TONEWRIGHT_API PartNames {
  public:
    struct Entry {
        Expr part;
        std::string name;
    };

    PartNames() = default;
    explicit PartNames(Span<const Expr> exprs);

    /// Adds the names that the expression carries.
    void take(const Expr& expr);
    void add(std::string_view name, const Expr& part);
    /// Gives `after`, which replaces `before`, its name, unless it has one.
    void move(const Expr& before, const Expr& after);

    /// In the order in which they were given.
    [[nodiscard]] const std::vector<Entry>& all() const noexcept { return all_; }
    /// The name of the part; null: none.
    [[nodiscard]] const std::string* of(const Expr& part) const;
    /// The expression, which carries these names and no others.
    [[nodiscard]] Expr on(const Expr& expr);

  private:
    friend Expr named(const char* name, const Expr& part);
    void take(const std::shared_ptr<const PartNameList>& names);

    std::vector<Entry> all_;  // keeps the parts alive, so that no address is used twice
    std::unordered_map<const ExprNode*, std::size_t> place_;
    std::unordered_set<std::shared_ptr<const PartNameList>> taken_;
    std::shared_ptr<const PartNameList> list_;  // of all_, as on() made it; null: not made
};

/// The expression with input i replaced by `inputs[i]`. Inputs beyond the span stay.
[[nodiscard]] TONEWRIGHT_API Expr substitute(const Expr& expr, Span<const Expr> inputs);

/// Values of uniforms, by name.
using UniformValues = std::map<std::string, double, std::less<>>;

/// The expression with the named uniforms replaced by constants, and folded: the same nodes as if
/// it had been built with the constants. Uniforms without a value stay.
[[nodiscard]] TONEWRIGHT_API Expr bind_uniforms(const Expr& expr, const UniformValues& values);

/// Names of the uniforms that the expressions read, sorted.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> uniforms_of(Span<const Expr> exprs);

/// The value in double, by plain recursion over the shared nodes. This function defines the meaning
/// of an expression. It is slow: engines compile a Tape instead, which gives the same bits.
/// @throws Error  the expression has a uniform
[[nodiscard]] TONEWRIGHT_API double evaluate(const Expr& expr, Span<const double> inputs);
[[nodiscard]] TONEWRIGHT_API double evaluate(const Expr& expr, double input);

/// d expr / d input `index`. At a kink of min, max, abs or select, it is the slope of the side that
/// the function takes. Comparisons and floor have slope 0; the slope of a linear table is a step
/// table.
[[nodiscard]] TONEWRIGHT_API Expr derivative(const Expr& expr, int index = 0);

/// The exact text: constants are the shortest decimals that give the same double, and brackets
/// appear only where the order of evaluation needs them.
/// @param names  of the inputs; default: `x` for a single input, otherwise `r`, `g`, `b`
[[nodiscard]] TONEWRIGHT_API std::string to_string(const Expr& expr,
                                                   Span<const std::string> names = {});

/// Number of distinct nodes, which an engine must compute.
[[nodiscard]] TONEWRIGHT_API std::size_t node_count(Span<const Expr> exprs);

/// True when the expression reads input `index`.
[[nodiscard]] TONEWRIGHT_API bool depends_on(const Expr& expr, int index);

/// x in [lo, hi] with f(x) = y, for a monotone f: bracketed Newton steps with the symbolic
/// derivative, and bisection where they leave the bracket. Exact to the last double.
/// @throws Error  y is outside [f(lo), f(hi)], or an end is not finite
[[nodiscard]] TONEWRIGHT_API double inverse_at(const Expr& f, double y, double lo, double hi);

/// Points in (lo, hi) where f is not smooth: every x at which a comparison, min, max, abs or clamp
/// in f changes sides, exact to the last double. Sorted.
[[nodiscard]] TONEWRIGHT_API std::vector<double> kinks(const Expr& f, double lo, double hi);

TONEWRIGHT_NAMESPACE_END
