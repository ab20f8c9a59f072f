// SPDX-License-Identifier: Apache-2.0
//
// Every kind of stage as OpenColorIO transforms, run by OCIO itself (CPU with the lossless and the
// default optimizer, GPU if there is one), against the double reference. Bounds are in code values
// of the display.
#include "ocio/lower.h"
#include "base/random.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include "base/format_number.h"
#include "lut/clf.h"
#include "lut/half_domain.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "ocio/fixed_functions.h"
#include "ocio/gpu.h"
#include "ocio/model.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();
using Norm = ToneScaleStage::Norm;

const Stage kPositive = ClampStage{0, kHalfMax};
const Stage kSdr = ClampStage{0, 1};
Stage srgb() { return curve_stage(srgb_encode(kX)); }
Expr reinhard() { return kX / (1 + kX); }

/// One way in which OCIO can run a chain.
struct Form {
    std::string name;
    bool is_gpu = false;
    std::vector<float> out;
};

std::vector<Form> run_forms(const OCIO::ConstProcessorRcPtr& processor,
                            const std::vector<float>& in) {
    std::vector<Form> forms;
    const auto add = [&](const char* name, const auto& runner) {
        Form form{name, std::string(name) == "gpu", std::vector<float>(in.size())};
        runner.run_rgb(in.data(), form.out.data(), in.size() / 3);
        forms.push_back(std::move(form));
    };
    add("cpu lossless", OcioCpu(processor, OCIO::OPTIMIZATION_LOSSLESS));
    add("cpu default", OcioCpu(processor, OCIO::OPTIMIZATION_DEFAULT));
    if (OcioGpu::unavailable_reason().empty()) add("gpu", OcioGpu(processor));
    return forms;
}

std::vector<Form> run_forms(const Pipeline& pipeline, const std::vector<float>& in) {
    return run_forms(make_processor(lower_to_ocio(pipeline).ops), in);
}

std::vector<double> reference(const Pipeline& pipeline, const std::vector<float>& in) {
    std::vector<double> out(in.size());
    ReferenceEngine(pipeline).run_rgb(in.data(), out.data(), in.size() / 3);
    return out;
}

/// Grays, lattices, saturated and dark colors; all channels >= 0 and finite.
std::vector<float> positive_colors() {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {9, 20000});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (!set.is_non_negative(i)) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

/// The same with negative channels.
std::vector<float> mixed_colors() {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {9, 20000});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.kind[i] == SampleKind::special) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

/// Every form of the pipeline against the reference.
void expect_close(const Pipeline& pipeline, const std::vector<float>& in, double cpu_bound,
                  double gpu_bound) {
    const std::vector<double> truth = reference(pipeline, in);
    for (const Form& form : run_forms(pipeline, in)) {
        const double bound = form.is_gpu ? gpu_bound : cpu_bound;
        double worst = 0;
        std::size_t at = 0;
        for (std::size_t i = 0; i < in.size(); ++i) {
            const double error = std::fabs(static_cast<double>(form.out[i]) - truth[i]);
            if (error <= worst) continue;
            worst = std::isnan(error) ? kInfinity : error;
            at = i;
        }
        const float* rgb = &in[at / 3 * 3];
        EXPECT_LE(worst, bound) << form.name << " of (" << rgb[0] << ", " << rgb[1] << ", "
                                << rgb[2] << "): " << form.out[at] << ", expected "
                                << shortest(truth[at]) << "; " << worst / bound
                                << " times the bound\n"
                                << to_string(pipeline) << lower_to_ocio(pipeline).summary;
        ::testing::Test::RecordProperty(form.name, rounded_up(worst));
    }
}

enum class Type { matrix, range, lut_1d, lut_3d, fixed, builtin };
using Types = std::vector<Type>;

Types types_of(const Lowered& lowered) {
    Types types;
    for (const LoweredOp& op : lowered.ops)
        types.push_back(static_cast<Type>(op.op.index()));
    return types;
}

constexpr auto kMatrixType = Type::matrix;
constexpr auto kRangeType = Type::range;
constexpr auto kLut1D = Type::lut_1d;
constexpr auto kLut3D = Type::lut_3d;
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

// ---------------------------------------------------------------------------------------------
// Matrix

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

// ---------------------------------------------------------------------------------------------
// Clamp

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

// ---------------------------------------------------------------------------------------------
// Curves

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

// ---------------------------------------------------------------------------------------------
// Tone scales

