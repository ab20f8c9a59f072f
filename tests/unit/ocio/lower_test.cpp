// SPDX-License-Identifier: Apache-2.0
//
// Every kind of stage as OpenColorIO transforms: lowered_forms.h says how they run.
#include "ocio/lower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "lut/clf.h"
#include "lut/half_domain.h"
#include "measure/sample_set.h"
#include "ocio/fixed_functions.h"
#include "ocio/gpu.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "unit/folder.h"
#include "unit/ocio/lowered_forms.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();
using Norm = ToneScaleStage::Norm;

constexpr auto kMatrixType = Type::matrix;
constexpr auto kRangeType = Type::range;
constexpr auto kLut1D = Type::lut_1d;
constexpr auto kFixed = Type::fixed;

/// Operation i, a 1D table.
const Lut1DOp& lut_at(const Lowered& lowered, std::size_t i) {
    return std::get<Lut1DOp>(lowered.ops.at(i).op);
}

TEST(Lower, GpuFormIsTestedOrSaysWhyNot) {
    const std::string reason = OcioGpu::unavailable_reason();
    if (!reason.empty())
        GTEST_SKIP() << "the tests of this file ran without a GPU form: " << reason;
    EXPECT_FALSE(OcioGpu::renderer().empty());
}

TEST(LowerMatrix, IsExactToFloatRounding) {
    // No symmetry, no rows that sum to 1, one negative coefficient.
    const Matrix3 m = {{{0.5, 0.25, 2}, {-0.125, 3, 0.75}, {0.3, 0.1, 1.7}}};
    const Lowered lowered = lower_to_ocio({MatrixStage{m}});
    EXPECT_EQ(types_of(lowered), (Types{kMatrixType}));
    EXPECT_TRUE(lowered.is_exact);
    const std::vector<float> in = mixed_colors();
    const std::vector<double> truth = reference({MatrixStage{m}}, in);
    for (const Form& form : run_forms({MatrixStage{m}}, in)) {
        for (std::size_t i = 0; i < in.size(); ++i) {
            double size = 0;
            for (std::size_t j = 0; j < 3; ++j) {
                size += std::fabs(m[i % 3][j] * static_cast<double>(in[i / 3 * 3 + j]));
            }
            // Each of three products is rounded four times at most: coefficient, product, two sums.
            ASSERT_NEAR(static_cast<double>(form.out[i]), truth[i], 4 * 0x1p-24 * size + 1e-37)
                << form.name;
        }
    }
}

TEST(LowerMatrix, IsNotTransposed) {
    // BT.2020 -> BT.709 as ITU-R BT.2087 prints it, on the primaries: a transposed matrix would
    // give the rows.
    const Pipeline pipeline = {MatrixStage{rgb_to_rgb(kRec2020, kRec709)}};
    const std::vector<float> in = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::vector<double> columns = {1.6605,  -0.1246, -0.0182, -0.5876, 1.1329,
                                         -0.1006, -0.0728, -0.0083, 1.1187};
    for (const Form& form : run_forms(pipeline, in)) {
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_NEAR(static_cast<double>(form.out[i]), columns[i], 6e-5)
                << form.name << ": half a unit of the fourth decimal";
        }
    }
}

TEST(LowerMatrix, NeighborsAreMultipliedInOrder) {
    const Matrix3 a = {{{1, 2, 0}, {0, 1, 3}, {4, 0, 1}}};
    const Matrix3 b = {{{0, 1, 0}, {5, 0, 1}, {1, 1, 1}}};
    const Pipeline pipeline = {MatrixStage{a}, MatrixStage{b}};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kMatrixType}));
    for (const Form& form : run_forms(pipeline, {1, 0, 0, 0, 1, 0}))
        EXPECT_EQ(form.out, (std::vector<float>{0, 9, 5, 1, 10, 3})) << "b a, " << form.name;
}

