// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <thread>

#include "tonewright/error.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);
const Expr kY = Expr::input(1);

TEST(Expr, FoldsConstants) {
    EXPECT_TRUE((Expr(2) + 3).is_constant(5));
    EXPECT_TRUE(pow(Expr(2), 10).is_constant(1024));
    EXPECT_TRUE(select(less(Expr(1), 2), 7, 8).is_constant(7));
    EXPECT_TRUE(min(Expr(3), -1).is_constant(-1));
    // The folded number is the one that an engine computes: 1/3 in double.
    EXPECT_EQ((Expr(1) / 3).value(), 1.0 / 3.0);
}

TEST(Expr, DropsNeutralElements) {
    EXPECT_TRUE(same(kX + 0, kX));
    EXPECT_TRUE(same(0 + kX, kX));
    EXPECT_TRUE(same(kX - 0, kX));
    EXPECT_TRUE(same(kX * 1, kX));
    EXPECT_TRUE(same(kX / 1, kX));
    EXPECT_TRUE(same(pow(kX, 1), kX));
    EXPECT_TRUE((kX * 0).is_constant(0));
    EXPECT_TRUE(same(-(-kX), kX));
    EXPECT_TRUE(same(select(kY, kX, kX), kX));
    EXPECT_FALSE(same(kX + 1e-300, kX));
}

TEST(Expr, SharesEqualNodes) {
    const Expr a = sqrt(kX * kX + 1);
    const Expr b = sqrt(kX * kX + 1);
    EXPECT_TRUE(same(a, b));
    EXPECT_FALSE(same(kX - kY, kY - kX));
    EXPECT_FALSE(same(Expr(0.0), Expr(-0.0))) << "1/0 and 1/-0 differ";
    const std::array<Expr, 2> both = {a, a * a};
    // x, x*x, 1, x*x+1, sqrt, product
    EXPECT_EQ(node_count(both), 6U);
}

TEST(Expr, NodesGoWithTheirLastUser) {
    const ExprNode* before = nullptr;
    {
        const Expr e = kX * 1234.5678;
        before = e.node();
    }
    // Nothing to assert about freed memory but that building again works from scratch.
    EXPECT_EQ(evaluate(kX * 1234.5678, 2.0), 2469.1356);
    (void)before;
}

TEST(Expr, SharesAcrossThreads) {
    std::vector<std::thread> threads;
    std::atomic<int> wrong = 0;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&wrong] {
            for (int i = 0; i < 2000; ++i) {
                const Expr e = (Expr::input() + i % 7) * (Expr::input() - i % 5);
                const double expected = (2.0 + i % 7) * (2.0 - i % 5);
                if (evaluate(e, 2.0) != expected) ++wrong;
            }
        });
    }
    for (std::thread& t : threads)
        t.join();
    EXPECT_EQ(wrong.load(), 0);
}

TEST(Expr, EvaluatesLikeDouble) {
    const double x = 0.37;
    EXPECT_EQ(evaluate(exp2(kX), x), std::exp2(x));
    EXPECT_EQ(evaluate(log2(kX), x), std::log2(x));
    EXPECT_EQ(evaluate(pow(kX, 2.2), x), std::pow(x, 2.2));
    EXPECT_EQ(evaluate(sin(kX), x), std::sin(x));
    EXPECT_EQ(evaluate(atan2(kX, -2), x), std::atan2(x, -2.0));
    EXPECT_EQ(evaluate(floor(kX * 10), x), 3.0);
    EXPECT_EQ(evaluate(abs(-kX), x), x);
    EXPECT_NEAR(evaluate(exp(kX), x), std::exp(x), 1e-15);
    EXPECT_NEAR(evaluate(log(kX), x), std::log(x), 1e-15);
    // GLSL's definition, t = (x-a)/(b-a): 0.25 -> 3/16 - 2/64
    EXPECT_DOUBLE_EQ(evaluate(smoothstep(1, 5, kX), 2.0), 0.15625);
}

TEST(Expr, SelectTakesOneSideOnly) {
    const Expr guarded = select(less(0, kX), 1 / kX, 0);
    EXPECT_EQ(evaluate(guarded, 0.0), 0.0);
    EXPECT_EQ(evaluate(guarded, 4.0), 0.25);
}

TEST(Expr, TableHoldsItsEnds) {
    Table table{{1, 2, 4}, Table::Interpolation::linear};
    EXPECT_EQ(table(-1), 1);
    EXPECT_EQ(table(0.25), 1.5);
    EXPECT_EQ(table(0.75), 3);
    EXPECT_EQ(table(1), 4);
    EXPECT_EQ(table(9), 4);
    EXPECT_EQ(table(std::numeric_limits<double>::quiet_NaN()), 1);
    table.interpolation = Table::Interpolation::step;
    EXPECT_EQ(table(0.3), 1);
    EXPECT_EQ(table(0.34), 2);
    EXPECT_EQ(table(1), 4);
}