void expect_no_cube(const Pipeline& pipeline) {
    const Lowered lowered = lower_to_ocio(pipeline);
    for (const Type type : types_of(lowered))
        EXPECT_TRUE(type != kLut3D) << lowered.summary;
    EXPECT_TRUE(lowered.is_exact) << lowered.summary;
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

// ---------------------------------------------------------------------------------------------
// Hue-preserving curves

/// Saturated colors of six hues and all orders of the channels, grays, black, and both ends.
std::vector<float> saturated_colors() {
    std::vector<float> rgb;
    for (const float light :
         {1e-7F, 1e-3F, 0.05F, 0.3F, 0.8F, 1.0F, 3.0F, 50.0F, 4000.0F, 65504.0F}) {
        for (const float low : {0.0F, 1e-6F, 0.01F, 0.5F, 0.999F, 1.0F}) {
            for (const float mid : {low, low + (1 - low) * 0.001F, (1 + low) / 2, 1.0F}) {
                const float v[3] = {light, light * low, light * mid};
                for (const int i : {0, 1, 2}) {
                    for (const int j : {1, 2})
                        rgb.insert(rgb.end(), {v[i], v[(i + j) % 3], v[(i + 2 * j) % 3]});
                }
            }
        }
    }
    rgb.insert(rgb.end(), {0, 0, 0, -0.0F, -0.0F, -0.0F, -1, -2, -3, -1, 0.5F, 2});
    return rgb;
}

/// NaN, infinities, the largest float: the same picture as the reference, and always a picture.
void expect_sane(const Pipeline& pipeline, double bound) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const float huge = std::numeric_limits<float>::max();
    std::vector<float> in;
    for (const float odd : {nan, inf, -inf, huge, -huge}) {
        for (const float other : {0.0F, 0.18F, 70000.0F, odd})
            in.insert(in.end(), {odd, 0.18F, other, other, odd, 0.18F, 0.18F, other, odd});
    }
    const std::vector<double> truth = reference(pipeline, in);
    for (const Form& form : run_forms(pipeline, in)) {
        for (std::size_t i = 0; i < in.size(); ++i) {
            const float* rgb = &in[i / 3 * 3];
            ASSERT_TRUE(form.out[i] >= -1e-6F && form.out[i] <= 1 + 1e-6F)
                << form.name << " of " << rgb[0] << ", " << rgb[1] << ", " << rgb[2];
            // What NaN becomes in GLSL is the driver's affair.
            if (form.is_gpu && std::any_of(rgb, rgb + 3, [](float x) { return std::isnan(x); }))
                continue;
            EXPECT_NEAR(static_cast<double>(form.out[i]), truth[i], bound)
                << form.name << " of " << rgb[0] << ", " << rgb[1] << ", " << rgb[2];
        }
    }
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
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() /
        ("tonewright-hue-" + std::to_string(::getpid()) + file_extension(table));
    std::ofstream(path) << write_clf(table, "hue", {"a test"});

    const OCIO::GroupTransformRcPtr group = to_ocio(lower_to_ocio({kPositive}).ops);
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    file->setInterpolation(OCIO::INTERP_LINEAR);
    group->appendTransform(file);
    const std::vector<float> in = positive_colors();
    const auto from_file = run_forms(make_processor(group), in);
    const auto from_memory = run_forms({kPositive, HuePreservingStage{f}}, in);
    std::filesystem::remove(path);
    for (std::size_t i = 0; i < from_file.size(); ++i)
        EXPECT_EQ(from_file[i].out, from_memory[i].out) << from_file[i].name << ": bit for bit";
}

/// What OpenColorIO makes of colors with a table from a file.
std::vector<float> through_file(const ClfTable& table, std::vector<float> rgb) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() /
        ("tonewright-table-" + std::to_string(::getpid()) + file_extension(table));
    std::ofstream(path) << write_clf(table, "table", {"a test"});
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    file->setInterpolation(table.dimension == 3 ? OCIO::INTERP_TETRAHEDRAL : OCIO::INTERP_LINEAR);
    OcioCpu(make_processor(file)).run_rgb(rgb.data(), rgb.data(), rgb.size() / 3);
    std::filesystem::remove(path);
    OCIO::ClearAllCaches();
    return rgb;
}

