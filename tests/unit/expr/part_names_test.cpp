// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// "name name ...", in the order in which they were given.
std::string names_of(const Expr& e) {
    std::string text;
    const PartNames names(std::array{e});
    for (const PartNames::Entry& entry : names.all())
        text += (text.empty() ? "" : " ") + entry.name;
    return text;
}

TEST(PartNames, TravelWithTheExpression) {
    const Expr x = Expr::input();
    const Expr toe = named("toe", x * x);
    const Expr knee = named("knee", toe + 2);
    EXPECT_EQ(names_of(x * x), "") << "the shared node has no name";
    EXPECT_TRUE(same(toe, x * x)) << "names do not change the node";
    EXPECT_EQ(names_of(knee), "toe knee");
    EXPECT_EQ(names_of(knee.operand(0)), "toe knee") << "so that who rebuilds parts keeps names";
    EXPECT_EQ(names_of(select(less(x, 1), knee, named("shoulder", sqrt(x)))), "toe knee shoulder");
    EXPECT_EQ(names_of(toe * 1), "toe") << "neutral";
    EXPECT_EQ(*PartNames(std::array{knee}).of(x * x), "toe");
    EXPECT_EQ(PartNames(std::array{knee}).of(x * 3), nullptr);
}

TEST(PartNames, NumbersHaveNamesInputsHaveNone) {
    const Expr white = named("white", Expr(11.2));
    EXPECT_EQ(names_of(named("x", Expr::input())), "");
    EXPECT_EQ(names_of(named("u", Expr::uniform("u"))), "");
    EXPECT_EQ(names_of(Expr::input() / (white * 2)), "white") << "of a folded number";
    EXPECT_EQ(names_of(white + named("other", Expr(11.2))), "white") << "a number keeps the first";
    const Expr part = Expr::input() * 3;
    EXPECT_EQ(names_of(named("new", named("old", part))), "new") << "a part keeps the last";
}

TEST(PartNames, RewrittenPartsKeepThem) {
    const Expr x = Expr::input();
    const Expr f = named("shoulder", named("toe", x * x) + Expr::uniform("lift"));
    const Expr other = named("signal", exp2(x));
    const Expr g = substitute(f, std::array{other});
    EXPECT_EQ(*PartNames(std::array{g}).of(exp2(x) * exp2(x)), "toe");
    EXPECT_EQ(*PartNames(std::array{g}).of(exp2(x)), "signal");
    EXPECT_EQ(*PartNames(std::array{g}).of(g), "shoulder");
    EXPECT_EQ(PartNames(std::array{g}).of(x * x), nullptr) << "it is gone";
    const Expr bound = bind_uniforms(g, {{"lift", 0.5}});
    EXPECT_EQ(*PartNames(std::array{bound}).of(bound), "shoulder");
    EXPECT_EQ(names_of(PartNames().on(bound)), "");
}

TEST(PartNames, AreAsManyAsThePartsHoweverOftenTheyAreUsed) {
    const Expr x = Expr::input();
    Expr sum = 0;
    const Expr scale = named("scale", exp2(x));
    for (int i = 1; i < 2000; ++i)
        sum = sum + scale * named("n", Expr(i));
    EXPECT_EQ(PartNames(std::array{sum}).all().size(), 2000U);
    for (int i = 0; i < 100; ++i)
        sum = substitute(sum, std::array{x + 1});
    EXPECT_EQ(PartNames(std::array{sum}).all().size(), 2000U) << "nothing is left of earlier ones";
}

// A formula may name one part a hundred thousand times; a list inside of each list would take the
// stack of a thread.
TEST(PartNames, OnePartOfManyNamesHasOneEntry) {
    Expr part = Expr::input() * 3;
    Expr number = 0.5;
    for (int i = 0; i < 1000000; ++i) {
        part = named("other", part);
        number = named(i == 0 ? "first" : "other", number);
    }
    part = named("last", part);
    EXPECT_EQ(names_of(part + number), "last first");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
