// SPDX-License-Identifier: Apache-2.0
#include "lut/ringing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format_number.h"
#include "lut/display_code.h"
#include "lut/in_parallel.h"
#include "lut/node_weights.h"
#include "lut/table_input.h"
#include "measure/chart_colors.h"
#include "measure/error_metric.h"
#include "measure/photographs.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Exposures of a ray. Each cell of a LUT with 65 nodes has several.
constexpr double kDarkest = -12;
constexpr double kBrightest = 12;
constexpr int kStepsPerStop = 16;
constexpr std::size_t kPlaces =
    static_cast<std::size_t>((kBrightest - kDarkest) * kStepsPerStop) + 1;

double stops_of(std::size_t place) { return kDarkest + static_cast<double>(place) / kStepsPerStop; }

/// Colors at rising exposures as inputs of a LUT, and the results of the operator. All planes hold
/// kPlaces entries per color, color by color.
struct Rays {
    /// Interleaved RGB.
    std::vector<double> input;
    std::array<std::vector<double>, 3> wanted;
    std::size_t count = 0;
};

Rays make_rays(const std::vector<NamedColor>& colors, const Lut& lut, const LutRequest& request) {
    const Matrix3 to_input = rgb_to_rgb(kRec709, find_input_space(request.view.input).primaries);
    std::vector<float> light;
    for (const NamedColor& color : colors) {
        const Vector3 unit = multiply(to_input, color.rgb);
        for (std::size_t i = 0; i < kPlaces; ++i) {
            const double gain = 0.18 * std::exp2(stops_of(i));
            // The encoding clips values outside its range before the table, which is not the
            // table's error.
            for (const double channel : unit) {
                light.push_back(static_cast<float>(std::clamp(
                    gain * channel, request.encoding.scene_lo, request.encoding.scene_hi)));
            }
        }
    }
    Rays rays;
    rays.count = colors.size();
    rays.input = table_input(lut, request, light);
    std::vector<double> wanted(light.size());
    ReferenceEngine(build_view(request.view))
        .run_rgb(light.data(), wanted.data(), light.size() / 3);
    for (std::size_t i = 0; i < wanted.size(); ++i)
        rays.wanted[i % 3].push_back(wanted[i]);
    return rays;
}

/// Largest fall between two positions of a ray, minus the fall of the operator between them.
struct Fall {
    double size = 0;
    double allowed = 0;
    std::size_t from = 0;
    std::size_t to = 0;
};

/// @param shown, wanted  kPlaces codes of one channel
/// @param ignored        smaller falls are ignored
Fall largest_fall(const double* shown, const double* wanted, double ignored) {
    Fall worst;
    worst.size = ignored;
    // Fast path: most rays only rise.
    double highest_shown = shown[0];
    bool falls = false;
    for (std::size_t i = 1; i < kPlaces && !falls; ++i) {
        falls = highest_shown - shown[i] > ignored;
        highest_shown = std::max(highest_shown, shown[i]);
    }
    if (!falls) return {};
    std::array<double, kPlaces> lowest_from{};
    lowest_from[kPlaces - 1] = shown[kPlaces - 1];
    for (std::size_t i = kPlaces - 1; i-- > 0;)
        lowest_from[i] = std::min(shown[i], lowest_from[i + 1]);
    for (std::size_t i = 0; i + 1 < kPlaces; ++i) {
        // A fall that begins lower than the previous one is part of it.
        if (shown[i + 1] >= shown[i]) continue;
        double highest = wanted[i];
        double allowed = 0;
        for (std::size_t j = i + 1; j < kPlaces; ++j) {
            // No lower position follows.
            if (shown[i] - lowest_from[j] - allowed <= worst.size) break;
            highest = std::max(highest, wanted[j]);
            allowed = std::max(allowed, highest - wanted[j]);
            const double fall = shown[i] - shown[j] - allowed;
            if (fall > worst.size) worst = {fall, allowed, i, j};
        }
    }
    return worst.to == 0 ? Fall{} : worst;
}

/// Rays of all hues and saturations of three gamuts, and of the chart.
std::vector<NamedColor> dense_colors() {
    std::vector<NamedColor> colors = chart_colors();
    for (const Primaries* gamut : {&kRec709, &kP3D65, &kRec2020}) {
        const Matrix3 to_rec709 = rgb_to_rgb(*gamut, kRec709);
        for (const double saturation : {1.0, 0.9, 0.7, 0.4, 0.2, 0.08}) {
            // Near gray, the gamuts share their colors.
            if (saturation < 0.4 && gamut != &kRec709) continue;
            // Operators bend most at the faces of a gamut.
            const int hues = saturation == 1.0 ? 144 : 48;
            for (int i = 0; i < hues; ++i) {
                const double hue = (i + 0.5) / hues;
                colors.push_back({{}, multiply(to_rec709, hue_color(hue, saturation, 1))});
            }
        }
    }
    return colors;
}

