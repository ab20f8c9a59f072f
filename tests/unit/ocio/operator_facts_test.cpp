// SPDX-License-Identifier: Apache-2.0
//
// The tables of facts that lowering consults: each row names something that exists, and the
// equality that it declares holds.
#include "ocio/operator_facts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.h"
#include "measure/sample_set.h"
#include "ocio/fixed_functions.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(OperatorFacts, EveryBuiltinRowNamesOneSettingOfAnOperator) {
    std::set<std::string> styles;
    for (const BuiltinRow& row : builtin_rows()) {
        SCOPED_TRACE(row.style);
        const ResolvedOperator op = resolve_operator(row.op, row.settings);
        EXPECT_EQ(builtin_style(op), kBuiltinPrefix + std::string(row.style));
        EXPECT_TRUE(styles.insert(builtin_style(op)).second) << "two rows of one style";
    }
}

TEST(OperatorFacts, OtherSettingsEqualNoBuiltin) {
    EXPECT_EQ(builtin_style(resolve_operator("aces_13", {{"spline", "ctl"}})), "");
    EXPECT_EQ(builtin_style(resolve_operator("aces_13", {{"gamut_compression", "yes"}})), "");
    EXPECT_EQ(builtin_style(resolve_operator("aces_20", {{"peak", "300"}})), "");
    EXPECT_EQ(builtin_style(resolve_operator("hable")), "");
}

TEST(OperatorFacts, BuiltinsOfThisLibraryEqualTheirOperators) {
    // OpenColorIO 2.1 has the built-in transforms of ACES 1.x only; tests/parity/test_builtins.py
    // compares those of ACES 2.0 with a newer library. Errors are those of sRGB code values of
    // light in units of the peak. The built-in transforms evaluate logarithms and powers in
    // float32, behind curves with slopes up to 5: 99.9 % are within a code of 10 bits.
    const auto registry = OCIO::BuiltinTransformRegistry::Get();
    std::set<std::string> known;
    for (std::size_t i = 0; i < registry->getNumBuiltins(); ++i)
        known.insert(registry->getBuiltinStyle(i));
    const SampleSet samples = make_sample_set(find_input_space("lin_ap0"), {5, 4000});
    std::vector<float> in;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples.is_non_negative(i) && samples.kind[i] != SampleKind::special)
            in.insert(in.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    const ReferenceEngine srgb({ClampStage{0, 1}, curve_stage(srgb_encode(Expr::input()))});
    int compared = 0;
    for (const BuiltinRow& row : builtin_rows()) {
        const ResolvedOperator op = resolve_operator(row.op, row.settings);
        if (!known.contains(builtin_style(op))) continue;
        ++compared;
        Pipeline stages = {MatrixStage{rgb_to_rgb(kAP0, op.op->working)}};
        const Pipeline own = op.build();
        stages.insert(stages.end(), own.begin(), own.end());
        LoweredOps ops = {{BuiltinOp{builtin_style(op)}}};
        ops.push_back({MatrixOp{inverse(rgb_to_xyz_d65(op.output_primaries()))}});
        std::vector<double> truth(in.size());
        ReferenceEngine(stages).run_rgb(in.data(), truth.data(), in.size() / 3);
        std::vector<float> out(in.size());
        OcioCpu(make_processor(ops), OCIO::OPTIMIZATION_LOSSLESS)
            .run_rgb(in.data(), out.data(), in.size() / 3);
        std::vector<double> errors;
        const double peak = op.peak();
        for (std::size_t i = 0; i < in.size(); i += 3) {
            const Vector3 a = {truth[i] / peak, truth[i + 1] / peak, truth[i + 2] / peak};
            const Vector3 b = {static_cast<double>(out[i]) / peak,
                               static_cast<double>(out[i + 1]) / peak,
                               static_cast<double>(out[i + 2]) / peak};
            const Vector3 code_a = srgb(a);
            const Vector3 code_b = srgb(b);
            double worst = 0;
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::fabs(code_a[c] - code_b[c]));
            errors.push_back(worst);
        }
        std::sort(errors.begin(), errors.end());
        EXPECT_LE(errors[errors.size() * 999 / 1000], 1.0 / 1023) << row.style;
    }
    EXPECT_GE(compared, 12) << "the rows of ACES 1.x";  // OpenColorIO 2.5 has more
}

TEST(OperatorFacts, FittedOperatorsExist) {
    for (const std::string_view id : fitted_operators()) {
        const Operator& op = find_operator(id);
        EXPECT_TRUE(lower_options(op).fits_cubes) << id;
        EXPECT_TRUE(lower_options(op).primaries == op.working) << id;
    }
    EXPECT_FALSE(lower_options(find_operator("gt7")).fits_cubes);
}

