// SPDX-License-Identifier: Apache-2.0
#include "plot/gray_curve.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Vector3 luminance_weights(const Primaries& primaries) {
    return primaries == kRec709 ? kRec709Weights : rgb_to_xyz(primaries)[1];
}

/// The view, followed by the code value of the gray with the same luminance; a neutral color keeps
/// its own.
Pipeline with_gray_level(const View& view) {
    const Display& display = find_display(view.display);
    const Vector3 weights = luminance_weights(display.primaries);
    Pipeline stages = build_view(view);
    stages.insert(stages.end(), display.decode.begin(), display.decode.end());
    stages.push_back(MatrixStage{{weights, weights, weights}});
    stages.insert(stages.end(), display.encode.begin(), display.encode.end());
    return stages;
}

}  // namespace

Planes codes_of(const Pipeline& pipeline, const Vector3& color, std::span<const double> exposures) {
    Planes planes;
    for (std::size_t c = 0; c < 3; ++c) {
        for (const double e : exposures)
            planes[c].push_back(color[c] * e);
    }
    const std::array<double*, 3> p = {planes[0].data(), planes[1].data(), planes[2].data()};
    ReferenceEngine(pipeline).run({p[0], p[1], p[2]}, p, exposures.size());
    return planes;
}

std::vector<double> gray_codes(const View& view, std::span<const double> scene) {
    return codes_of(with_gray_level(view), {1, 1, 1}, scene)[0];
}

double gray_code(const View& view, double scene) { return gray_codes(view, {{scene}})[0]; }

std::vector<double> scene_of(const std::vector<double>& stops) {
    std::vector<double> scene;
    scene.reserve(stops.size());
    for (const double s : stops)
        scene.push_back(kMidGray * std::exp2(s));
    return scene;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::fabs(a[i] - b[i]));
    return largest;
}

void add_line(std::vector<PlotLine>& lines, PlotLine line, const std::string& short_name) {
    for (PlotLine& other : lines) {
        if (largest_difference(other.values, line.values) < kSameLine) {
            other.label += ", " + short_name;
            return;
        }
    }
    lines.push_back(std::move(line));
}

TONEWRIGHT_NAMESPACE_END
