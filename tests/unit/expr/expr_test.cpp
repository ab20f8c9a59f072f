// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "base/format_number.h"
#include "base/strings.h"
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

TEST(Expr, PrintsExactlyAndWithFewestBrackets) {
    EXPECT_EQ(to_string(kX * (kX + 1) / 3), "x*(x + 1)/3");
    EXPECT_EQ(to_string(kX - (kX - 1)), "x - (x - 1)");
    EXPECT_EQ(to_string(kX / (kX / 0.1)), "x/(x/0.1)");
    EXPECT_EQ(to_string(kX + (1 - kX)), "x + (1 - x)") << "a+(b-c) rounds differently from a+b-c";
    EXPECT_EQ(to_string(-(kX + 1)), "-(x + 1)");
    EXPECT_EQ(to_string(pow(max(kX, 0), 1 / 2.4)), "pow(max(x, 0), 0.4166666666666667)");
    EXPECT_EQ(to_string(kX * kY), "r*g");
    EXPECT_EQ(to_string(kX * -2), "x*-2");
    EXPECT_EQ(to_string(kX - -2), "x - -2");
    EXPECT_EQ(shortest(0.1), "0.1");
    EXPECT_EQ(shortest(1.0 / 3), "0.3333333333333333");
}

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

TEST(Names, NearestNameHelpsWithSlipsOnly) {
    const std::vector<std::string> ids = {"hable", "reinhard", "agx_sobotka"};
    EXPECT_EQ(nearest_name("habel", ids), "hable");
    EXPECT_EQ(nearest_name("Reinhart", ids), "reinhard");
    EXPECT_EQ(nearest_name("agx", ids), "agx_sobotka");
    EXPECT_EQ(nearest_name("xyz", ids), "");
    EXPECT_EQ(nearest_name("foo", {"toe", "ferwerda"}), "") << "two letters of three are no slip";
    EXPECT_EQ(nearest_name("rec709", {"rec2020", "rec1886"}), "") << "other digits, another thing";
    EXPECT_EQ(nearest_name("lin_rec708", {"lin_rec709"}), "lin_rec709");
    EXPECT_EQ(nearest_name("aces2", {"agx", "aces_20"}), "aces_20") << "without its separator";
    EXPECT_EQ(nearest_name("srbg", {"g22", "srgb"}), "srgb") << "letters that changed places";
    EXPECT_EQ(nearest_name("", ids), "");
    EXPECT_EQ(nearest_name(std::string(100000, 'a'), ids), "");
    EXPECT_EQ(join_choices({"a", "b", "c"}), "a, b or c");
}

TEST(Names, AWordOfANameMeansIt) {
    const std::vector<NamedChoice> displays = {{"srgb", {"sRGB", "srgb_rec709_display"}},
                                               {"display_p3", {"Display P3"}},
                                               {"rec1886", {"Rec.1886", "g24_rec709_display"}},
                                               {"p3d65_pq", {"P3-D65 PQ"}}};
    EXPECT_EQ(did_you_mean("P3", displays), "; did you mean display_p3 or p3d65_pq?");
    EXPECT_EQ(did_you_mean("rec709", displays), "; did you mean srgb or rec1886?");
    EXPECT_EQ(did_you_mean("davinci", std::vector<NamedChoice>{{"resolve", {"DaVinci Resolve"}}}),
              "; did you mean resolve?");
    EXPECT_EQ(did_you_mean("crt", displays), "");
}

TEST(Names, AreTheSameInAnyCaseAndWithAnyBetween) {
    for (const char* name :
         {"AgX Punchy", "agx_punchy", "AGX-punchy", " agx  punchy ", "agx - punchy"})
        EXPECT_EQ(folded_name(name), "agx_punchy") << name;
    EXPECT_FALSE(is_same_name("agxpunchy", "agx_punchy"));
    EXPECT_EQ(find_choice("x", "Log_Average", {"mean", "log-average"}), 1U);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
