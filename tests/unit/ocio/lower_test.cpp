// SPDX-License-Identifier: Apache-2.0
//
// Every kind of stage as OpenColorIO transforms, run by OCIO itself (CPU with the lossless and the
// default optimiser, GPU where there is one), against the double reference. Bounds: DESIGN of the
// project, section 4, in code values of the display.
#include "ocio/lower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/error_metric.h"
#include "engine/probe.h"
#include "ocio/gpu.h"
#include "ocio/model.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"

namespace tonewright {
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
    return run_forms(make_processor(lower_to_ocio(pipeline)), in);
}

std::vector<double> reference(const Pipeline& pipeline, const std::vector<float>& in) {
    std::vector<double> out(in.size());
    ReferenceEngine(pipeline).run_rgb(in.data(), out.data(), in.size() / 3);
    return out;
}

/// Greys, lattices, saturated and dark colours; all channels >= 0 and finite.
std::vector<float> positive_colours() {
    const ProbeSet set = make_probes(find_input_space("lin_rec709"), {9, 20000});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (!set.is_non_negative(i)) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

/// The same with negative channels.
std::vector<float> mixed_colours() {
    const ProbeSet set = make_probes(find_input_space("lin_rec709"), {9, 20000});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.kind[i] == ProbeKind::special) continue;
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

std::vector<OCIO::TransformType> types_of(const Lowered& lowered) {
    std::vector<OCIO::TransformType> types;
    for (int i = 0; i < lowered.transform->getNumTransforms(); ++i)
        types.push_back(lowered.transform->getTransform(i)->getTransformType());
    return types;
}

using Types = std::vector<OCIO::TransformType>;
constexpr auto kMatrixType = OCIO::TRANSFORM_TYPE_MATRIX;
constexpr auto kRangeType = OCIO::TRANSFORM_TYPE_RANGE;
constexpr auto kLut1D = OCIO::TRANSFORM_TYPE_LUT1D;
constexpr auto kLut3D = OCIO::TRANSFORM_TYPE_LUT3D;
constexpr auto kFixed = OCIO::TRANSFORM_TYPE_FIXED_FUNCTION;

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
    const std::vector<float> in = mixed_colours();
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

TEST(LowerMatrix, NeighboursAreMultipliedInOrder) {
    const Matrix3 a = {{{1, 2, 0}, {0, 1, 3}, {4, 0, 1}}};
    const Matrix3 b = {{{0, 1, 0}, {5, 0, 1}, {1, 1, 1}}};
    const Pipeline pipeline = {MatrixStage{a}, MatrixStage{b}};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kMatrixType}));
    for (const Form& form : run_forms(pipeline, {1, 0, 0, 0, 1, 0}))
        EXPECT_EQ(form.out, (std::vector<float>{0, 9, 5, 1, 10, 3})) << "b a, " << form.name;
}

TEST(LowerMatrix, NothingIsNothing) {
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
                 positive_colours(), 3e-7, 1e-6);
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
    const auto lut =
        OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(lowered.transform->getTransform(0));
    EXPECT_TRUE(lut->getInputHalfDomain());
    EXPECT_EQ(lut->getLength(), 65536U);
}

TEST(LowerCurve, NeighboursAreFusedIntoOneTable) {
    // Each step alone would round to float between them; the order shows.
    const Pipeline pipeline = {kPositive, curve_stage(log2(kX + 1)), curve_stage(kX * 0.1),
                               curve_stage(reinhard()), srgb()};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kRangeType, kLut1D}));
    expect_close(pipeline, positive_colours(), 3e-7, 1e-6);
    // An identity between them does not part them, a clamp does.
    EXPECT_EQ(types_of(lower_to_ocio({curve_stage(reinhard()), MatrixStage{kIdentity3}, srgb()})),
              (Types{kLut1D}));
    EXPECT_EQ(types_of(lower_to_ocio({curve_stage(reinhard()), kSdr, srgb()})),
              (Types{kLut1D, kRangeType, kLut1D}));
}