TEST(LutFileNumbers, AreReadBackByOpenColorIO) {
    const Expr f = kX / (1 + kX);
    std::vector<float> values = sample_half_domain(f, 0, 4);
    const std::vector<signed char> slack = unused_entries(values, 0, 4);
    std::vector<float> in;
    for (const float x : positive_colors())
        in.push_back(std::min(x, 4.0F));
    ClfTable table;
    table.size = 65536;
    table.is_half_domain = true;
    table.values = values;
    table.slack = slack;
    table.numbers = ClfTable::Numbers::compact;
    const std::string text = write_clf(table, "table", {});
    EXPECT_NE(text.find("<Matrix"), std::string::npos) << "of a power of two";
    for (const bool is_ctf : {false, true}) {
        table.is_ctf = is_ctf;
        const std::vector<float> out = through_file(table, in);
        for (std::size_t i = 0; i < in.size(); ++i) {
            const double x = static_cast<double>(in[i]);
            EXPECT_NEAR(static_cast<double>(out[i]), x / (1 + x), 2e-7) << x;
        }
    }
}

TEST(LutFileNumbers, WholeOnesOfACubeAreReadBack) {
    const std::vector<float> nodes = {0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1,
                                      1, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1};
    ClfTable table;
    table.dimension = 3;
    table.size = 2;
    table.channels = 3;
    table.values = nodes;
    table.numbers = ClfTable::Numbers::multiples;
    table.unit = 1e-4;
    EXPECT_NE(write_clf(table, "cube", {}).find("\n1e4 0 1e4\n"), std::string::npos);
    const std::vector<float> in = {0.25F, 0.5F, 1, 0, 0.125F, 0.75F};
    const std::vector<float> out = through_file(table, in);
    for (std::size_t i = 0; i < in.size(); ++i)
        EXPECT_NEAR(static_cast<double>(out[i]), static_cast<double>(in[i]), 2e-7);
}

// ---------------------------------------------------------------------------------------------
// Hexcone

/// Khronos PBR Neutral (pbrNeutral.glsl); `white` as Filament has it, mixing towards 1.
HexconeStage neutral(double start_compression, double desaturation, bool white) {
    const double start = start_compression - 0.04;
    const double d = 1 - start;
    const Expr q = max(kX, start);
    const Expr n = 1 - d * d / (q + d - start);
    const Expr g = 1 - 1 / (desaturation * (q - n) + 1);
    const Expr is_base = less(kX, start);
    return {.offset = select(less(kX, 0.08), kX - 6.25 * kX * kX, 0.04),
            .value = select(is_base, kX, white ? g + (1 - g) * n : n),
            .chroma = select(is_base, 1, (1 - g) * n / q)};
}

Pipeline shown(const HexconeStage& stage) { return {kPositive, stage, kSdr, srgb()}; }

TEST(LowerHexcone, PbrNeutralNeedsNo3dLut) {
    // On the whole sample set: CPU 7.3e-6, llvmpipe 1.7e-5.
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {});
    std::vector<float> in;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.is_non_negative(i))
            in.insert(in.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    for (const bool white : {false, true}) {
        expect_no_cube(shown(neutral(0.8, 0.15, white)));
        expect_close(shown(neutral(0.8, 0.15, white)), in, 1e-5, 3e-5);
        expect_close(shown(neutral(0.8, 0.15, white)), saturated_colors(), 1e-5, 3e-5);
    }
}

TEST(LowerHexcone, PbrNeutralByHand) {
    // pbrNeutral.glsl: (1, 0.5, 0.25) less 0.04 is (0.96, 0.46, 0.21); the peak 0.96 becomes
    // n = 1 - 0.0576/0.44; the rest is scaled by n/0.96 and mixed towards n.
    const double n = 1 - 0.0576 / 0.44;
    const double g = 1 - 1 / (0.15 * (0.96 - n) + 1);
    const auto mixed = [&](double c) { return c * n / 0.96 * (1 - g) + n * g; };
    // (0.02, 0.04, 0.06): the offset is 0.02 - 6.25 * 0.0004 = 0.0175.
    const std::vector<float> in = {1, 0.5F, 0.25F, 0.02F, 0.04F, 0.06F, 0.5F, 0.5F, 0.5F};
    const std::vector<double> expected = {n,      mixed(0.46), mixed(0.21), 0.0025, 0.0225,
                                          0.0425, 0.46,        0.46,        0.46};
    for (const Form& form : run_forms({kPositive, neutral(0.8, 0.15, false)}, in)) {
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), expected[i], form.is_gpu ? 3e-6 : 1e-6)
                << form.name;
    }
}