TEST(FixedFunctions, EqualTheirStages) {
    // In AP0 and AP1 light with negatives, where the functions stand in their pipelines.
    SampleRandom random(17);
    std::vector<float> signed_light;
    for (int i = 0; i < 20000; ++i) {
        const double light = std::exp2(random.uniform(-10, 8));
        for (int c = 0; c < 3; ++c)
            signed_light.push_back(static_cast<float>(light * random.uniform(-0.3, 1)));
    }
    for (const FixedFunctions& row : all_fixed_functions()) {
        SCOPED_TRACE(row.functions.front().style);
        const Lowered lowered = lower_to_ocio({row.stage});
        EXPECT_EQ(lowered.is_exact, row.is_exact);
        const bool has_own_space = row.to_space != kIdentity3;
        ASSERT_EQ(lowered.ops.size(), row.functions.size() + (has_own_space ? 2 : 0));
        // Stages with a space of their own are of light.
        std::vector<float> in = signed_light;
        if (has_own_space) {
            for (float& x : in)
                x = std::fabs(x);
        }
        std::vector<double> truth(in.size());
        ReferenceEngine({row.stage}).run_rgb(in.data(), truth.data(), in.size() / 3);
        std::vector<float> out(in.size());
        OcioCpu(make_processor(lowered.ops), OCIO::OPTIMIZATION_LOSSLESS)
            .run_rgb(in.data(), out.data(), in.size() / 3);
        double worst = 0;
        for (std::size_t i = 0; i < in.size(); ++i) {
            const float* rgb = &in[i / 3 * 3];
            const double size = static_cast<double>(
                std::max({std::fabs(rgb[0]), std::fabs(rgb[1]), std::fabs(rgb[2])}));
            worst = std::max(worst, std::fabs(static_cast<double>(out[i]) - truth[i]) / size);
        }
        RecordProperty(row.functions.front().style, std::to_string(worst));
        // Relative to the largest channel. Exact: some ten float32 operations and a power, 2e-6.
        // Else the saturations of light below 0.01 differ; measured: 0.02 of the light, which
        // 0.18 (1 - 0.03/R) times a difference of the weights of hue by at most 0.0074 adds to.
        EXPECT_LE(worst, row.is_exact ? 2e-6 : 0.025);
        EXPECT_EQ(worst <= 2e-6, row.is_exact);
    }
}

TEST(FixedFunctions, WeighHuesAsUnrealAndFilamentButForTheirDeclaredDifference) {
    // The CTL's B-spline of 135 degrees (RRT.ctl) and smoothstep(1 - |2h/135|)^2 (Filament,
    // ToneMapper.cpp; Unreal, ACES.ush).
    double worst = 0;
    for (int i = 0; i <= 67500; ++i) {
        const double degrees = i * 1e-3;
        const double knots = degrees / (135.0 / 4);
        const double spline =
            0.25 * std::pow(std::max(2 - knots, 0.0), 3) - std::pow(std::max(1 - knots, 0.0), 3);
        const double t = 1 - 2 * degrees / 135;
        worst = std::max(worst, std::fabs(spline - std::pow(t * t * (3 - 2 * t), 2)));
    }
    EXPECT_NEAR(worst, 0.0074, 1e-4);
    for (const char* id : {"unreal", "aces_filament"}) {
        const Lowered lowered = lower_to_ocio(resolve_operator(id).build());
        EXPECT_FALSE(lowered.is_exact) << id;
        EXPECT_TRUE(std::none_of(lowered.ops.begin(), lowered.ops.end(), [](const LoweredOp& o) {
            return std::holds_alternative<Lut3DOp>(o.op);
        })) << lowered.summary;
    }
}

TEST(FixedFunctions, AreFoundByTheirExpressionsAlone) {
    for (const FixedFunctions& row : all_fixed_functions()) {
        EXPECT_EQ(find_fixed_functions(CrossTalkStage{row.stage.f}), &row);
        const auto& f = row.stage.f;
        EXPECT_EQ(find_fixed_functions(CrossTalkStage{{f[1], f[0], f[2]}}), nullptr);
        EXPECT_EQ(find_fixed_functions(CrossTalkStage{{f[0], f[1], f[2] + 1e-9}}), nullptr);
    }
    // ACES 1.3 is built of such stages; without them, its views would be sampled.
    for (const Settings& settings :
         {Settings{}, Settings{{"gamut_compression", "yes"}}, Settings{{"spline", "ctl"}}}) {
        const ResolvedOperator op = resolve_operator("aces_13", settings);
        const Lowered lowered = lower_to_ocio(op.build());
        EXPECT_EQ(lowered.is_exact, !settings.contains("spline"));
        EXPECT_TRUE(std::none_of(lowered.ops.begin(), lowered.ops.end(), [](const LoweredOp& o) {
            return std::holds_alternative<Lut3DOp>(o.op);
        })) << lowered.summary;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