TEST(LowerCurve, ChannelsKeepTheirOwn) {
    // Three curves before and after a shared one.
    const CurveStage before = {{kX, kX * 0.5, kX * 0.25}, std::nullopt};
    const CurveStage after = {{kX, 1 - kX, kX * kX}, std::nullopt};
    const Pipeline pipeline = {kPositive, before, curve_stage(reinhard()), after, srgb()};
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kRangeType, kLut1D}));
    // 1 - x near black has the full slope of the sRGB curve, on floats near 1: 2^-24 * 12.92.
    expect_close(pipeline, positive_colours(), 8e-7, 1.5e-6);
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
        const auto lut =
            OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(lowered.transform->getTransform(1));
        ASSERT_TRUE(lut);
        for (unsigned long i = 0; i < lut->getLength(); ++i) {
            float r = 0;
            float g = 0;
            float b = 0;
            lut->getValue(i, r, g, b);
            ASSERT_TRUE(std::isfinite(r) && std::isfinite(g) && std::isfinite(b))
                << i << "\n"
                << to_string(pipeline);
        }
    }
}

TEST(LowerCurve, LogarithmBehindAClampIsSmoothAtItsEnds) {
    // AgX's log2 with its clamp in scene light, then straight to a code value.
    const double lo = -12.47393;
    const double hi = 4.026069;
    const Pipeline pipeline = {ClampStage{std::exp2(lo), std::exp2(hi)},
                               curve_stage((log2(kX) - lo) / (hi - lo))};
    std::vector<float> in = positive_colours();
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
    for (const OCIO::TransformType type : types_of(lowered))
        EXPECT_NE(type, kLut3D) << lowered.summary;
    EXPECT_TRUE(lowered.is_exact) << lowered.summary;
}

TEST(LowerToneScale, OnLuminanceNeedsNoCube) {
    const Pipeline pipeline = {
        kPositive, ToneScaleStage{Norm::luminance, kRec709Weights, reinhard()}, kSdr, srgb()};
    expect_no_cube(pipeline);
    EXPECT_EQ(types_of(lower_to_ocio(pipeline)), (Types{kRangeType, kMatrixType, kFixed, kLut1D,
                                                        kFixed, kMatrixType, kRangeType, kLut1D}));
    expect_close(pipeline, positive_colours(), 2e-5, 5e-5);
}

TEST(LowerToneScale, OnLuminanceUsesItsOwnWeights) {
    // AP1's: half as much green again as Rec.709's would put the result 0.05 off.
    const Vector3 ap1 = {0.2722287168, 0.6740817658, 0.0536895174};
    const Pipeline pipeline = {kPositive, ToneScaleStage{Norm::luminance, ap1, reinhard()}, kSdr,
                               srgb()};
    expect_no_cube(pipeline);
    expect_close(pipeline, positive_colours(), 2e-5, 5e-5);
    // By hand, Y of (0, 1, 0): 0.6740817658/(1 + 0.6740817658)/0.6740817658.
    const Pipeline linear = {kPositive, ToneScaleStage{Norm::luminance, ap1, reinhard()}};
    for (const Form& form : run_forms(linear, {0, 1, 0})) {
        EXPECT_NEAR(static_cast<double>(form.out[1]), 1 / 1.6740817658, 1e-6) << form.name;
        EXPECT_NEAR(static_cast<double>(form.out[0]), 0, 1e-6) << form.name;
    }
}