/// OpenColorIO inverts every transform: tables that fall, too, over positive and negative numbers.
TEST(LowerHexcone, PbrNeutralInverseByHand) {
    // The three colors above, from their light; and one whose peak is compressed, so that stops
    // are counted on both sides: (3, 0.5, 0.5) less 0.04 has the peak 2.96, which becomes
    // n = 1 - 0.0576/2.44.
    const double low = 1 - 0.0576 / 0.44;
    const double high = 1 - 0.0576 / 2.44;
    const auto mixed = [](double c, double peak, double n) {
        const double g = 1 - 1 / (0.15 * (peak - n) + 1);
        return c * n / peak * (1 - g) + n * g;
    };
    const std::vector<double> light = {low,
                                       mixed(0.46, 0.96, low),
                                       mixed(0.21, 0.96, low),
                                       high,
                                       mixed(0.46, 2.96, high),
                                       mixed(0.46, 2.96, high),
                                       0.0025,
                                       0.0225,
                                       0.0425};
    const std::vector<double> scene = {1, 0.5, 0.25, 3, 0.5, 0.5, 0.02, 0.04, 0.06};
    const std::vector<float> in(light.begin(), light.end());
    const LoweredOps back = inverse(lower_to_ocio({kPositive, neutral(0.8, 0.15, false)}).ops);
    for (const Form& form : run_forms(make_processor(back), in)) {
        // Without loss the tables' own precision, times the slope of the inverse, 2.44^2/0.0576 at
        // most; else OpenColorIO's resampling of the inverse at half floats.
        const double bound = form.name == "cpu lossless" ? 1e-4 : 2e-3;
        for (std::size_t i = 0; i < scene.size(); ++i)
            EXPECT_NEAR(static_cast<double>(form.out[i]), scene[i], bound * std::max(1.0, scene[i]))
                << form.name << " " << i;
    }
}

TEST(LowerHexcone, PbrNeutralWithAnyParameters) {
    for (const double start : {0.1, 0.99}) {
        for (const double desaturation : {0.0, 1.0})
            expect_close(shown(neutral(start, desaturation, false)), positive_colors(), 1e-5, 3e-5);
    }
}

TEST(LowerHexcone, GraysStayGray) {
    std::vector<float> in;
    for (int i = -1000; i <= 800; ++i)
        in.insert(in.end(), 3, std::exp2(static_cast<float>(i) / 50));
    in.insert(in.end(), {0, 0, 0, 65504, 65504, 65504, 1e6F, 1e6F, 1e6F});
    for (const bool white : {false, true}) {
        for (const Form& form : run_forms(shown(neutral(0.8, 0.15, white)), in)) {
            for (std::size_t i = 0; i < in.size(); i += 3) {
                EXPECT_EQ(form.out[i], form.out[i + 1]) << form.name << " " << in[i];
                EXPECT_EQ(form.out[i], form.out[i + 2]) << form.name << " " << in[i];
            }
        }
    }
    for (const Form& form : run_forms(shown(neutral(0.8, 0.15, false)), {0, 0, 0, -1, -2, -3})) {
        for (const float x : form.out)
            EXPECT_EQ(x, 0) << form.name << ": black";
    }
}

TEST(LowerHexcone, LosesChromaGainsChromaOrKeepsIt) {
    const Expr f = reinhard();
    const HexconeStage stages[] = {
        {0, f, 1 / (1 + kX)},                           // the largest channel's tone scale
        {0, f, max(0, 1 - kX) / (1 + kX)},              // gray from 1 on
        {0, f, 0},                                      // gray
        {0.3 * kX, f, 1 / (1 + kX) * (0.5 + 0.5 * f)},  // more chroma where it is brighter
        {0.3 * kX, f, select(less(kX, 0.5), 1, 0.5) / (1 + kX)},  // a step
        {kX / 2, 0.01 + f, 1 / (1 + kX)},                         // black is not 0
        {0, kX / (1 + kX * kX), 1 / (1 + kX * kX) * 0.75},        // value falls again
    };
    for (const HexconeStage& stage : stages) {
        SCOPED_TRACE(to_string(Pipeline{stage}));
        expect_no_cube(shown(stage));
        // Nothing here desaturates lights as the Neutrals do: the hue's float rounding is what max
        // RGB has, twice the bound of the Neutrals.
        expect_close(shown(stage), positive_colors(), 2e-5, 5e-5);
        expect_sane(shown(stage), 5e-5);
    }
}

