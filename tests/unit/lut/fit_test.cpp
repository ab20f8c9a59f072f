// SPDX-License-Identifier: Apache-2.0
#include "lut/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();

/// The cross-talk of an operator, with a code whose distances are seen.
CubeProblem problem_of(const char* name, int edge, double top, double peak) {
    const ResolvedOperator op = resolve_operator(name);
    CubeProblem problem;
    problem.edge = edge;
    problem.axis = make_log_axis(top, edge);
    problem.primaries = op.op->working;
    for (const Stage& stage : op.build()) {
        if (std::holds_alternative<CrossTalkStage>(stage)) problem.pipeline.push_back(stage);
    }
    EXPECT_EQ(problem.pipeline.size(), 1);
    problem.pipeline.push_back(curve_stage(srgb_encode(kX)));
    problem.lo = 0;
    problem.hi = evaluate(srgb_encode(kX), peak);
    return problem;
}

/// The cube as the readers of LUT files have it, red fastest.
Lut lut_of(const std::vector<double>& nodes, int edge) {
    Lut lut;
    lut.size = edge;
    const auto n = static_cast<std::size_t>(edge);
    for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t g = 0; g < n; ++g) {
            for (std::size_t r = 0; r < n; ++r) {
                for (std::size_t c = 0; c < 3; ++c) {
                    lut.values.push_back(static_cast<float>(nodes[3 * ((r * n + g) * n + b) + c]));
                }
            }
        }
    }
    return lut;
}

struct Errors {
    double mean = 0;
    double p999 = 0;
    double max = 0;
};

/// Errors of a 3D LUT in the shown colors.
Errors errors_of(const CubeProblem& problem, const std::vector<double>& nodes,
                 const std::vector<float>& rgb) {
    const Lut lut = lut_of(nodes, problem.edge);
    std::vector<double> truth(rgb.size());
    std::vector<double> place(rgb.size());
    ReferenceEngine(problem.pipeline).run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
    ReferenceEngine({curve_stage(problem.axis.place)})
        .run_rgb(rgb.data(), place.data(), rgb.size() / 3);
    std::vector<double> errors;
    Errors result;
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
        const Vector3 shown = interpolate(lut, {place[i], place[i + 1], place[i + 2]});
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            worst = std::max(worst, std::fabs(std::clamp(shown[c], problem.lo, problem.hi) -
                                              std::clamp(truth[i + c], problem.lo, problem.hi)));
        }
        errors.push_back(worst);
        result.mean += worst / static_cast<double>(rgb.size() / 3);
    }
    std::sort(errors.begin(), errors.end());
    result.p999 = errors[errors.size() * 999 / 1000];
    result.max = errors.back();
    return result;
}

/// Colors that no fit has seen: log-uniform inside Rec.709, a tenth with a channel at 0.
std::vector<float> unseen_colors(const CubeProblem& problem) {
    const Matrix3 m = rgb_to_rgb(kRec709, problem.primaries);
    SampleRandom random(424242);
    std::vector<float> rgb;
    for (std::size_t i = 0; i < 20000; ++i) {
        Vector3 color{};
        for (double& channel : color)
            channel = std::exp2(random.uniform(-10, std::log2(problem.axis.top)));
        if (i % 10 == 0) color[i / 10 % 3] = 0;
        for (const double channel : multiply(m, color))
            rgb.push_back(static_cast<float>(std::max(channel, 0.0)));
    }
    return rgb;
}

std::vector<float> grays(const CubeProblem& problem) {
    std::vector<float> rgb;
    for (int i = 0; i <= 4000; ++i) {
        const double gray = problem.axis.top * std::exp2((i - 4000) / 200.0);
        rgb.insert(rgb.end(), 3, static_cast<float>(gray));
    }
    return rgb;
}

void expect_better(const CubeProblem& problem, double mean_factor, double p999_factor) {
    const std::vector<double> sampled = sample_cube(problem);
    const std::vector<double> fitted = fit_cube(problem);
    ASSERT_EQ(fitted.size(), sampled.size());
    const std::vector<float> colors = unseen_colors(problem);
    const Errors before = errors_of(problem, sampled, colors);
    const Errors after = errors_of(problem, fitted, colors);
    EXPECT_LT(after.mean, before.mean / mean_factor);
    EXPECT_LT(after.p999, before.p999 / p999_factor);
    const Errors gray_before = errors_of(problem, sampled, grays(problem));
    const Errors gray_after = errors_of(problem, fitted, grays(problem));
    EXPECT_LT(gray_after.mean, gray_before.mean);
    EXPECT_LE(gray_after.max, gray_before.max);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(fitted[c], sampled[c]) << "black";
}

TEST(FitCube, IsBetterThanSampledOnUnseenColorsAndOnGrays) {
    expect_better(problem_of("gt7", 17, 128, 2.5), 1.6, 1.25);
    expect_better(problem_of("reinhard_jodie", 17, 128, 1), 1.6, 1.2);
}

TEST(FitCube, GraysStayAsNeutralAsTheOperatorMakesThem) {
    const CubeProblem problem = problem_of("reinhard_jodie", 9, 64, 1);
    const std::vector<double> nodes = fit_cube(problem);
    const auto n = static_cast<std::size_t>(problem.edge);
    for (std::size_t i = 0; i < n; ++i) {
        const double* gray = &nodes[3 * i * (n * n + n + 1)];
        EXPECT_NEAR(gray[0], gray[1], 1e-6);
        EXPECT_NEAR(gray[1], gray[2], 1e-6);
    }
}