TEST(LowerMatrix, NoMatrixGivesNoOperation) {
    EXPECT_EQ(types_of(lower_to_ocio({})), Types{});
    EXPECT_EQ(types_of(lower_to_ocio({MatrixStage{kIdentity3}, curve_stage(kX)})), Types{});
}

TEST(LowerClamp, IsExact) {
    const std::vector<float> in = {-3, 0.25F, 0.3F, 1.5F, 1.5001F, 70000, -0.0F, 0, 0.2F};
    for (const Form& form : run_forms({ClampStage{0.25, 1.5}}, in)) {
        EXPECT_EQ(form.out,
                  (std::vector<float>{0.25F, 0.25F, 0.3F, 1.5F, 1.5F, 1.5F, 0.25F, 0.25F, 0.25F}))
            << form.name;
    }
    for (const Form& form : run_forms({ClampStage{0, kInfinity}}, in))
        EXPECT_EQ(form.out[5], 70000) << form.name << ": no upper end";
    for (const Form& form : run_forms({ClampStage{-kInfinity, 1}}, in)) {
        EXPECT_EQ(form.out[0], -3) << form.name << ": no lower end";
        EXPECT_EQ(form.out[5], 1) << form.name;
    }
}

TEST(LowerClamp, IsNeverBakedIntoATable) {
    // Hable reaches 1 at 5.6, between two half floats: baked in, the kink would cost 1.6e-5.
    const Lowered lowered = lower_to_ocio({kPositive, curve_stage(reinhard()), kSdr, srgb()});
    EXPECT_EQ(types_of(lowered), (Types{kRangeType, kLut1D, kRangeType, kLut1D}));
    expect_close(build_view(make_view(resolve_operator("hable"), "lin_rec709", 0, "srgb")),
                 positive_colors(), 3e-7, 1e-6);
    std::vector<float> around_white;
    for (int i = -3000; i <= 3000; ++i)
        around_white.insert(around_white.end(), 3, 5.6F + static_cast<float>(i) * 1e-6F);
    expect_close(build_view(make_view(resolve_operator("hable"), "lin_rec709", 0, "srgb")),
                 around_white, 3e-7, 1e-6);
}

TEST(LowerCurve, IsOneHalfDomainTable) {
    const Lowered lowered = lower_to_ocio({curve_stage(reinhard())});
    ASSERT_EQ(types_of(lowered), (Types{kLut1D}));
    EXPECT_TRUE(lowered.is_exact);
    EXPECT_TRUE(lut_at(lowered, 0).is_half_domain);
    EXPECT_EQ(lut_at(lowered, 0).size(), 65536);
    EXPECT_EQ(lut_at(lowered, 0).channels, 1);
}

TEST(LowerCurve, NeighborsAreFusedIntoOneTable) {
    // Each step alone would round to float between them; the order shows.
    const Pipeline pipeline = {kPositive, curve_stage(log2(kX + 1)), curve_stage(kX * 0.1),
                               curve_stage(reinhard()), srgb()};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kRangeType, kLut1D}));
    expect_close(pipeline, positive_colors(), 3e-7, 1e-6);
    // An identity between them does not part them, a clamp does.
    EXPECT_EQ(types_of(lower_to_ocio({curve_stage(reinhard()), MatrixStage{kIdentity3}, srgb()})),
              (Types{kLut1D}));
    EXPECT_EQ(types_of(lower_to_ocio({curve_stage(reinhard()), kSdr, srgb()})),
              (Types{kLut1D, kRangeType, kLut1D}));
}

TEST(LowerCurve, ChannelsKeepTheirCurves) {
    // Three curves before and after a shared one.
    const CurveStage before = {{kX, kX * 0.5, kX * 0.25}, std::nullopt};
    const CurveStage after = {{kX, 1 - kX, kX * kX}, std::nullopt};
    const Pipeline pipeline = {kPositive, before, curve_stage(reinhard()), after, srgb()};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kRangeType, kLut1D}));
    // 1 - x near black has the full slope of the sRGB curve, on floats near 1: 2^-24 * 12.92.
    expect_close(pipeline, positive_colors(), 8e-7, 1.5e-6);
    for (const Form& form : run_forms({before}, {4, 4, 4}))
        EXPECT_EQ(form.out, (std::vector<float>{4, 2, 1})) << form.name;
}