TEST(LowerToneScale, OnTheLargestChannelNeedsNoCube) {
    const Pipeline pipeline = {kPositive, ToneScaleStage{Norm::max_rgb, {}, reinhard()}, kSdr,
                               srgb()};
    expect_no_cube(pipeline);
    expect_close(pipeline, positive_colours(), 2e-5, 5e-5);
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
    // Without a clamp before it: a saturated colour outside the gamut. The norm is positive, so the
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
// Map3

TEST(LowerMap3, IsAShaperAndACube) {
    const Pipeline pipeline =
        build_view(make_view(resolve_operator("reinhard_jodie"), "lin_rec709", 0, "srgb"));
    const Lowered lowered = lower_to_ocio(pipeline);
    EXPECT_FALSE(lowered.is_exact);
    const Types types = types_of(lowered);
    EXPECT_EQ(std::count(types.begin(), types.end(), kLut3D), 1) << lowered.summary;
    for (int i = 0; i < lowered.transform->getNumTransforms(); ++i) {
        const auto cube =
            OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(lowered.transform->getTransform(i));
        if (!cube) continue;
        EXPECT_EQ(cube->getGridSize(), 65U);
        EXPECT_EQ(cube->getInterpolation(), OCIO::INTERP_TETRAHEDRAL);
    }
    // 65^3 of a smooth operator: one code of 10 bits.
    expect_close(pipeline, positive_colours(), 1.0 / 1023, 1.0 / 1023);
    // 4 times the nodes, some 16 times less error: a cube of 17 must be clearly worse.
    const auto worst = [&](int edge) {
        LowerOptions options;
        options.cube_edge = edge;
        const std::vector<float> in = positive_colours();
        const std::vector<double> truth = reference(pipeline, in);
        std::vector<float> out(in.size());
        OcioCpu(make_processor(lower_to_ocio(pipeline, options)))
            .run_rgb(in.data(), out.data(), in.size() / 3);
        double error = 0;
        for (std::size_t i = 0; i < in.size(); ++i)
            error = std::max(error, std::fabs(static_cast<double>(out[i]) - truth[i]));
        return error;
    };
    EXPECT_GT(worst(17), 4 * worst(65)) << "the edge is read";
}

TEST(LowerMap3, AxesAreNotSwapped) {
    // Six saturated colours through a map that treats no two channels alike.
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const Map3Stage map = {{r / (1 + r + g), g / (1 + g + 0.5 * b), b / (1 + b + 0.25 * r)}};
    const Pipeline pipeline = {kPositive, map, kSdr, srgb()};
    expect_close(pipeline,
                 {1, 0.1F, 0.3F, 0.1F, 1, 0.3F, 0.1F, 0.3F, 1, 3, 2, 0.5F, 0.5F, 3, 2, 2, 0.5F, 3},
                 1.0 / 1023, 1.0 / 1023);
}

TEST(LowerMap3, NeedsAClampAtZeroBeforeIt) {
    const Expr r = Expr::input(0);
    const Map3Stage map = {{r, r, r}};
    EXPECT_THROW((void)lower_to_ocio({map}), Error);
    EXPECT_THROW((void)lower_to_ocio({kPositive, MatrixStage{rgb_to_rgb(kRec2020, kRec709)}, map}),
                 Error)
        << "a matrix may make negatives again";
    EXPECT_THROW((void)lower_to_ocio({ClampStage{-kInfinity, 1}, map}), Error);
    EXPECT_NO_THROW((void)lower_to_ocio({kPositive, map}));
}

TEST(LowerMap3, LightAboveThePeakIsKeptOrRefused) {
    // What comes out of a map may be above 1, as with `linear` output or for HDR displays.
    std::array<Expr, 3> f = {Expr::input(0), Expr::input(1), Expr::input(2)};
    for (Expr& c : f)
        c = 12 * c / (1 + c);
    const Pipeline pipeline = {kPositive, Map3Stage{f}};
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
std::vector<float> special_colours() {
    const ProbeSet set = make_probes(find_input_space("lin_rec709"), {2, 10});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.kind[i] != ProbeKind::special) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

TEST(LowerView, NanAndInfinitiesAreSanitisedAsInTheEngines) {
    const std::vector<float> in = special_colours();
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

TEST(LowerView, SpecialColoursStayInRangeInOtherInputSpaces) {
    // The matrix comes first there, and spreads a NaN over the channels: the view stays a picture.
    const std::vector<float> in = special_colours();
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
        expect_close(view, mixed_colours(), 3e-7, 1e-6);
    }
}

TEST(LowerView, ConvertedInputsAndDisplays) {
    // ACEScg in, Display P3 out, colours inside Rec.709: three matrices, no cancellation to speak
    // of.
    const Pipeline view =
        build_view(make_view(resolve_operator("hable"), "lin_ap1", -1, "display_p3"));
    std::vector<float> in;
    ProbeRandom random(31);
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

TEST(ConfigModel, NamesAreWhatHostsCanTake) {
    const ConfigModel model = make_config_model();
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

TEST(ConfigModel, HasEveryOperatorDisplayAndSpace) {
    const ConfigModel model = make_config_model();
    EXPECT_EQ(model.displays.size(), all_displays().size());
    ASSERT_EQ(model.views.size(), all_operators().size());
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
        EXPECT_TRUE(has_space(space.title)) << space.id;
        EXPECT_EQ(config_space_name(space.id), space.title);
    }
    for (const Display& display : all_displays())
        EXPECT_TRUE(has_space(display.title + kDisplaySuffix)) << display.id;
    for (const auto& [role, space] : model.roles)
        EXPECT_TRUE(has_space(space)) << role << " is " << space;
    for (const auto& [extension, space] : model.file_rules)
        EXPECT_TRUE(has_space(space)) << extension << " is " << space;
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
}  // namespace tonewright
