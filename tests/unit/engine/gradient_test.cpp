// SPDX-License-Identifier: Apache-2.0
#include "engine/gradient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Evaluated {
    Vector3 value{};
    Matrix3 slope{};
};

/// Evaluates many colors at once, which cuts tiles at other places than one by one.
std::vector<Evaluated> evaluate_all(const Pipeline& pipeline, const std::vector<Vector3>& colors) {
    const std::size_t n = colors.size();
    std::array<std::vector<double>, 3> planes;
    std::array<std::array<std::vector<double>, 3>, 3> slope;
    std::array<std::array<double*, 3>, 3> at{};
    for (std::size_t c = 0; c < 3; ++c) {
        for (const Vector3& color : colors)
            planes[c].push_back(color[c]);
        for (std::size_t k = 0; k < 3; ++k) {
            slope[c][k].resize(n);
            at[c][k] = slope[c][k].data();
        }
    }
    const std::array<double*, 3> in = {planes[0].data(), planes[1].data(), planes[2].data()};
    GradientEngine(pipeline).run({in[0], in[1], in[2]}, in, at, n);
    std::vector<Evaluated> all(n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            all[i].value[c] = planes[c][i];
            for (std::size_t k = 0; k < 3; ++k)
                all[i].slope[c][k] = slope[c][k][i];
        }
    }
    return all;
}

/// Central differences of the reference; those of two steps tell whether a kink is near.
void expect_differences(const Pipeline& pipeline, const char* what) {
    SampleRandom random(3);
    std::vector<Vector3> colors;
    for (int i = 0; i < 1001; ++i)
        colors.push_back(
            {random.uniform(0.02, 1), random.uniform(0.02, 1), random.uniform(0.02, 1)});
    const std::vector<Evaluated> all = evaluate_all(pipeline, colors);
    const ReferenceEngine reference(pipeline);
    int compared = 0;
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const Vector3 value = reference(colors[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto difference = [&](double by) {
                Vector3 below = colors[i];
                Vector3 above = colors[i];
                below[k] -= by;
                above[k] += by;
                const Vector3 a = reference(below);
                const Vector3 b = reference(above);
                return Vector3{(b[0] - a[0]) / (2 * by), (b[1] - a[1]) / (2 * by),
                               (b[2] - a[2]) / (2 * by)};
            };
            const Vector3 far = difference(1e-4);
            const Vector3 near = difference(1e-5);
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_EQ(all[i].value[c], value[c]) << what << ", color " << i;
                const double bound = 1e-5 * std::max(1.0, std::fabs(near[c]));
                if (std::fabs(far[c] - near[c]) > bound) continue;
                ++compared;
                ASSERT_NEAR(all[i].slope[c][k], near[c], 10 * bound)
                    << what << ", color " << i << ", channel " << c << " by " << k;
            }
        }
    }
    EXPECT_GT(compared, 9 * 1001 / 2) << what;
}

TEST(GradientEngine, IsTheSlopeOfEveryOperation) {
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const auto check = [](const char* what, const Expr& x, const Expr& y, const Expr& z) {
        expect_differences({CrossTalkStage{{x, y, z}}}, what);
    };
    check("sums", r + g * 2, g - b, -r);
    check("products", r * g * b, r / g, (r + b) / (g + b * r));
    check("powers", pow(r, 2.2), pow(2.5, g), pow(r + 0.5, g * b));
    check("exponentials", exp2(r - 2 * b), log2(g + b), sqrt(r * b));
    check("limits", min(r, g) * b, max(r, 0.5) + g, abs(r - b));
    check("circles", sin(3 * r), cos(g * b), atan2(r, g - 0.5));
    check("choices", select(less(r, g), r * b, g), floor(4 * r) * g, select(less(b, 0.3), 2, b));
    auto table = std::make_shared<Table>();
    table->samples = {0, 0.5, 0.6, 2, 1};
    auto placed = std::make_shared<Table>(*table);
    placed->positions = {0.1, 0.2, 0.5, 0.7, 0.9};
    check("tables", lookup(table, r), lookup(placed, g * b), lookup(table, r + g));
    SampleRandom random(5);
    std::vector<double> nodes;
    for (int i = 0; i < 3 * 4 * 4 * 4; ++i)
        nodes.push_back(random.uniform(0, 1));
    const auto cube = std::make_shared<const Grid>(4, [&] { return nodes; });
    expect_differences({GridStage{sqrt(Expr::input()), cube}}, "grid");
}

TEST(GradientEngine, IsTheSlopeOfOperators) {
    for (const char* name : {"agx_blender", "hable", "khronos_neutral", "gt7", "aces_13"})
        expect_differences(resolve_operator(name).build(), name);
}

TEST(GradientEngine, IsFiniteWhereSlopesAreNot) {
    const Expr x = Expr::input();
    const Pipeline pipeline = {curve_stage(pow(x, 0.4) + sqrt(x) + log2(max(x, 1e-30)))};
    for (const Evaluated& e : evaluate_all(pipeline, {{0, 0, 0}, {1, 0, 1}})) {
        for (const auto& row : e.slope) {
            for (const double d : row)
                EXPECT_TRUE(std::isfinite(d));
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