TEST(LowerCurve, TwoCurvesInOneProcessStayTwo) {
    // OCIO's processor cache tells in-memory tables apart by size and extreme values alone; these
    // two have them in common.
    const Expr x = clamp(kX, 0, 1);
    const std::vector<float> half = {0.5F, 0.5F, 0.5F};
    for (int round = 0; round < 2; ++round) {
        for (const Form& form : run_forms({curve_stage(x)}, half))
            EXPECT_EQ(form.out[0], 0.5F) << form.name << ", round " << round;
        for (const Form& form : run_forms({curve_stage(x * x)}, half))
            EXPECT_EQ(form.out[0], 0.25F) << form.name << ", round " << round;
    }
}

TEST(LowerCurve, TableIsFiniteWhereTheCurveIsNotDefined) {
    // The clamp before a curve ends its domain: what stands in the table beyond must not be NaN,
    // which an interpolation next to the end would take in.
    for (const Pipeline& pipeline :
         {Pipeline{ClampStage{0.1, 0.9}, curve_stage(log2(kX - 0.01) + sqrt(1 - kX))},
          Pipeline{ClampStage{0.5, kInfinity}, curve_stage(sqrt(kX - 0.4))},
          Pipeline{ClampStage{-kInfinity, -0.5}, curve_stage(sqrt(-kX))}}) {
        const Lowered lowered = lower_to_ocio(pipeline);
        const std::vector<float>& values = lut_at(lowered, 1).values;
        for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_TRUE(std::isfinite(values[i])) << i << "\n" << to_string(pipeline);
    }
}

TEST(LowerCurve, LogarithmBehindAClampIsSmoothAtItsEnds) {
    // AgX's log2 with its clamp in scene light, then straight to a code value.
    const double lo = -12.47393;
    const double hi = 4.026069;
    const Pipeline pipeline = {ClampStage{std::exp2(lo), std::exp2(hi)},
                               curve_stage((log2(kX) - lo) / (hi - lo))};
    std::vector<float> in = positive_colors();
    for (int i = -2000; i <= 2000; ++i) {
        in.insert(in.end(), 3, static_cast<float>(std::exp2(lo) * (1 + i * 1e-6)));
        in.insert(in.end(), 3, static_cast<float>(std::exp2(hi) * (1 + i * 1e-6)));
    }
    expect_close(pipeline, in, 3e-7, 1e-6);
}

TEST(LowerToneScale, OnLuminanceNeedsNo3dLut) {
    const Pipeline pipeline = {
        kPositive, ToneScaleStage{Norm::luminance, kRec709Weights, reinhard()}, kSdr, srgb()};
    expect_no_cube(pipeline);
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kRangeType, kMatrixType, kFixed, kLut1D,
                                                        kFixed, kMatrixType, kRangeType, kLut1D}));
    expect_close(pipeline, positive_colors(), 2e-5, 5e-5);
}

TEST(LowerToneScale, OnLuminanceUsesItsOwnWeights) {
    // AP1's: half as much green again as Rec.709's would put the result 0.05 off.
    const Vector3 ap1 = {0.2722287168, 0.6740817658, 0.0536895174};
    const Pipeline pipeline = {kPositive, ToneScaleStage{Norm::luminance, ap1, reinhard()}, kSdr,
                               srgb()};
    expect_no_cube(pipeline);
    expect_close(pipeline, positive_colors(), 2e-5, 5e-5);
    // By hand, Y of (0, 1, 0): 0.6740817658/(1 + 0.6740817658)/0.6740817658.
    const Pipeline linear = {kPositive, ToneScaleStage{Norm::luminance, ap1, reinhard()}};
    for (const Form& form : run_forms(linear, {0, 1, 0})) {
        EXPECT_NEAR(static_cast<double>(form.out[1]), 1 / 1.6740817658, 1e-6) << form.name;
        EXPECT_NEAR(static_cast<double>(form.out[0]), 0, 1e-6) << form.name;
    }
}

