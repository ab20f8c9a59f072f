// SPDX-License-Identifier: Apache-2.0
#include "ocio/inverse_cube.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/bounded_cache.h"
#include "base/number_cache.h"
#include "lut/fit_inverse.h"
#include "lut/fit_key.h"
#include "tonewright/color.h"
#include "tonewright/engine.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Brightest scene value, 14 stops above mid gray. All brighter values are shown as white.
constexpr double kBrightest = 4096;

/// Nodes a side, for a table of 0.9 MB; 25 have twice the mean error.
constexpr int kEdge = 37;
/// Nodes a side of a fitted one, for 0.6 MB; 37 have a fifth less error.
constexpr int kFittedEdge = 33;

/// Node value of a scene value: its logarithm, linear near 0, odd, 1 for the brightest value.
constexpr double kStraight = 0.01;
double largest_code() { return std::log2(kBrightest / kStraight + 1); }
Expr code_of(const Expr& x) {
    const Expr code = log2(abs(x) / kStraight + 1) / largest_code();
    return select(less(x, 0), -code, code);
}
Expr light_of(const Expr& code) {
    const Expr light = (exp2(abs(code) * largest_code()) - 1) * kStraight;
    return select(less(code, 0), -light, light);
}

/// Position on the axes: nearly perceptual, for SDR and HDR displays.
Expr place_of(const Expr& light, double peak) {
    if (peak <= 1) return pow(max(light, 0), 1 / 2.4);
    const Expr code = pq_encode_nits(Expr::input() * kUnitLuminance);
    const double black = evaluate(code, 0);
    return (pq_encode_nits(max(light, 0) * kUnitLuminance) - black) /
           (evaluate(code, peak) - black);
}
Expr light_at(const Expr& place, double peak) {
    if (peak <= 1) return pow(max(place, 0), 2.4);
    const Expr code = pq_encode_nits(Expr::input() * kUnitLuminance);
    const double black = evaluate(code, 0);
    return pq_decode_nits(black + place * (evaluate(code, peak) - black)) / kUnitLuminance;
}

}  // namespace

Pipeline sampled_inverse(const Pipeline& back, double peak) {
    const auto make_nodes = [back, peak] {
        const Expr x = Expr::input();
        Pipeline stages = {curve_stage(light_at(x, peak))};
        stages.insert(stages.end(), back.begin(), back.end());
        stages.push_back(ClampStage{-kBrightest, kBrightest});
        stages.push_back(curve_stage(code_of(x)));
        constexpr std::size_t n = kEdge;
        constexpr double step = 1.0 / (kEdge - 1);
        std::array<std::vector<double>, 3> planes;
        for (std::size_t i = 0; i < n * n * n; ++i) {
            const std::array<std::size_t, 3> node = {i / (n * n), i / n % n, i % n};
            for (std::size_t c = 0; c < 3; ++c)
                planes[c].push_back(static_cast<double>(node[c]) * step);
        }
        const std::array<double*, 3> at = {planes[0].data(), planes[1].data(), planes[2].data()};
        ReferenceEngine(stages).run({at[0], at[1], at[2]}, at, n * n * n);
        std::vector<double> nodes;
        for (std::size_t i = 0; i < n * n * n; ++i)
            nodes.insert(nodes.end(), {planes[0][i], planes[1][i], planes[2][i]});
        return nodes;
    };
    return {
        ClampStage{0, peak},
        GridStage{place_of(Expr::input(), peak), std::make_shared<const Grid>(kEdge, make_nodes)},
        curve_stage(light_of(Expr::input()))};
}

Pipeline fitted_inverse(const Pipeline& forward, const Primaries& primaries, double peak,
                        const std::string& cache_folder) {
    // Displays with the same gamut and peak share it.
    struct Key {
        std::array<Expr, 3> forward;  // equal expressions are the same node, as long as one lives
        Primaries primaries;
        double peak;

        bool operator==(const Key& b) const {
            return std::equal(forward.begin(), forward.end(), b.forward.begin(), same) &&
                   primaries == b.primaries && peak == b.peak;
        }
    };
    static BoundedCache<Key, Grid> cache(64);  // of 0.9 MB each
    const Expr x = Expr::input();
    const Expr place = place_of(x, peak);
    // Grid computes its nodes on demand.
    const auto cube = cache.get({compose(forward), primaries, peak}, [&] {
        const auto make_nodes = [=] {
            InverseCubeProblem problem;
            problem.edge = kFittedEdge;
            problem.place = place;
            problem.code = peak <= 1 ? srgb_encode(x) : place;
            problem.before = {ClampStage{0, kBrightest}, curve_stage(code_of(x))};
            problem.forward = {ClampStage{0, 1}, curve_stage(light_of(x))};
            problem.forward.insert(problem.forward.end(), forward.begin(), forward.end());
            problem.primaries = primaries;
            constexpr int kFitVersion = 3;  // another one where the fit makes other nodes
            const std::string key =
                fmt::format("inverse cube {}, {} nodes a side: {}, {}, {}, {}", kFitVersion,
                            problem.edge, key_of_numbers({peak}), key_of_primaries(primaries),
                            key_of_pipeline(problem.before), key_of_pipeline(problem.forward));
            std::vector<double> nodes = cached_numbers(cache_folder, "inverse_cube", key,
                                                       numbers_in(cube_number_count(problem.edge)),
                                                       [&] { return fit_inverse_cube(problem); });
            // No picture reaches values above the brightest one.
            for (double& code : nodes)
                code = std::clamp(code, -1.0, 1.0);
            return nodes;
        };
        return Grid(kFittedEdge, make_nodes);
    });
    return {ClampStage{0, peak}, GridStage{place, cube}, ClampStage{0, 1},
            curve_stage(light_of(x))};
}

TONEWRIGHT_NAMESPACE_END
