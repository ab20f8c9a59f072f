// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tonewright/error.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);
const Expr kY = Expr::input(1);

TEST(Expr, SubstitutesInputs) {
    const std::array<Expr, 2> inputs = {kY + 1, kX};
    EXPECT_EQ(to_string(substitute(kX * kY, inputs)), "(g + 1)*r");
}

// The slope by the definition of a derivative: central difference, error O(h^2) with h = 1e-5.
double slope_at(const Expr& f, double x) {
    constexpr double h = 1e-5;
    return (evaluate(f, x + h) - evaluate(f, x - h)) / (2 * h);
}

TEST(Expr, DerivativesMatchDifferenceQuotients) {
    auto table = std::make_shared<Table>();
    table->samples = {0, 0.2, 0.9, 1.5};
    auto uneven = std::make_shared<Table>(*table);
    uneven->positions = {0.05, 0.3, 0.42, 0.9};
    const std::vector<Expr> curves = {kX * kX * 3 - 2 / kX,
                                      pow(kX, 2.4),
                                      pow(2, kX),
                                      exp2(kX * kX),
                                      log2(kX + 1),
                                      sqrt(kX) * sin(kX),
                                      cos(3 * kX),
                                      atan2(kX, 2),
                                      atan2(2, kX),
                                      abs(kX - 2),
                                      min(kX, 0.5) + max(kX, 0.5) * 2,
                                      select(less(kX, 0.3), kX, kX * kX),
                                      srgb_encode(kX),
                                      lookup(table, kX),
                                      lookup(uneven, kX),
                                      pow(kX, kX)};
    for (const Expr& f : curves) {
        const Expr d = derivative(f);
        for (const double x : {0.1, 0.4, 0.77, 0.95}) {
            const double expected = slope_at(f, x);
            EXPECT_NEAR(evaluate(d, x), expected, 1e-7 * std::max(1.0, std::fabs(expected)))
                << to_string(f) << " at " << x;
        }
    }
    EXPECT_TRUE(derivative(floor(kX)).is_constant(0));
    EXPECT_TRUE(derivative(kY, 0).is_constant(0));
}

TEST(Expr, SlopeOfUnevenTableIsZeroOutside) {
    const auto table = std::make_shared<const Table>(
        Table{{1, 2, 4}, Table::Interpolation::linear, {0.25, 0.5, 0.625}});
    const Expr d = derivative(lookup(table, kX));
    EXPECT_EQ(evaluate(d, 0.1), 0);
    EXPECT_EQ(evaluate(d, 0.25), 4);
    EXPECT_EQ(evaluate(d, 0.49), 4);
    EXPECT_EQ(evaluate(d, 0.5), 16) << "at a kink: the side behind it";
    EXPECT_EQ(evaluate(d, 0.625), 16);
    EXPECT_EQ(evaluate(d, 0.7), 0);
    EXPECT_NEAR(inverse_at(lookup(table, kX), 3, 0.25, 0.625), 0.5625, 1e-15);
}

TEST(Expr, InverseFindsTheArgument) {
    // x/(1+x) = y has x = y/(1-y).
    const Expr reinhard = kX / (1 + kX);
    for (const double y : {0.0, 1e-6, 0.1, 0.5, 0.9, 0.999}) {
        EXPECT_NEAR(inverse_at(reinhard, y, 0, 1e4), y / (1 - y), 1e-12 * (1 + y / (1 - y)));
    }
    EXPECT_NEAR(inverse_at(-kX * kX, -4, 0, 10), 2, 1e-14) << "falling curves too";
    EXPECT_NEAR(inverse_at(srgb_encode(kX), 0.5, 0, 1), 0.21404114048223255, 1e-15)
        << "IEC 61966-2-1";
    // Flat at the start: Newton alone would leave the interval.
    EXPECT_NEAR(inverse_at(pow(kX, 8), 1e-4, 0, 1), std::pow(1e-4, 1.0 / 8), 1e-12);
}

TEST(Expr, InverseRefusesValuesOutOfRange) {
    const Expr reinhard = kX / (1 + kX);
    EXPECT_THROW((void)inverse_at(reinhard, 1.5, 0, 100), Error);
    EXPECT_THROW((void)inverse_at(log2(kX), 0, 0, 1), Error) << "log2(0) is not finite";
    EXPECT_THROW((void)inverse_at(kX, 0.5, 1, 0), Error);
}

TEST(Expr, FindsKinks) {
    const Expr f = min(max(kX, 0.25), 3) + select(less_equal(kX, 0.0031308), kX, 2 * kX);
    const std::vector<double> found = kinks(f, 0, 10);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_NEAR(found[0], 0.0031308, 1e-15);
    EXPECT_NEAR(found[1], 0.25, 1e-15);
    EXPECT_NEAR(found[2], 3, 1e-14);
    EXPECT_TRUE(kinks(kX * kX, -1, 1).empty());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