TEST(LowerToneScale, FixedFunctionWhereItEqualsOne) {
    // The OOTF of HLG, and the dim surround of ACES, both straight below a floor.
    const auto floored_power = [](double gain, double floor, double gamma) {
        return gain * kX * pow(max(kX, floor), gamma - 1);
    };
    const Vector3 rec2020 = {0.2627, 0.6780, 0.0593};
    const auto expect_fixed = [](const ToneScaleStage& stage, const Types& types) {
        const Pipeline pipeline = {kPositive, stage};
        expect_no_cube(pipeline);
        EXPECT_EQ(types_of(lower_to_ocio(pipeline)), types);
        expect_close({kPositive, stage, kSdr, srgb()}, positive_colors(), 1e-6, 5e-6);
    };
    expect_fixed({Norm::luminance, rec2020, floored_power(1, 1e-4, 1.2)}, {kRangeType, kFixed});
    expect_fixed({Norm::luminance, rec2020, floored_power(3, 2e-5, 1 / 1.2)},
                 {kRangeType, kMatrixType, kFixed, kMatrixType});
    expect_fixed({Norm::luminance, rgb_to_xyz(kAP1)[1], floored_power(1, 1e-10, 0.9811)},
                 {kRangeType, kFixed});
}

TEST(LowerToneScale, TableWhereAFixedFunctionDiffers) {
    const auto has_table = [](const ToneScaleStage& stage, double lo) {
        const Types types = types_of(lower_to_ocio({ClampStage{lo, kHalfMax}, stage}));
        return std::find(types.begin(), types.end(), kLut1D) != types.end();
    };
    const Vector3 rec2020 = {0.2627, 0.6780, 0.0593};
    const Expr power = kX * pow(max(kX, 1e-4), 0.2);
    EXPECT_FALSE(has_table({Norm::luminance, rec2020, power}, 0));
    EXPECT_TRUE(has_table({Norm::luminance, rec2020, power}, -1)) << "colors of no luminance";
    EXPECT_TRUE(has_table({Norm::luminance, kRec709Weights, power}, 0)) << "other weights";
    EXPECT_TRUE(has_table({Norm::max_rgb, rec2020, power}, 0)) << "another norm";
    EXPECT_TRUE(has_table({Norm::luminance, rec2020, pow(kX, 1.2)}, 0)) << "no floor";
    EXPECT_TRUE(has_table({Norm::luminance, rec2020, kX / (1 + kX)}, 0)) << "no power";
}

TEST(LowerToneScale, OnLuminanceOfRec2020IsAsExact) {
    // ITU-R BT.2020 table 4. Measured: 6.5e-6 on the CPU, 1.9e-5 in llvmpipe.
    const Vector3 weights = {0.2627, 0.6780, 0.0593};
    const Expr hable =
        (kX * (0.15 * kX + 0.05) + 0.004) / (kX * (0.15 * kX + 0.5) + 0.06) - 0.02 / 0.3;
    for (const Expr& f : {reinhard(), hable}) {
        const Pipeline pipeline = {kPositive, ToneScaleStage{Norm::luminance, weights, f}, kSdr,
                                   srgb()};
        expect_no_cube(pipeline);
        expect_close(pipeline, positive_colors(), 1e-5, 3e-5);
    }
}

