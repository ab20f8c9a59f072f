// SPDX-License-Identifier: Apache-2.0
#include "measure/error_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

ErrorStats summarise(std::span<const double> errors) {
    ErrorStats stats;
    stats.count = errors.size();
    if (errors.empty()) return stats;
    std::vector<double> sorted(errors.begin(), errors.end());
    for (double& e : sorted) {
        if (std::isnan(e)) e = std::numeric_limits<double>::infinity();
    }
    stats.worst =
        static_cast<std::size_t>(std::max_element(sorted.begin(), sorted.end()) - sorted.begin());
    stats.max = sorted[stats.worst];
    for (const double e : sorted)
        stats.mean += e;
    stats.mean /= static_cast<double>(sorted.size());
    const auto rank = static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    stats.p999 = sorted[static_cast<std::size_t>(rank)];
    return stats;
}

double channel_error(const double* truth, const float* candidate) {
    double worst = 0;
    for (int c = 0; c < 3; ++c) {
        const double e = std::fabs(truth[c] - static_cast<double>(candidate[c]));
        if (std::isnan(e)) return kInfinity;
        worst = std::max(worst, e);
    }
    return worst;
}

namespace {

/// Code values of a display -> ICtCp (ITU-R BT.2100-2, table 7).
Pipeline ictcp_of(const Display& display, double unit_nits) {
    constexpr Matrix3 to_lms = {{{1688.0 / 4096, 2146.0 / 4096, 262.0 / 4096},
                                 {683.0 / 4096, 2951.0 / 4096, 462.0 / 4096},
                                 {99.0 / 4096, 309.0 / 4096, 3688.0 / 4096}}};
    constexpr Matrix3 to_ictcp = {{{0.5, 0.5, 0},
                                   {6610.0 / 4096, -13613.0 / 4096, 7003.0 / 4096},
                                   {17933.0 / 4096, -17390.0 / 4096, -543.0 / 4096}}};
    const Matrix3 light = scale(rgb_to_rgb(display.primaries, kRec2020), unit_nits);
    Pipeline stages = display.decode;
    stages.insert(stages.end(),
                  {MatrixStage{multiply(to_lms, light)}, curve_stage(pq_encode_nits(Expr::input())),
                   MatrixStage{to_ictcp}});
    return stages;
}

}  // namespace

std::vector<double> ictcp_of_codes(const Display& display, std::span<const double> code,
                                   double unit_nits) {
    const std::size_t count = code.size() / 3;
    std::vector<double> ictcp(code.size());
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < count; ++i)
            ictcp[c * count + i] = code[3 * i + c];
    }
    const std::array<double*, 3> planes = {ictcp.data(), ictcp.data() + count,
                                           ictcp.data() + 2 * count};
    ReferenceEngine(ictcp_of(display, unit_nits))
        .run({planes[0], planes[1], planes[2]}, planes, count);
    return ictcp;
}

std::vector<double> delta_e_itp(std::span<const double> ictcp_a, std::span<const double> ictcp_b) {
    const std::size_t count = ictcp_a.size() / 3;
    std::vector<double> difference(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double intensity = ictcp_a[i] - ictcp_b[i];
        const double t = 0.5 * (ictcp_a[count + i] - ictcp_b[count + i]);  // BT.2124: T is half Ct
        const double p = ictcp_a[2 * count + i] - ictcp_b[2 * count + i];
        difference[i] = 720 * std::sqrt(intensity * intensity + t * t + p * p);
    }
    return difference;
}

std::vector<double> delta_e_itp(const Display& display, std::span<const double> code_a,
                                std::span<const double> code_b, double unit_nits) {
    return delta_e_itp(ictcp_of_codes(display, code_a, unit_nits),
                       ictcp_of_codes(display, code_b, unit_nits));
}

TONEWRIGHT_NAMESPACE_END