TEST(FitCube, IsTheSameOnEveryRunAndForAnyNumberOfThreads) {
    const CubeProblem problem = problem_of("gt7", 9, 128, 2.5);
    const std::vector<double> once = fit_cube(problem, {.thread_count = 1});
    EXPECT_EQ(once, fit_cube(problem, {.thread_count = 1}));
    EXPECT_EQ(once, fit_cube(problem, {.thread_count = 2}));
    EXPECT_EQ(once, fit_cube(problem, {.thread_count = 5}));
}

TEST(FitCube, KeepsStraightLinesBetweenNodes) {
    CubeProblem problem;
    problem.edge = 9;
    problem.axis = make_log_axis(16, problem.edge);
    // Red carries more green than red: no neighbor is like another.
    problem.pipeline = {curve_stage(problem.axis.place),
                        MatrixStage{{{{0.25, 0.5, -0.125}, {1, 0, 0.25}, {-0.5, 0.125, 2}}}}};
    const std::vector<double> sampled = sample_cube(problem);
    const std::vector<double> fitted = fit_cube(problem);
    for (std::size_t i = 0; i < sampled.size(); ++i)
        ASSERT_NEAR(fitted[i], sampled[i], 2e-6) << i;
}

TEST(FitCube, SampledNodesAreThePipelineBlueFastest) {
    CubeProblem problem;
    problem.edge = 3;
    problem.axis = {kX / 2, kX * 2, 2};
    problem.pipeline = {MatrixStage{{{{1, 0, 0}, {0, 10, 0}, {0, 0, 100}}}}};
    const std::vector<double> nodes = sample_cube(problem);
    ASSERT_EQ(nodes.size(), 81);
    const double* node = &nodes[3 * ((2 * 3 + 0) * 3 + 1)];
    EXPECT_EQ(node[0], 2);
    EXPECT_EQ(node[1], 0);
    EXPECT_EQ(node[2], 100);
}

TEST(FitCube, WithoutSamplesOnlyGraysAreFitted) {
    const CubeProblem problem = problem_of("gt7", 5, 128, 2.5);
    const std::vector<double> sampled = sample_cube(problem);
    const std::vector<double> fitted = fit_cube(problem, {.samples_per_node = 0});
    for (std::size_t i = 0; i < sampled.size() / 3; ++i) {
        const bool is_gray = i % 31 == 0;
        for (std::size_t c = 0; c < 3 && !is_gray; ++c)
            EXPECT_NEAR(fitted[3 * i + c], sampled[3 * i + c], 1e-6);
    }
}

/// Colors that the display clips are not fitted at the cost of those that it shows.
TEST(FitCube, ClippedColorsDoNotCount) {
    CubeProblem problem;
    problem.edge = 9;
    problem.axis = make_log_axis(64, problem.edge);
    // Straight up to the display's peak, between two nodes, and steep above.
    constexpr double kPeak = 0.55;
    problem.pipeline = {curve_stage(problem.axis.place + 20 * max(problem.axis.place - kPeak, 0))};
    const std::vector<float> colors = unseen_colors(problem);
    const std::vector<double> for_all = fit_cube(problem);
    problem.lo = 0;
    problem.hi = kPeak;
    const std::vector<double> for_shown = fit_cube(problem);
    for (const std::vector<float>& shown : {colors, grays(problem)}) {
        EXPECT_LT(errors_of(problem, for_shown, shown).mean,
                  0.2 * errors_of(problem, for_all, shown).mean);
    }
}

TEST(LogAxis, RoundTrips) {
    for (const double share : {0.0, 0.125}) {
        const CubeAxis axis = make_log_axis(1024, 65, share);
        EXPECT_NEAR(evaluate(axis.place, 0.0), 0, 1e-15);
        EXPECT_NEAR(evaluate(axis.place, 1024), 1, 1e-15);
        EXPECT_EQ(axis.top, 1024);
        for (const double x : {0.0, 1e-4, 0.18, 1.0, 63.0, 64.0, 65.0, 1000.0})
            EXPECT_NEAR(evaluate(axis.light, evaluate(axis.place, x)), x, 1e-12 * (x + 1));
    }
}

TEST(LogAxis, LongerStepsBeginAtANode) {
    const CubeAxis axis = make_log_axis(1024, 65, 0.125);
    EXPECT_NEAR(64 * evaluate(axis.place, 64.0), 56, 1e-12);
    // Nothing is gained where there are no lights above, or steps would become shorter.
    EXPECT_EQ(evaluate(make_log_axis(50, 65, 0.125).place, 1.0),
              evaluate(make_log_axis(50, 65).place, 1.0));
    EXPECT_EQ(evaluate(make_log_axis(65, 65, 0.125).place, 1.0),
              evaluate(make_log_axis(65, 65).place, 1.0));
}

TEST(LogAxis, IsChosenForTheOperator) {
    const auto is_equal_steps = [](const Expr& curve) {
        CubeProblem problem;
        problem.edge = 17;
        problem.pipeline = {curve_stage(curve)};
        return choose_share_of_lights(problem, 4096) == 0;
    };
    EXPECT_FALSE(is_equal_steps(srgb_encode(kX / (1 + kX))));
    EXPECT_TRUE(is_equal_steps(sqrt(kX)));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