TEST(LowerToneScale, OnTheLargestChannelNeedsNo3dLut) {
    const Pipeline pipeline = {kPositive, ToneScaleStage{Norm::max_rgb, {}, reinhard()}, kSdr,
                               srgb()};
    expect_no_cube(pipeline);
    expect_close(pipeline, positive_colors(), 2e-5, 5e-5);
    for (const Form& form : run_forms({kPositive, ToneScaleStage{Norm::max_rgb, {}, reinhard()}},
                                      {4, 1, 2, 1, 4, 2, 2, 1, 4})) {
        const std::vector<double> expected = {0.8, 0.2, 0.4, 0.2, 0.8, 0.4, 0.4, 0.2, 0.8};
        for (std::size_t i = 0; i < 9; ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), expected[i], 1e-6) << form.name;
    }
}

TEST(LowerToneScale, BlackStaysBlack) {
    for (const Norm norm : {Norm::luminance, Norm::max_rgb}) {
        const Pipeline pipeline = {kPositive, ToneScaleStage{norm, kRec709Weights, reinhard()},
                                   kSdr, srgb()};
        for (const Form& form : run_forms(pipeline, {0, 0, 0, -0.0F, 0, 0, -5, -1, -2})) {
            for (const float x : form.out)
                EXPECT_EQ(x, 0) << form.name;
        }
    }
}

TEST(LowerToneScale, NegativeChannelsUnderAPositiveLuminance) {
    // Without a clamp before it: a saturated color outside the gamut. The norm is positive, so the
    // negative channel is scaled like the others.
    const Pipeline pipeline = {ToneScaleStage{Norm::luminance, kRec709Weights, reinhard()}};
    const std::vector<float> in = {1, -0.2F, 0.1F, -0.5F, 2, 0.3F, 0.3F, 0.4F, -0.2F};
    const std::vector<double> truth = reference(pipeline, in);
    for (const Form& form : run_forms(pipeline, in)) {
        for (std::size_t i = 0; i < in.size(); ++i) {
            // xyY of a luminance that is a tenth of the largest channel: ten float roundings.
            EXPECT_NEAR(static_cast<double>(form.out[i]), truth[i], 5e-6) << form.name;
        }
    }
}

TEST(LowerToneScale, NegativeChannelsUnderAPositiveMaximumAreKeptOrRefused) {
    // OCIO's HSV has no negatives. A chain that cannot be lowered is an error, not another picture.
    const Pipeline pipeline = {ToneScaleStage{Norm::max_rgb, {}, reinhard()}};
    const std::vector<float> in = {1, -0.2F, 0.1F, -0.5F, 2, 0.3F, 0.3F, 0.4F, -0.2F};
    try {
        (void)lower_to_ocio(pipeline);
    } catch (const Error&) {
        return;
    }
    expect_close(pipeline, in, 5e-6, 5e-6);
}

TEST(LowerHuePreserving, IsOneTableWithHueAdjust) {
    const Lowered lowered =
        lower_to_ocio({kPositive, HuePreservingStage{reinhard()}, kSdr, srgb()});
    EXPECT_EQ(types_of(lowered), (Types{kRangeType, kLut1D, kRangeType, kLut1D}));
    EXPECT_TRUE(lowered.is_exact);
    EXPECT_TRUE(lut_at(lowered, 1).is_half_domain);
    EXPECT_TRUE(lut_at(lowered, 1).keeps_hue);
    EXPECT_FALSE(lut_at(lowered, 3).keeps_hue);
}

TEST(LowerHuePreserving, IsAsExactAsACurve) {
    const Expr hable =
        (kX * (0.15 * kX + 0.05) + 0.004) / (kX * (0.15 * kX + 0.5) + 0.06) - 0.02 / 0.3;
    for (const Expr& f : {reinhard(), hable, 1 - exp(-kX)}) {
        const Pipeline pipeline = {kPositive, HuePreservingStage{f}, kSdr, srgb()};
        expect_no_cube(pipeline);
        expect_close(pipeline, positive_colors(), 3e-7, 1e-6);
        expect_close(pipeline, saturated_colors(), 3e-7, 1e-6);
    }
}