TEST(LowerHexcone, LightAboveThePeakIsKept) {
    // `linear` output: values to 8, in float32's proportions.
    const HexconeStage stage{0, 8 * kX / (7 + kX), 8 / (7 + kX) * 0.9};
    expect_close({kPositive, stage}, positive_colors(), 8 * 1e-6, 8 * 3e-6);
}

TEST(LowerHexcone, ClampsBeforeItEndItsDomain) {
    // sqrt(3.3 - p) is not defined beyond.
    const HexconeStage stage{0, sqrt(3.3 - kX) * kX / 2, sqrt(3.3 - kX) / 4};
    const Pipeline pipeline = {ClampStage{0, 3.25}, stage, kSdr, srgb()};
    expect_close(pipeline, positive_colors(), 2e-5, 5e-5);
    const Lowered lowered = lower_to_ocio(pipeline);
    for (std::size_t i = 0; i < lowered.ops.size(); ++i) {
        const auto* lut = std::get_if<Lut1DOp>(&lowered.ops[i].op);
        if (!lut) continue;
        for (std::size_t j = 0; j < lut->values.size(); ++j)
            ASSERT_TRUE(std::isfinite(lut->values[j])) << "operation " << i << ", value " << j;
    }
}

TEST(LowerHexcone, IsTotal) {
    for (const bool white : {false, true})
        expect_sane(shown(neutral(0.8, 0.15, white)), 5e-5);
}

TEST(LowerHexcone, RefusesUnsupportedCurves) {
    const HexconeStage good = neutral(0.8, 0.15, false);
    EXPECT_THROW((void)lower_to_ocio({good}), Error) << "no clamp";
    EXPECT_THROW((void)lower_to_ocio({kPositive, MatrixStage{rgb_to_rgb(kRec2020, kRec709)}, good}),
                 Error);
    // Chroma beyond what value leaves room for: negative light.
    EXPECT_THROW((void)lower_to_ocio({kPositive, HexconeStage{0, reinhard(), 1}}), Error);
    EXPECT_THROW((void)lower_to_ocio({kPositive, HexconeStage{0, reinhard(), -0.1}}), Error);
    // Steps up and down: no monotone function is steeper than both.
    const Expr steps = select(less(kX, 0.5), 1, select(less(kX, 2), 0.5, 1));
    EXPECT_THROW((void)lower_to_ocio({kPositive, HexconeStage{0, kX, steps}}), Error);
}

// ---------------------------------------------------------------------------------------------
// Map3

TEST(LowerMap3, IsAShaperAndACube) {
    const Pipeline pipeline =
        build_view(make_view(resolve_operator("reinhard_jodie"), "lin_rec709", 0, "srgb"));
    const Lowered lowered = lower_to_ocio(pipeline);
    EXPECT_FALSE(lowered.is_exact);
    const Types types = types_of(lowered);
    EXPECT_EQ(std::count(types.begin(), types.end(), kLut3D), 1) << lowered.summary;
    for (const LoweredOp& op : lowered.ops) {
        const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(to_ocio(op));
        if (!cube) continue;
        EXPECT_EQ(cube->getGridSize(), 65U);
        EXPECT_EQ(cube->getInterpolation(), OCIO::INTERP_TETRAHEDRAL);
    }
    // 65^3 of a smooth operator: one code of 10 bits.
    expect_close(pipeline, positive_colors(), 1.0 / 1023, 1.0 / 1023);
    // 4 times the nodes, some 16 times less error: a cube of 17 must be clearly worse.
    const auto worst = [&](int edge) {
        LowerOptions options;
        options.cube_edge = edge;
        const std::vector<float> in = positive_colors();
        const std::vector<double> truth = reference(pipeline, in);
        std::vector<float> out(in.size());
        OcioCpu(make_processor(lower_to_ocio(pipeline, options).ops))
            .run_rgb(in.data(), out.data(), in.size() / 3);
        double error = 0;
        for (std::size_t i = 0; i < in.size(); ++i)
            error = std::max(error, std::fabs(static_cast<double>(out[i]) - truth[i]));
        return error;
    };
    EXPECT_GT(worst(17), 4 * worst(65)) << "the edge is read";
}

