// SPDX-License-Identifier: Apache-2.0
#include "ocio/cross_talk_cube.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/bounded_cache.h"
#include "base/number_cache.h"
#include "lut/fit.h"
#include "lut/fit_key.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Smallest power of two t such that limiting every channel to [0, t] moves no color of a ramp to
/// 65504 (grays, primaries and secondaries, saturated and not) by more than a quarter of a 10-bit
/// code: where the operator saturates, nodes beyond would be wasted.
/// @param codes  scene-linear -> stored code values, clamped like the stage after the 3D LUT
double saturation_point(const Pipeline& codes) {
    const ReferenceEngine engine(codes);
    const auto moved = [&](double top) {
        double worst = 0;
        for (int direction = 1; direction < 8; ++direction) {
            for (const double low : {0.0, 0.1, 0.5}) {
                for (double light = top; light <= kHalfMax; light *= 2) {
                    Vector3 v{};
                    Vector3 limited{};
                    for (std::size_t c = 0; c < 3; ++c) {
                        v[c] = (direction >> c & 1) ? light : low * light;
                        limited[c] = std::min(v[c], top);
                    }
                    const Vector3 a = engine(v);
                    const Vector3 b = engine(limited);
                    for (std::size_t c = 0; c < 3; ++c)
                        worst = std::max(worst, std::fabs(a[c] - b[c]));
                }
            }
        }
        return worst;
    };
    double top = 1;
    while (top < 65536 && moved(top) > 0.25 / 1023)
        top *= 2;
    return std::min(top, kHalfMax);
}

/// Smooth and signed: negatives follow the linear segment of sRGB's curve.
Expr node_code() { return srgb_encode(Expr::input()); }

ClampStage limited_to_halves(const ClampStage& clamp) {
    return {std::max(clamp.lo, -kHalfMax), std::min(clamp.hi, kHalfMax)};
}

/// Sets nodes to the limit if they and all nodes that they are interpolated with exceed it. The
/// clamp after the 3D LUT gives the same result, and the file has shorter numbers.
void hold_limits(std::vector<float>& nodes, int edge, float lo, float hi) {
    const auto n = static_cast<std::size_t>(edge);
    // Minimum and maximum of a node and its neighbors, axis by axis.
    std::vector<float> least = nodes;
    std::vector<float> most = nodes;
    for (const std::size_t step : {3 * n * n, 3 * n, std::size_t{3}}) {
        const std::vector<float> least_before = least;
        const std::vector<float> most_before = most;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const std::size_t place = i / step % n;
            if (place > 0) {
                least[i] = std::min(least[i], least_before[i - step]);
                most[i] = std::max(most[i], most_before[i - step]);
            }
            if (place + 1 < n) {
                least[i] = std::min(least[i], least_before[i + step]);
                most[i] = std::max(most[i], most_before[i + step]);
            }
        }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (most[i] <= lo) nodes[i] = lo;
        if (least[i] >= hi) nodes[i] = hi;
    }
}

struct Key {
    std::array<Expr, 3> codes;  // equal expressions are the same node, as long as one lives
    double lo, hi, top;
    CrossTalkCubeOptions options;

    friend bool operator==(const Key& a, const Key& b) {
        return std::equal(a.codes.begin(), a.codes.end(), b.codes.begin(), same) && a.lo == b.lo &&
               a.hi == b.hi && a.top == b.top && a.options.edge == b.options.edge &&
               a.options.primaries == b.options.primaries &&
               a.options.is_fitted == b.options.is_fitted;
    }
};

/// Version of fit_cube() and choose_share_of_lights(): change it if the nodes of the same problem
/// change.
constexpr int kFitVersion = 1;

/// Cache key of a fitted 3D LUT.
std::string key_of(const CubeProblem& problem, double top) {
    return fmt::format("cube {}, {} nodes a side: {}, {}, {}", kFitVersion, problem.edge,
                       key_of_numbers({problem.lo, problem.hi, top}),
                       key_of_primaries(problem.primaries), key_of_pipeline(problem.pipeline));
}

}  // namespace

double cross_talk_top(const CrossTalkStage& stage, const ClampStage& behind, double largest,
                      bool is_fitted) {
    Pipeline seen = {stage, curve_stage(node_code())};
    // A fitted 3D LUT is free where the display clips; in a sampled one the corners of the clip
    // would cause errors.
    if (is_fitted) seen.insert(seen.begin() + 1, limited_to_halves(behind));
    return std::min(saturation_point(seen), largest);
}

std::shared_ptr<const CrossTalkCube> cross_talk_cube(const CrossTalkStage& stage,
                                                     const ClampStage& behind, double top,
                                                     const CrossTalkCubeOptions& options) {
    // A 3D LUT with 65 nodes a side has 3.3 MB.
    static BoundedCache<Key, CrossTalkCube> cache(64);
    const ClampStage limit = limited_to_halves(behind);
    CubeProblem problem;
    problem.edge = options.edge;
    problem.pipeline = {stage, curve_stage(node_code())};
    problem.primaries = options.primaries;
    problem.lo = evaluate(node_code(), limit.lo);
    problem.hi = evaluate(node_code(), limit.hi);
    const Key key = {compose(problem.pipeline), problem.lo, problem.hi, top, options};
    return cache.get(key, [&] {
        std::vector<double> nodes;
        if (options.is_fitted) {
            // The code of the largest half float is far below it. The last number is a share of the
            // axis.
            const NumberCheck are_nodes =
                numbers_in(cube_number_count(problem.edge) + 1, -kHalfMax, kHalfMax);
            const auto is_usable = [&](const std::vector<double>& numbers) {
                return are_nodes(numbers) && numbers.back() >= 0 && numbers.back() < 1;
            };
            nodes =
                cached_numbers(options.cache_folder, "cube", key_of(problem, top), is_usable, [&] {
                    const double share = choose_share_of_lights(problem, top);
                    problem.axis = make_log_axis(top, problem.edge, share);
                    std::vector<double> numbers = fit_cube(problem);
                    numbers.push_back(share);
                    return numbers;
                });
            problem.axis = make_log_axis(top, problem.edge, nodes.back());
            nodes.pop_back();
        } else {
            problem.axis = make_log_axis(top, problem.edge);
            nodes = sample_cube(problem);
        }
        CrossTalkCube cube = {problem.axis.place, {nodes.begin(), nodes.end()}};
        hold_limits(cube.nodes, problem.edge, static_cast<float>(problem.lo),
                    static_cast<float>(problem.hi));
        return cube;
    });
}

TONEWRIGHT_NAMESPACE_END