TEST(LowerHuePreserving, KeepsThePlaceOfTheMiddleChannel) {
    // By hand: x^2 of (3, 1, 2) is (9, 1, 1 + 8/2), not (9, 1, 4).
    const Pipeline pipeline = {kPositive, HuePreservingStage{kX * kX}};
    for (const Form& form : run_forms(pipeline, {3, 1, 2, 1, 2, 3, 2, 3, 1, 2, 2, 2, 4, 4, 1})) {
        const std::vector<double> expected = {9, 1, 5, 1, 5, 9, 5, 9, 1, 4, 4, 4, 16, 16, 1};
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), expected[i], 3e-6) << form.name;
    }
}

TEST(LowerHuePreserving, FallingCurvesNeedA3dLut) {
    // OCIO's shader takes the smallest and the largest of what it looked up, not of what came in.
    const Pipeline pipeline = {kPositive, HuePreservingStage{1 / (1 + kX)}, kSdr, srgb()};
    LowerOptions options;
    options.cube_edge = 17;
    const Lowered lowered = lower_to_ocio(pipeline, options);
    EXPECT_FALSE(lowered.is_exact);
    const std::vector<float> in = {0.5F, 0.2F, 0.3F, 0.2F, 0.3F, 0.5F, 0.3F, 0.5F, 0.2F, 1, 1, 1};
    const std::vector<double> truth = reference(pipeline, in);
    for (const Form& form : run_forms(make_processor(lowered.ops), in)) {
        for (std::size_t i = 0; i < in.size(); ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), truth[i], 0.02) << form.name;
    }
}

TEST(LowerHuePreserving, IsTotal) {
    expect_sane({kPositive, HuePreservingStage{reinhard()}, kSdr, srgb()}, 1e-6);
}

TEST(LowerHuePreserving, NeedsAClampAtZeroBeforeIt) {
    const HuePreservingStage stage{reinhard()};
    EXPECT_THROW((void)lower_to_ocio({stage}), Error);
    EXPECT_THROW(
        (void)lower_to_ocio({kPositive, MatrixStage{rgb_to_rgb(kRec2020, kRec709)}, stage}), Error);
    EXPECT_NO_THROW((void)lower_to_ocio({ClampStage{0, kInfinity}, stage}));
}

TEST(LowerHuePreserving, IsNotFusedWithItsNeighbors) {
    const Pipeline pipeline = {kPositive, curve_stage(sqrt(kX + 0.1)), kPositive,
                               HuePreservingStage{reinhard()}, curve_stage(kX * kX)};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)),
              (Types{kRangeType, kLut1D, kRangeType, kLut1D, kLut1D}));
    expect_close(pipeline, positive_colors(), 6e-7, 3e-6);
}

TEST(LowerHuePreserving, SurvivesAFile) {
    // Configs hold tables as files, and of OCIO's formats only CTF knows hueAdjust.
    const Expr f = kX * (1 + kX / 16) / (1 + kX);
    const std::vector<float> values = sample_half_domain(f, 0, kHalfMax);
    ClfTable table;
    table.size = 65536;
    table.is_half_domain = true;
    table.is_hue_preserving = true;
    table.values = values;
    const Folder folder;
    const std::string path = folder / (std::string("hue") + file_extension(table));
    write(path, write_clf(table, "hue", {"a test"}));

    const OCIO::GroupTransformRcPtr group = to_ocio(lower_to_ocio({kPositive}).ops);
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    file->setInterpolation(OCIO::INTERP_LINEAR);
    group->appendTransform(file);
    const std::vector<float> in = positive_colors();
    const auto from_file = run_forms(make_processor(group), in);
    const auto from_memory = run_forms({kPositive, HuePreservingStage{f}}, in);
    for (std::size_t i = 0; i < from_file.size(); ++i)
        EXPECT_EQ(from_file[i].out, from_memory[i].out) << from_file[i].name << ": bit for bit";
}