TEST(LowerMap3, AxesAreNotSwapped) {
    // Six saturated colors through a map that treats no two channels alike.
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const CrossTalkStage map = {{r / (1 + r + g), g / (1 + g + 0.5 * b), b / (1 + b + 0.25 * r)}};
    const Pipeline pipeline = {kPositive, map, kSdr, srgb()};
    expect_close(pipeline,
                 {1, 0.1F, 0.3F, 0.1F, 1, 0.3F, 0.1F, 0.3F, 1, 3, 2, 0.5F, 0.5F, 3, 2, 2, 0.5F, 3},
                 1.0 / 1023, 1.0 / 1023);
}

TEST(LowerMap3, SaysWhenACubeLosesNegatives) {
    const Expr r = Expr::input(0);
    const CrossTalkStage map = {{r, r, r}};
    EXPECT_TRUE(lower_to_ocio({map}).loses_negatives);
    EXPECT_TRUE(
        lower_to_ocio({kPositive, MatrixStage{rgb_to_rgb(kRec2020, kRec709)}, map}).loses_negatives)
        << "a matrix may make negatives again";
    EXPECT_TRUE(lower_to_ocio({ClampStage{-kInfinity, 1}, map}).loses_negatives);
    EXPECT_FALSE(lower_to_ocio({kPositive, map}).loses_negatives);
}

TEST(LowerMap3, LightAboveThePeakIsKeptOrRefused) {
    // What comes out of a map may be above 1, as with `linear` output or for HDR displays.
    std::array<Expr, 3> f = {Expr::input(0), Expr::input(1), Expr::input(2)};
    for (Expr& c : f)
        c = 12 * c / (1 + c);
    const Pipeline pipeline = {kPositive, CrossTalkStage{f}};
    const std::vector<float> in = {0.25F, 0.25F, 0.25F, 1, 1, 1, 3, 3, 3, 9, 0.5F, 0.1F};
    try {
        (void)lower_to_ocio(pipeline);
    } catch (const Error&) {
        return;
    }
    // Half a percent of the largest: five codes of ten bits.
    expect_close(pipeline, in, 0.005 * 12, 0.005 * 12);
}

// ---------------------------------------------------------------------------------------------
// Whole views

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
                // What NaN becomes in GLSL is the driver's affair.
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
        // What an operator declares is wider than the structure's bound, and has its reason.
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

// ---------------------------------------------------------------------------------------------
// The config's model

std::string lower(std::string text) {
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return text;
}

TEST(ConfigModel, NamesFitApplications) {
    const ConfigModel model = make_config_model({.views = {"all"}});
    std::set<std::string> taken;
    const auto claim = [&](const std::string& name) {
        EXPECT_LE(name.size(), 63U) << name << ": Blender cuts it";
        EXPECT_TRUE(taken.insert(lower(name)).second) << name << " twice: OCIO ignores case";
        for (const char c : name)
            EXPECT_TRUE(c >= 32 && c < 127) << name;
    };
    for (const auto& [role, space] : model.roles)
        claim(role);
    for (const ConfigModel::Space& space : model.spaces) {
        claim(space.name);
        for (const std::string& alias : space.aliases)
            claim(alias);
        EXPECT_FALSE(space.description.empty()) << space.name;
    }
    std::set<std::string> views = {lower(kUntonemappedView), lower(kRawView)};
    for (const ConfigModel::View& view : model.views) {
        EXPECT_LE(view.name.size(), 63U) << view.name;
        EXPECT_TRUE(views.insert(lower(view.name)).second) << view.name;
    }
}

TEST(ConfigModel, StandardViewsBeginWithAgxAndEndWithRaw) {
    const ConfigModel model = make_config_model();
    ASSERT_GE(model.views.size(), 12U);
    // Blender's names.
    EXPECT_EQ(model.views[0].name, "AgX");
    EXPECT_EQ(model.views[1].name, "AgX Punchy");
    for (const char* name :
         {"ACES 1.3", "ACES 2.0", "Khronos PBR Neutral", "False Color", "Standard"}) {
        EXPECT_TRUE(std::any_of(model.views.begin(), model.views.end(), [&](const auto& v) {
            return v.name == name;
        })) << name;
    }
    ASSERT_FALSE(model.looks.empty());
    EXPECT_TRUE(std::any_of(model.looks.begin(), model.looks.end(),
                            [](const auto& look) { return look.name == "AgX - Punchy"; }));
}

