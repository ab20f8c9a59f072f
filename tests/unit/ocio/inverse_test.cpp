// SPDX-License-Identifier: Apache-2.0
//
// Inverse views: what OpenColorIO makes of display light is the scene light that it came from.
#include "ocio/inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "base/random.h"
#include "measure/error_metric.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct InverseCase {
    std::string op;
    double tolerance;  // of sRGB code values, 99.9 %
};

std::ostream& operator<<(std::ostream& out, const InverseCase& c) { return out << c.op; }

class InvertLight : public testing::TestWithParam<InverseCase> {};

TEST_P(InvertLight, RoundTripsTheLightOfAnSrgbDisplay) {
    const ResolvedOperator op = resolve_operator(GetParam().op);
    const DisplayLimit limit{kRec709, 1};
    const std::optional<LoweredOps> inverse = invert_light(op, limit);
    ASSERT_TRUE(inverse);
    Pipeline forward = op.build();
    const Pipeline light = display_light_stages(op, limit);
    forward.insert(forward.end(), light.begin(), light.end());
    forward.push_back(curve_stage(srgb_encode(Expr::input())));
    const ReferenceEngine view(forward);
    const ReferenceEngine decode({curve_stage(srgb_decode(Expr::input()))});
    const OcioCpu to_scene(make_processor(*inverse), OCIO::OPTIMIZATION_LOSSLESS);
    SampleRandom random(21);
    std::vector<double> errors;
    while (errors.size() < 2000) {
        // From 6 stops below 1 to 3 above it, up to 4:1 between the channels.
        const double exposure = std::exp2(random.uniform(-6, 3));
        Vector3 scene{};
        for (double& channel : scene)
            channel = exposure * std::exp2(random.uniform(-1, 1));
        const Vector3 code = view(scene);
        // At the ends, many scene colors look the same.
        if (std::any_of(code.begin(), code.end(), [](double v) { return v < 0.01 || v > 0.99; }))
            continue;
        const Vector3 shown = decode(code);
        std::array<float, 3> rgb{};
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] = static_cast<float>(shown[c]);
        to_scene.run_rgb(rgb.data(), rgb.data(), 1);
        const Vector3 again = view({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]),
                                    static_cast<double>(rgb[2])});
        double error = 0;
        for (std::size_t c = 0; c < 3; ++c)
            error = std::max(error, std::fabs(again[c] - code[c]));
        errors.push_back(error);
    }
    EXPECT_LT(summarise(errors).p999, GetParam().tolerance);
}

// Tables of a channel and matrices: interpolation between 16384 entries. ACES 2.0 is sampled, AgX
// fitted, at 37 and 33 nodes a side: a few codes of 8 bits, the README of the config has figures.
INSTANTIATE_TEST_SUITE_P(
    Operators, InvertLight,
    testing::Values(InverseCase{"hable", 1e-5}, InverseCase{"aces_narkowicz", 1e-4},
                    InverseCase{"agx_sobotka", 1e-3}, InverseCase{"uchimura", 1e-3},
                    InverseCase{"khronos_neutral", 1e-3}, InverseCase{"aces_13", 1e-2},
                    InverseCase{"aces_20", 0.02}, InverseCase{"agx_blender", 0.02}),
    [](const auto& test) { return test.param.op; });

}  // namespace
TONEWRIGHT_NAMESPACE_END