/// Share of the pixels of photographs that each node shows.
std::vector<double> photograph_shares(const Lut& lut, const LutRequest& request,
                                      LutInterpolation interpolation) {
    const std::vector<double> place =
        table_input(lut, request, photograph_light(find_input_space(request.view.input).primaries));
    const auto edge = static_cast<std::size_t>(lut.size);
    std::vector<double> shares(edge * edge * edge, 0.0);
    const std::vector<double>& share = photograph_colors().share;
    for (std::size_t i = 0; i < share.size(); ++i) {
        const NodeWeights at =
            node_weights({place[3 * i], place[3 * i + 1], place[3 * i + 2]}, edge, interpolation);
        for (std::size_t k = 0; k < at.count; ++k)
            shares[at.node[k]] += share[i] * at.weight[k];
    }
    return shares;
}

/// Change of a weighted sum of values with each node.
struct Slopes {
    std::array<std::size_t, 16> node{};
    std::array<double, 16> slope{};
    std::size_t count = 0;

    void add(const NodeWeights& at, double sign) {
        for (std::size_t k = 0; k < at.count; ++k) {
            const auto end = node.begin() + static_cast<std::ptrdiff_t>(count);
            const auto found = std::find(node.begin(), end, at.node[k]);
            const auto slot = static_cast<std::size_t>(found - node.begin());
            if (found == end) {
                node[slot] = at.node[k];
                ++count;
            }
            slope[slot] += sign * at.weight[k];
        }
    }
};

}  // namespace

LutRinging measure_ringing(const Lut& lut, const LutRequest& request,
                           LutInterpolation interpolation) {
    LutRinging result;
    if (lut.dimension != 3) return result;
    const std::vector<NamedColor> colors = chart_colors();
    Rays rays = make_rays(colors, lut, request);
    std::array<std::vector<double>, 3> shown;
    for (std::size_t i = 0; i < rays.input.size(); i += 3) {
        const Vector3 out =
            interpolate(lut, {rays.input[i], rays.input[i + 1], rays.input[i + 2]}, interpolation);
        for (std::size_t c = 0; c < 3; ++c)
            shown[c].push_back(out[c]);
    }
    const DisplayCode code(request.view);
    std::vector<double> errors(shown[0].size(), 0);
    for (std::size_t c = 0; c < 3; ++c) {
        code.encode(shown[c]);
        code.encode(rays.wanted[c]);
        for (std::size_t i = 0; i < errors.size(); ++i)
            errors[i] = std::max(errors[i], std::fabs(shown[c][i] - rays.wanted[c][i]));
        for (std::size_t ray = 0; ray < rays.count; ++ray) {
            constexpr std::array<const char*, 3> kChannels = {"red", "green", "blue"};
            const Fall fall =
                largest_fall(&shown[c][ray * kPlaces], &rays.wanted[c][ray * kPlaces], result.fall);
            if (fall.size <= result.fall) continue;
            result.fall = fall.size;
            result.color = colors[ray].name;
            result.channel = kChannels[c];
            result.stops = stops_of(fall.to);
        }
    }
    result.p999 = summarise(errors).p999;
    return result;
}

struct RayFit::Prepared {
    Rays rays;
    DisplayCode code;
    std::vector<NodeWeights> weights;
    /// Mobility of each node; 0: it stays.
    std::vector<double> mobility;
};

RayFit::RayFit(const Lut& lut, const LutRequest& request, LutInterpolation interpolation,
               RayNodes nodes) {
    const auto edge = static_cast<std::size_t>(lut.size);
    Rays rays = make_rays(dense_colors(), lut, request);
    const DisplayCode code(request.view);
    for (std::vector<double>& wanted : rays.wanted)
        code.encode(wanted);
    std::vector<NodeWeights> weights;
    weights.reserve(rays.input.size() / 3);
    for (std::size_t i = 0; i < rays.input.size(); i += 3) {
        weights.push_back(node_weights({rays.input[i], rays.input[i + 1], rays.input[i + 2]}, edge,
                                       interpolation));
    }
    std::vector<double> mobility(edge * edge * edge, 1);
    if (nodes == RayNodes::unused) {
        // Nodes that photographs use a thousand times more move a thousand times less.
        constexpr double kUnused = 1e-5;
        mobility = photograph_shares(lut, request, interpolation);
        for (double& m : mobility)
            m = 1 / (1 + m / kUnused);
        for (std::size_t i = 0; i < edge; ++i)
            mobility[i * (1 + edge + edge * edge)] = 0;
    }
    prepared_ = std::make_unique<const Prepared>(
        Prepared{std::move(rays), code, std::move(weights), std::move(mobility)});
}