TEST(ConfigModel, ALookBeforeTheOperatorIsTheOperatorWithTheLook) {
    const ConfigModel model = make_config_model();
    for (const ConfigModel::Look& look : model.looks) {
        SCOPED_TRACE(look.name);
        const auto found = std::find_if(
            look.op->looks.begin(), look.op->looks.end(),
            [&](const Look& l) { return look.name == look.op->view + " - " + l.title; });
        ASSERT_NE(found, look.op->looks.end());
        Pipeline both = look.stages;
        const Pipeline plain = resolve_operator(look.op->id).build();
        both.insert(both.end(), plain.begin(), plain.end());
        const ReferenceEngine apart(both);
        const ReferenceEngine whole(resolve_operator(look.op->id, {}, found->id).build());
        for (const Vector3& v : {Vector3{0.18, 0.18, 0.18}, Vector3{4, 0.1, -0.02},
                                 Vector3{0.001, 0.5, 30}, Vector3{0, 0, 0}})
            EXPECT_EQ(apart(v), whole(v));
    }
}

TEST(ConfigModel, ViewsAreChosenByNameOperatorAndPreset) {
    const ConfigModel model =
        make_config_model({.views = {"hable", "agx punchy", "reinhard:luminance"},
                           .displays = {"rec1886"},
                           .looks = {"AgX - Greyscale"},
                           .working = "lin_ap1",
                           .custom = {{"Studio", resolve_operator("reinhard_extended:white=6")}},
                           .exposure_stops = {-1}});
    std::vector<std::string> names;
    for (const auto& view : model.views)
        names.push_back(view.name);
    const std::string luminance = names.at(2);
    EXPECT_TRUE(luminance.starts_with("Reinhard ")) << luminance;
    EXPECT_EQ(names, (std::vector<std::string>{"Hable", "AgX Punchy", luminance, "Studio",
                                               "Hable -1 stop", "AgX Punchy -1 stop",
                                               luminance + " -1 stop", "Studio -1 stop"}));
    EXPECT_EQ(model.views[3].op.params.number("white"), 6);
    ASSERT_EQ(model.displays.size(), 1U);
    EXPECT_EQ(model.displays[0]->id, "rec1886");
    ASSERT_EQ(model.looks.size(), 1U);
    EXPECT_EQ(model.default_space, "ACEScg");
    EXPECT_THROW((void)make_config_model({.views = {"AgY"}}), Error);
    EXPECT_THROW((void)make_config_model({.looks = {"AgX - Funky"}}), Error);
    EXPECT_THROW((void)make_config_model({.displays = {"crt"}}), Error);
    EXPECT_THROW((void)make_config_model({.custom = {{"Hable", resolve_operator("reinhard")}}}),
                 Error)
        << "a name twice";
    EXPECT_THROW((void)make_config_model({.custom = {{"Raw", resolve_operator("reinhard")}}}),
                 Error)
        << "ours";
}

TEST(ConfigModel, HasEveryOperatorDisplayAndSpace) {
    const ConfigModel model = make_config_model({.views = {"all"}});
    EXPECT_EQ(model.displays.size(), all_displays().size());
    for (const Operator& op : all_operators()) {
        EXPECT_EQ(std::count_if(model.views.begin(), model.views.end(),
                                [&](const auto& v) { return v.op.op == &op && v.name == op.view; }),
                  1)
            << op.id;
    }
    const auto has_space = [&](const std::string& name) {
        return std::any_of(model.spaces.begin(), model.spaces.end(),
                           [&](const auto& s) { return s.name == name; });
    };
    for (const InputSpace& space : all_input_spaces()) {
        EXPECT_EQ(has_space(space.title), !space.is_camera) << space.id;
        EXPECT_EQ(config_space_name(space.id), space.title);
    }
    for (const Display& display : all_displays())
        EXPECT_TRUE(has_space(display.title)) << display.id;
    for (const auto& [role, space] : model.roles)
        EXPECT_TRUE(has_space(space)) << role << " is " << space;
    for (const auto& rule : model.file_rules)
        EXPECT_TRUE(has_space(rule.space)) << rule.name << " is " << rule.space;
    EXPECT_TRUE(has_space(model.default_space));
    // Roles that OCIO or applications do not start without.
    for (const char* role : {"scene_linear", "aces_interchange", "cie_xyz_d65_interchange", "data",
                             "color_picking", "texture_paint", "default_byte", "default_float"}) {
        EXPECT_TRUE(std::any_of(model.roles.begin(), model.roles.end(), [&](const auto& r) {
            return r.first == role;
        })) << role;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
