// SPDX-License-Identifier: Apache-2.0
#include "ocio/inverse_cube.h"

#include <cmath>
#include <memory>

#include "tonewright/color.h"
#include "tonewright/engine.h"
#include "tonewright/view.h"

namespace tonewright {
namespace {

/// Scene light that counts as the brightest: 14 stops over middle grey. What is shown as white
/// comes from all that is brighter.
constexpr double kBrightest = 4096;

/// Nodes a side, for a table of 0.9 MB: 25 are twice as far from the way back in the mean.
constexpr int kEdge = 37;

/// What a node holds of scene light: its logarithm, straight about 0, odd, 1 of the brightest.
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

/// Where light stands on the axes: nearly as the eye sees it, for either kind of display.
Expr place_of(const Expr& light, double peak) {
    if (peak <= 1) return pow(max(light, 0), 1 / 2.4);
    const double largest = evaluate(pq_encode_nits(Expr::input() * kReferenceWhite), peak);
    return pq_encode_nits(max(light, 0) * kReferenceWhite) / largest;
}
Expr light_at(const Expr& place, double peak) {
    if (peak <= 1) return pow(max(place, 0), 2.4);
    const double largest = evaluate(pq_encode_nits(Expr::input() * kReferenceWhite), peak);
    return pq_decode_nits(place * largest) / kReferenceWhite;
}

}  // namespace

Pipeline sampled_inverse(const Pipeline& back, double peak) {
    const auto make_nodes = [back, peak] {
        const Expr x = Expr::input();
        Pipeline stages = {curve_stage(light_at(x, peak))};
        stages.insert(stages.end(), back.begin(), back.end());
        stages.push_back(ClampStage{-kBrightest, kBrightest});
        stages.push_back(curve_stage(code_of(x)));
        const ReferenceEngine engine(stages);
        std::vector<double> nodes;
        const double step = 1.0 / (kEdge - 1);
        for (int r = 0; r < kEdge; ++r) {
            for (int g = 0; g < kEdge; ++g) {
                for (int b = 0; b < kEdge; ++b) {
                    const Vector3 v = engine({r * step, g * step, b * step});
                    nodes.insert(nodes.end(), v.begin(), v.end());
                }
            }
        }
        return nodes;
    };
    return {ClampStage{0, peak},
            LatticeStage{place_of(Expr::input(), peak),
                         std::make_shared<const Lattice>(kEdge, make_nodes)},
            curve_stage(light_of(Expr::input()))};
}

}  // namespace tonewright