/// NaN, infinities, the largest float, alone and together.
std::vector<float> special_colors() {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {2, 10});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.kind[i] != SampleKind::special) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

TEST(LowerView, NanAndInfinitiesAreSanitizedAsInTheEngines) {
    const std::vector<float> in = special_colors();
    ASSERT_GT(in.size(), 60U);
    for (const char* op : {"clamp", "hable", "reinhard:luminance", "reinhard:max", "agx_sobotka",
                           "aces_hill", "reinhard_jodie"}) {
        const Pipeline pipeline =
            build_view(make_view(resolve_operator(op), "lin_rec709", 0, "srgb"));
        const std::vector<double> truth = reference(pipeline, in);
        for (const Form& form : run_forms(pipeline, in)) {
            for (std::size_t i = 0; i < in.size(); ++i) {
                const std::string what = form.name + " " + op + " of (" +
                                         std::to_string(in[i / 3 * 3]) + ", " +
                                         std::to_string(in[i / 3 * 3 + 1]) + ", " +
                                         std::to_string(in[i / 3 * 3 + 2]) + ")";
                ASSERT_TRUE(form.out[i] >= -1e-6F && form.out[i] <= 1 + 1e-6F) << what;
                // The driver decides what NaN becomes in GLSL.
                if (form.is_gpu && std::any_of(&in[i / 3 * 3], &in[i / 3 * 3] + 3,
                                               [](float x) { return std::isnan(x); })) {
                    continue;
                }
                EXPECT_NEAR(static_cast<double>(form.out[i]), truth[i], 1.0 / 1023) << what;
            }
        }
    }
}

TEST(LowerView, SpecialColorsStayInRangeInOtherInputSpaces) {
    // The matrix comes first there, and spreads a NaN over the channels: the view stays a picture.
    const std::vector<float> in = special_colors();
    for (const char* op : {"clamp", "hable", "reinhard:luminance", "agx_sobotka"}) {
        const Pipeline pipeline = build_view(make_view(resolve_operator(op), "lin_ap1", 0, "srgb"));
        for (const Form& form : run_forms(pipeline, in)) {
            for (const float x : form.out)
                EXPECT_TRUE(x >= -1e-6F && x <= 1 + 1e-6F) << form.name << " " << op << ": " << x;
        }
    }
}

TEST(LowerView, PerChannelOperatorsKeepToTheCurveBound) {
    for (const Operator& op : all_operators()) {
        const Pipeline view =
            build_view(make_view(resolve_operator(op.id), "lin_rec709", 0, "srgb"));
        if (!is_per_channel(view)) continue;
        SCOPED_TRACE(op.id);
        // A bound that an operator declares is wider than the structure's, and has its reason.
        expect_close(view, mixed_colors(), std::max(3e-7, op.bounds.ocio_cpu),
                     std::max(1e-6, op.bounds.ocio_gpu));
    }
}

TEST(LowerView, ConvertedInputsAndDisplays) {
    // ACEScg in, Display P3 out, colors inside Rec.709: three matrices, no cancellation to speak
    // of.
    const Pipeline view =
        build_view(make_view(resolve_operator("hable"), "lin_ap1", -1, "display_p3"));
    std::vector<float> in;
    SampleRandom random(31);
    const Matrix3 to_ap1 = rgb_to_rgb(kRec709, kAP1);
    for (int i = 0; i < 20000; ++i) {
        const double light = std::exp2(random.uniform(-8, 6));
        Vector3 rec709{};
        for (double& x : rec709)
            x = light * random.uniform(0.1, 1);
        for (const double x : multiply(to_ap1, rec709))
            in.push_back(static_cast<float>(x));
    }
    // Three float roundings of the first matrix, whose rows' absolute values sum to 2.4, times the
    // steepest relative slope of Hable and sRGB, 1; and those of the tables.
    expect_close(view, in, 3 * 2.4 * 0x1p-24 + 3e-7, 3 * 2.4 * 0x1p-22 + 1e-6);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
