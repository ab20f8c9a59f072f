// SPDX-License-Identifier: Apache-2.0
#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/definition/definitions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// A built-in's file gives the engines the same expressions, so that it runs at the same speed.
// TOML's integers end at 2^63, and double precision holds all of them up to 2^53.
TEST(Definition, LargeNumbersReadBack) {
    const auto op = parsed(
        "[[stage]]\nmatrix = [[11060664309660294, 1e300, -0.0], [0, 1, 0], [0, 0, 1]]\n"
        "[[stage]]\nclamp = [-12345678901234567168.0, inf]\n");
    const auto matrix = std::get<MatrixStage>(built(*op)[0]);
    EXPECT_EQ(matrix.m[0][0], 11060664309660294.0);
    const auto again = parse_operator(definition_of(resolve(*op, nullptr, {}, "")), "again.tone");
    const Pipeline stages = built(*again);
    EXPECT_EQ(std::get<MatrixStage>(stages[0]).m, matrix.m);
    EXPECT_TRUE(std::signbit(std::get<MatrixStage>(stages[0]).m[0][2]));
    EXPECT_EQ(std::get<ClampStage>(stages[1]).lo, -12345678901234567168.0);
}

/// Operators that no formula says, and why.
const std::set<std::string> kNotPrinted = {"aces_20", "agx_blender", "camera_response"};
/// Operators that fold their constants in another order where a parameter is no uniform.
const std::set<std::string> kTwoForms = {"aldridge", "drago", "log_tonemap", "logarithmic"};

TEST(Definition, EveryBuiltInReadsBackAsTheSameExpression) {
    std::set<std::string> refused;
    std::size_t count = 0;
    for (const OperatorVariant& variant : all_variants()) {
        const ResolvedOperator op = resolve_operator(variant.name, {}, variant.look);
        const std::string what = variant.name + " " + variant.look;
        std::string text;
        try {
            text = definition_of(op);
        } catch (const Error& e) {
            if (refused.insert(op.op->id).second) std::cout << e.what() << "\n";
            continue;
        }
        ++count;
        std::shared_ptr<const Operator> own;
        try {
            own = parse_operator(text, op.op->id + ".tone");
        } catch (const DefinitionError& e) {
            ADD_FAILURE() << what << ": " << e.what() << "\n" << e.excerpt() << "\n";
            continue;
        }
        const ResolvedOperator again = resolve(*own, nullptr, {}, "");
        EXPECT_EQ(live_parameters(*own), live_parameters(*op.op)) << what;
        const std::vector<std::string> live = live_parameters(*op.op);
        const Pipeline live_stages = build_live(op, live);
        expect_same(build_live(again, live), live_stages, what + " live");
        UniformValues values;
        for (const std::string& name : live)
            values.emplace(name, op.params.number(name));
        expect_same(again.build(), bind_uniforms(live_stages, values), what + " bound");
        if (!kTwoForms.contains(op.op->id)) {
            expect_same(again.build(), op.build(), what);
            EXPECT_EQ(again.build().size(), op.build().size()) << what;
        }
        EXPECT_TRUE(own->working == op.op->working) << what;
        EXPECT_TRUE(again.output_primaries() == op.output_primaries()) << what;
        EXPECT_EQ(again.peak(), op.peak()) << what;
        EXPECT_EQ(again.output(), op.output()) << what;
        if (op.output() == OutputKind::code_value) {
            EXPECT_EQ(own->code_power, op.op->code_power) << what;
        }
        EXPECT_EQ(own->bounds.simd, op.op->bounds.simd) << what;
    }
    EXPECT_EQ(refused, kNotPrinted);
    EXPECT_LE(refused.size(), 12U);
    EXPECT_GT(count, 70U);
}

TEST(LutOperator, IsWrittenAsOneStage) {
    const auto op = load_operator("stated.cube", small_table);
    for (const Settings& settings :
         {Settings{}, Settings{{"input", "slog3"}, {"output", "linear"}},
          Settings{{"input", "none"}}, Settings{{"output", "rec2100_pq"}}}) {
        const ResolvedOperator resolved = resolve(*op, nullptr, settings, "");
        const auto again = parse_operator(definition_of(resolved), "again.tone", small_table);
        const ResolvedOperator read = resolve(*again, nullptr, {}, "");
        // The grids are two objects of equal numbers.
        for (const char* display : {"native", "linear", "srgb", "rec2100_pq"}) {
            const auto shown = [&](const ResolvedOperator& of) {
                return shown_by(build_view(make_view(of, "lin_rec709", 0, display)), 0.1, 0.3, 0.2);
            };
            EXPECT_EQ(shown(read), shown(resolved)) << display;
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