RayFit::~RayFit() = default;

void RayFit::fit(Lut& lut, const RayBounds& bounds) const {
    // Most rounds only check rays that broke a bound in the previous round.
    constexpr int kRounds = 128;
    constexpr int kAllEvery = 8;
    constexpr int kFallsEach = 4;
    // If both bounds cannot be met, the last rounds fix the falls, because they are visible as
    // rings.
    constexpr int kFallsOnly = 40;
    // Clang 14 captures no structured bindings.
    const Rays& rays = prepared_->rays;
    const DisplayCode& code = prepared_->code;
    const std::vector<NodeWeights>& weights = prepared_->weights;
    const std::vector<double>& mobility = prepared_->mobility;
    const auto [lowest, highest] = std::minmax_element(lut.values.begin(), lut.values.end());
    const float lo = *lowest;
    const float hi = *highest;
    in_parallel(3, 0, [&](std::size_t c) {
        const auto value_at = [&](const NodeWeights& at) {
            double value = 0;
            for (std::size_t k = 0; k < at.count; ++k)
                value += at.weight[k] * static_cast<double>(lut.values[3 * at.node[k] + c]);
            return value;
        };
        // Kaczmarz's method: the smallest change of the nodes that changes their sum by this
        // amount.
        const auto raise = [&](const Slopes& slopes, double by) {
            double square = 0;
            for (std::size_t k = 0; k < slopes.count; ++k)
                square += mobility[slopes.node[k]] * slopes.slope[k] * slopes.slope[k];
            if (square < 1e-12) return;
            for (std::size_t k = 0; k < slopes.count; ++k) {
                float& v = lut.values[3 * slopes.node[k] + c];
                v = std::clamp(v + static_cast<float>(by / square * mobility[slopes.node[k]] *
                                                      slopes.slope[k]),
                               lo, hi);
            }
        };
        std::vector<bool> is_active(rays.count, true);
        // Last displayed value at each position: encoding is slowest, and few positions change in a
        // step.
        std::vector<double> values(weights.size());
        std::vector<double> codes(weights.size());
        for (std::size_t i = 0; i < weights.size(); ++i) {
            values[i] = value_at(weights[i]);
            codes[i] = code.of(values[i]);
        }
        const auto look = [&](std::size_t i) {
            const double value = value_at(weights[i]);
            if (value == values[i]) return;
            values[i] = value;
            codes[i] = code.of(value);
        };
        for (int round = 0; round < kRounds; ++round) {
            const bool takes_all = round % kAllEvery == 0;
            const bool has_band = bounds.has_band && round < kRounds - kFallsOnly;
            bool is_done = true;
            for (std::size_t ray = 0; ray < rays.count; ++ray) {
                if (!takes_all && !is_active[ray]) continue;
                const NodeWeights* at = &weights[ray * kPlaces];
                const double* wanted = &rays.wanted[c][ray * kPlaces];
                double* shown = &codes[ray * kPlaces];
                is_active[ray] = false;
                for (std::size_t i = 0; i < kPlaces; ++i) {
                    look(ray * kPlaces + i);
                    const double limit = std::clamp(shown[i], wanted[i] - kFittedRayError,
                                                    wanted[i] + kFittedRayError);
                    if (!has_band || std::fabs(shown[i] - limit) < 1e-9) continue;
                    is_active[ray] = true;
                    Slopes slopes;
                    slopes.add(at[i], 1);
                    raise(slopes, code.value(limit) - values[ray * kPlaces + i]);
                    look(ray * kPlaces + i);
                }
                for (int k = 0; k < kFallsEach; ++k) {
                    const Fall fall = largest_fall(shown, wanted, bounds.largest_fall);
                    if (fall.size <= 0) break;
                    is_active[ray] = true;
                    const double least = shown[fall.from] - fall.allowed - bounds.largest_fall;
                    Slopes slopes;
                    slopes.add(at[fall.from], -1);
                    slopes.add(at[fall.to], 1);
                    raise(slopes, code.value(least) - value_at(at[fall.to]));
                    for (std::size_t i = 0; i < kPlaces; ++i)
                        look(ray * kPlaces + i);
                }
                is_done = is_done && !is_active[ray];
            }
            if (is_done && takes_all) break;
        }
    });
}

bool rings(const LutRinging& ringing) { return ringing.fall > kLargestFall; }

bool follows_operator(const LutRinging& ringing) {
    return !rings(ringing) && ringing.p999 <= kLargestRayError;
}

std::string to_string(const LutRinging& ringing) {
    if (ringing.fall <= 0) return "no channel falls where the operator's does not";
    return fmt::format("{} falls by {} up to {:+.1f} stops of {}", ringing.channel,
                       rounded_up(ringing.fall), ringing.stops, ringing.color);
}

TONEWRIGHT_NAMESPACE_END