TEST(Expr, TableHasItsSamplesWhereItsPositionsSay) {
    Table table{{1, 2, 4, 8}, Table::Interpolation::linear, {-1, 0.5, 0.75, 3}};
    EXPECT_EQ(table(-5), 1);
    EXPECT_EQ(table(-1), 1);
    EXPECT_EQ(table(-0.25), 1.5);
    EXPECT_EQ(table(0.5), 2);
    EXPECT_EQ(table(0.625), 3);
    EXPECT_EQ(table(0.75), 4);
    EXPECT_EQ(table(1.875), 6);
    EXPECT_EQ(table(3), 8);
    EXPECT_EQ(table(1e300), 8);
    EXPECT_EQ(table(std::numeric_limits<double>::infinity()), 8);
    EXPECT_EQ(table(std::numeric_limits<double>::quiet_NaN()), 1);
    table.interpolation = Table::Interpolation::step;
    EXPECT_EQ(table(-5), 1);
    EXPECT_EQ(table(std::nextafter(0.5, 0)), 1);
    EXPECT_EQ(table(0.5), 2);
    EXPECT_EQ(table(2.9), 4);
    EXPECT_EQ(table(3), 8);
    EXPECT_EQ((Table{{7}, Table::Interpolation::linear, {0.5}}(0.9)), 7);
    // Narrow cells do not lose their ends.
    const double next = std::nextafter(0.5, 1);
    const Table narrow{{0, 1}, Table::Interpolation::linear, {0.5, next}};
    EXPECT_EQ(narrow(0.5), 0);
    EXPECT_EQ(narrow(next), 1);
}

TEST(Expr, EvenPositionsAreEqualDistances) {
    Table even;
    for (int i = 0; i <= 64; ++i)
        even.samples.push_back(std::sqrt(i));
    Table placed = even;
    for (int i = 0; i <= 64; ++i)
        placed.positions.push_back(i / 64.0);
    for (double x = -0.5; x < 1.5; x += 1.0 / 1024)
        EXPECT_EQ(placed(x), even(x)) << x;
}

TEST(Expr, LookupRefusesPositionsThatAreNone) {
    const auto of = [](std::vector<double> positions) {
        return std::make_shared<const Table>(
            Table{{1, 2, 3}, Table::Interpolation::linear, std::move(positions)});
    };
    EXPECT_NO_THROW((void)lookup(of({0, 0.5, 1}), kX));
    EXPECT_THROW((void)lookup(of({0, 1}), kX), Error);
    EXPECT_THROW((void)lookup(of({0, 0.5, 0.5}), kX), Error);
    EXPECT_THROW((void)lookup(of({0, 1, 0.5}), kX), Error);
    EXPECT_THROW((void)lookup(of({0, 0.5, std::numeric_limits<double>::infinity()}), kX), Error);
    EXPECT_THROW((void)lookup(of({std::numeric_limits<double>::quiet_NaN(), 0.5, 1}), kX), Error);
    EXPECT_EQ(to_string(lookup(of({}), kX)), "lookup[3](x)");
    EXPECT_EQ(to_string(lookup(of({0, 0.25, 1}), kX)), "lookup[3 uneven](x)");
}

TEST(Expr, MakeExprFoldsAsTheFunctionsDo) {
    const Expr x = Expr::input(0);
    EXPECT_TRUE(same(make_expr(ExprOp::add, std::array{x, Expr(2)}), x + 2));
    EXPECT_TRUE(same(make_expr(ExprOp::multiply, std::array{x, Expr(1)}), x)) << "neutral";
    EXPECT_EQ(make_expr(ExprOp::divide, std::array{Expr(1), Expr(4)}).value(), 0.25) << "constants";
    EXPECT_TRUE(same(make_expr(ExprOp::select, std::array{less(x, 1), x, Expr(1)}),
                     select(less(x, 1), x, 1)));
}

TEST(Expr, MixIsTheStraightLineBetweenTwo) {
    const Expr t = Expr::input(0);
    for (const double at : {-1.0, 0.0, 0.25, 1.0, 2.0})
        EXPECT_EQ(evaluate(mix(2, 10, t), at), 2 + 8 * at)
            << "exact in double, also beyond the ends";
}

TEST(Expr, DependsOnTheInputsThatItReads) {
    const Expr x = Expr::input(0);
    const Expr z = Expr::input(2);
    const Expr f = select(less(x, 1), z, 4);
    EXPECT_TRUE(depends_on(f, 0)) << "a condition counts";
    EXPECT_FALSE(depends_on(f, 1));
    EXPECT_TRUE(depends_on(f, 2));
    EXPECT_FALSE(depends_on(0 * x, 0)) << "folded";
    EXPECT_FALSE(depends_on(Expr::uniform("u"), 0));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
