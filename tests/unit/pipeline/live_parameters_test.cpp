// SPDX-License-Identifier: Apache-2.0
//
// Live parameters: one expression serves every value of a number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "base/random.h"
#include "tonewright/pipeline.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const std::vector<std::string> kNone;

double uniform_log(SampleRandom& random, double lo, double hi) {
    // In intervals over several powers of ten, every power is drawn as often.
    if (lo > 0 && hi / lo > 100) return lo * std::pow(hi / lo, random.uniform(0, 1));
    return random.uniform(lo, hi);
}

/// All numbers of the operator drawn from their intervals, one of them sometimes at an end.
Settings draw_settings(const Operator& op, SampleRandom& random) {
    Settings settings;
    for (const ParameterSpec& spec : op.parameters) {
        const double share = random.uniform(0, 1);
        if (spec.kind == ParameterSpec::Kind::choice) {
            const auto i =
                static_cast<std::size_t>(share * static_cast<double>(spec.choices.size()));
            settings[spec.name] = spec.choices[std::min(i, spec.choices.size() - 1)];
        }
        if (spec.kind != ParameterSpec::Kind::number) continue;
        settings[spec.name] = shortest(share < 0.1   ? spec.min
                                       : share < 0.2 ? spec.max
                                                     : uniform_log(random, spec.min, spec.max));
    }
    return settings;
}

TEST(LiveParameters, AreBoundToTheOperatorsOwnExpressions) {
    SampleRandom random(20261123);
    std::size_t compared = 0;
    for (const Operator& op : all_operators()) {
        const std::vector<std::string> live = live_parameters(op);
        if (live.empty()) continue;
        for (int draw = 0; draw < 100; ++draw) {
            ResolvedOperator resolved;
            const Settings settings = draw_settings(op, random);
            try {
                resolved = resolve(op, nullptr, settings, {});
            } catch (const Error&) {
                continue;  // they contradict each other
            }
            UniformValues values;
            for (const std::string& name : live)
                values[name] = resolved.params.number(name);
            const std::array<Expr, 3> fixed = compose(resolved.build());
            const std::array<Expr, 3> bound =
                compose(bind_uniforms(build_live(resolved, live), values));
            EXPECT_TRUE(uniforms_of(bound).empty()) << resolved.label;
            for (int color = 0; color < 20; ++color) {
                const std::array<double, 3> rgb = {
                    std::exp2(random.uniform(-16, 12)),
                    color % 5 == 0 ? 0 : random.uniform(-0.2, 4),
                    color % 7 == 0 ? kHalfMax : random.uniform(0, 1)};
                std::array<double, 3> wanted{};
                double largest = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    wanted[c] = evaluate(fixed[c], rgb);
                    largest = std::max(largest, std::fabs(wanted[c]));
                }
                for (std::size_t c = 0; c < 3; ++c) {
                    // Constants take std::log1p() where expressions take their own logarithm: two
                    // last bits of it, 4e-16, which a saturation matrix may enlarge by a hundred.
                    const double shown = evaluate(bound[c], rgb);
                    const bool is_same = shown == wanted[c] ||
                                         (std::isnan(shown) && std::isnan(wanted[c])) ||
                                         std::fabs(shown - wanted[c]) <= 1e-12 * largest;
                    EXPECT_TRUE(is_same) << shown << ", not " << wanted[c] << ": " << resolved.label
                                         << " of " << rgb[0] << " " << rgb[1] << " " << rgb[2];
                    ++compared;
                }
            }
        }
    }
    EXPECT_GT(compared, 50000U);
}

TEST(LiveParameters, EveryUniformIsReadByAnExpression) {
    for (const Operator& op : all_operators()) {
        for (const std::string& name : live_parameters(op)) {
            bool is_read = false;
            SampleRandom random(7);
            for (int draw = 0; draw < 2000 && !is_read; ++draw) {
                try {
                    const ResolvedOperator resolved =
                        resolve(op, nullptr, draw_settings(op, random), {});
                    const std::array<Expr, 3> f = compose(build_live(resolved, {name}));
                    is_read = uniforms_of(f) == std::vector<std::string>{name};
                } catch (const Error&) {
                    continue;
                }
            }
            EXPECT_TRUE(is_read) << op.id << ": " << name;
        }
    }
}

TEST(LiveParameters, FortyOperatorsHaveAll) {
    std::size_t all_live = 0;
    for (const Operator& op : all_operators()) {
        bool is_live = true;
        for (const ParameterSpec& spec : op.parameters)
            is_live = is_live && (spec.kind != ParameterSpec::Kind::number || spec.is_live);
        all_live += is_live ? 1 : 0;
        if (!is_live) std::printf("fixed numbers: %s\n", op.id.c_str());
    }
    EXPECT_GE(all_live, 40U);
}

TEST(LiveParameters, ParametersThatAreNotLiveAreErrors) {
    const ResolvedOperator hable = resolve_operator("hable");
    EXPECT_THROW((void)build_live(hable, {"whit"}), Error);
    EXPECT_THROW((void)build_live(hable, {"apply"}), Error);
    EXPECT_THROW((void)build_live(resolve_operator("gt7"), {"peak"}), Error);
    EXPECT_EQ(uniforms_of(compose(build_live(hable, {"white"}))),
              std::vector<std::string>{"white"});
    EXPECT_EQ(uniforms_of(compose(build_live(hable, kNone))), kNone);
}

TEST(Uniform, HasAValueOrNone) {
    const Expr k = Expr::uniform("k");
    const Expr x = Expr::input();
    EXPECT_TRUE(same(k, Expr::uniform("k")));
    EXPECT_FALSE(same(k, Expr::uniform("j")));
    const Expr f = pow(x * k + 1, k);
    EXPECT_EQ(to_string(f), "pow(x*k + 1, k)");
    EXPECT_TRUE(same(bind_uniforms(f, {{"k", 1}}), x + 1));
    EXPECT_TRUE(same(bind_uniforms(f, {{"j", 1}}), f));
    EXPECT_TRUE(derivative(k).is_constant(0));
    EXPECT_THROW((void)evaluate(f, 1.0), Error);
    EXPECT_EQ(evaluate(bind_uniforms(f, {{"k", 2}}), 3.0), 49);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
