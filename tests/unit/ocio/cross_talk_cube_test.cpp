// SPDX-License-Identifier: Apache-2.0
//
// Every kind of stage as OpenColorIO transforms, run by OCIO itself (CPU with the lossless and the
// default optimizer, GPU if there is one), against the double reference. Bounds are in code values
// of the display.
#include "ocio/lower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "measure/sample_set.h"
#include "ocio/gpu.h"
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

constexpr auto kLut3D = Type::lut_3d;

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

}  // namespace
TONEWRIGHT_NAMESPACE_END
