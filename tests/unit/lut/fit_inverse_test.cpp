// SPDX-License-Identifier: Apache-2.0
#include "lut/fit_inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();
constexpr int kEdge = 13;

/// Light is the scene desaturated; nodes hold the scene's square root. So the inverse is known:
/// the root of the matrix's inverse, steep where a channel of the scene is near 0, next to lights
/// that no scene makes.
const Matrix3 kDesaturate = {{{0.4, 0.35, 0.25}, {0.25, 0.5, 0.25}, {0.25, 0.35, 0.4}}};

InverseCubeProblem desaturation() {
    InverseCubeProblem problem;
    problem.edge = kEdge;
    problem.place = pow(max(kX, 0), 0.5);
    problem.code = problem.place;
    problem.before = {ClampStage{0, 1}, curve_stage(pow(kX, 0.5))};
    problem.forward = {ClampStage{0, 1}, curve_stage(kX * kX), MatrixStage{kDesaturate}};
    return problem;
}

struct Errors {
    double rms = 0;
    double max = 0;
};

/// Errors of codes that scenes make, after the 3D LUT and the view again.
Errors errors_of(const InverseCubeProblem& problem, const std::vector<double>& nodes) {
    const Grid cube(problem.edge, [&] { return nodes; });
    const ReferenceEngine before(problem.before);
    const ReferenceEngine forward(problem.forward);
    const ReferenceEngine place({curve_stage(problem.place)});
    const ReferenceEngine encode({curve_stage(problem.code)});
    // Other colors than those of the fit, log-uniform as lights of a scene are.
    SampleRandom random(77);
    constexpr int kCount = 20000;
    Errors errors;
    for (int i = 0; i < kCount; ++i) {
        Vector3 scene{};
        for (double& channel : scene)
            channel = std::exp2(random.uniform(-10, 2));
        const Vector3 light = forward(before(scene));
        const Vector3 at = place(light);
        const auto held = cube(at[0], at[1], at[2]);
        const Vector3 wanted = encode(light);
        const Vector3 shown = encode(forward({held[0], held[1], held[2]}));
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::fabs(shown[c] - wanted[c]);
            errors.rms += error * error;
            errors.max = std::max(errors.max, error);
        }
    }
    errors.rms = std::sqrt(errors.rms / (3 * kCount));
    return errors;
}

/// The exact inverse at the nodes; 0 where no scene makes such light.
std::vector<double> sampled(const InverseCubeProblem& problem) {
    const ReferenceEngine back({curve_stage(kX * kX), MatrixStage{inverse(kDesaturate)},
                                curve_stage(pow(max(kX, 0), 0.5))});
    std::vector<double> nodes;
    const double step = 1.0 / (problem.edge - 1);
    for (int r = 0; r < problem.edge; ++r) {
        for (int g = 0; g < problem.edge; ++g) {
            for (int b = 0; b < problem.edge; ++b) {
                const Vector3 v = back({r * step, g * step, b * step});
                nodes.insert(nodes.end(), v.begin(), v.end());
            }
        }
    }
    return nodes;
}

TEST(FitInverse, IsNearerThanTheSampledInverse) {
    const InverseCubeProblem problem = desaturation();
    const Errors fitted = errors_of(problem, fit_inverse_cube(problem));
    const Errors plain = errors_of(problem, sampled(problem));
    EXPECT_LT(fitted.max, 0.03) << "a third of a cell of the axes";
    EXPECT_LT(fitted.max, plain.max);
    EXPECT_LT(fitted.rms, 0.75 * plain.rms) << "what is gained here; at 33 nodes of AgX far more";
}

TEST(FitInverse, BlackComesBackAsBlack) {
    const std::vector<double> nodes = fit_inverse_cube(desaturation());
    ASSERT_EQ(nodes.size(), 3U * kEdge * kEdge * kEdge);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(nodes[c], 0) << c;
}

TEST(FitInverse, NodesThatNoLightReachesAreFinite) {
    // (1, 0, 0) needs a scene with negative channels.
    for (const double x : fit_inverse_cube(desaturation())) {
        ASSERT_TRUE(std::isfinite(x));
        ASSERT_LT(std::fabs(x), 4) << "goes on evenly from [0, 1]";
    }
}

TEST(FitInverse, IsTheSameOnEveryRun) {
    EXPECT_EQ(fit_inverse_cube(desaturation()), fit_inverse_cube(desaturation()));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
