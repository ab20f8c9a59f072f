// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "base/random.h"
#include "lut/display_code.h"
#include "lut/half_domain.h"
#include "lut/node_weights.h"
#include "lut/photograph_error.h"
#include "lut/shaper.h"
#include "lut/table_input.h"
#include "measure/error_metric.h"
#include "measure/photographs.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

double interpolate_half(const Lut& lut, double x) {
    x = sanitize(x);
    const unsigned sign = std::signbit(x) ? 0x8000U : 0U;
    const double magnitude = std::fabs(x);
    // The half float at or below, by bisection over the bit patterns (their order is the numbers').
    unsigned lo = 0;
    unsigned hi = 0x7BFF;
    while (lo < hi) {
        const unsigned middle = (lo + hi + 1) / 2;
        if (half_value(middle) <= magnitude) {
            lo = middle;
        } else {
            hi = middle - 1;
        }
    }
    const double a = static_cast<double>(lut.values[sign | lo]);
    if (lo == 0x7BFF) return a;
    const double b = static_cast<double>(lut.values[sign | (lo + 1)]);
    const double t = (magnitude - half_value(lo)) / (half_value(lo + 1) - half_value(lo));
    return a + t * (b - a);
}

double interpolate_1d(const Lut& lut, double x, std::size_t channel) {
    const auto channels = static_cast<std::size_t>(lut.channels);
    const std::size_t last = static_cast<std::size_t>(lut.size) - 1;
    const double position = (x > 0 ? std::min(x, 1.0) : 0.0) * static_cast<double>(last);
    const auto i = std::min(static_cast<std::size_t>(position), last - 1);
    const double t = position - static_cast<double>(i);
    const double a = static_cast<double>(lut.values[i * channels + channel]);
    const double b = static_cast<double>(lut.values[(i + 1) * channels + channel]);
    return a + t * (b - a);
}

/// The 1D LUT before a 3D LUT: straight lines between equal steps.
void run_shaper(const InputEncoding& encoding, std::span<const float> light,
                std::vector<double>& code) {
    const double lo = encoding.scene_lo;
    const double span = encoding.scene_hi - lo;
    const Lut shaper = {1, kShaperSteps, 1, false, shaper_table(encoding)};
    for (std::size_t i = 0; i < light.size(); ++i)
        code[i] = interpolate_1d(shaper, (static_cast<double>(light[i]) - lo) / span, 0);
}

/// A LUT and the function that it represents.
class Comparison {
  public:
    Comparison(const Lut& lut, const LutRequest& request, LutInterpolation interpolation)
        : lut_(lut),
          request_(request),
          interpolation_(interpolation),
          engine_(build_view(request.view)) {}

    /// Range of the encoding.
    [[nodiscard]] bool is_inside(const float* light) const {
        if (lut_.is_half_domain) return true;
        return std::all_of(light, light + 3, [&](float x) {
            return static_cast<double>(x) >= request_.encoding.scene_lo &&
                   static_cast<double>(x) <= request_.encoding.scene_hi;
        });
    }

    /// Error of the worst channel of each color.
    std::vector<double> errors(const std::vector<float>& light, std::vector<double>& shown,
                               std::vector<double>& wanted) const {
        const std::vector<double> code = table_input(lut_, request_, light);
        wanted.resize(light.size());
        shown.resize(light.size());
        engine_.run_rgb(light.data(), wanted.data(), light.size() / 3);
        std::vector<double> errors;
        for (std::size_t i = 0; i < light.size(); i += 3) {
            const Vector3 out =
                interpolate(lut_, {code[i], code[i + 1], code[i + 2]}, interpolation_);
            double worst = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                shown[i + c] = out[c];
                const double difference = std::fabs(out[c] - wanted[i + c]);
                worst = std::max(worst, std::isnan(difference) ? kInfinity : difference);
            }
            errors.push_back(worst);
        }
        return errors;
    }

    /// Largest error of any input color: an uphill search from the worst samples.
    [[nodiscard]] double largest_error(const std::vector<float>& light,
                                       const std::vector<double>& errors) const {
        constexpr std::size_t kStarts = 400;
        std::vector<std::size_t> order(errors.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        const std::size_t count = std::min(kStarts, order.size());
        std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                          order.end(),
                          [&](std::size_t a, std::size_t b) { return errors[a] > errors[b]; });
        std::vector<float> starts;
        std::vector<double> best;
        for (std::size_t k = 0; k < count; ++k) {
            starts.insert(starts.end(), &light[3 * order[k]], &light[3 * order[k]] + 3);
            best.push_back(errors[order[k]]);
        }
        std::vector<double> place = table_input(lut_, request_, starts);
        climb(place, best);
        return best.empty() ? 0 : *std::max_element(best.begin(), best.end());
    }

  private:
    /// Pattern search at all positions at once: along the axes and the diagonals, starting with
    /// half a cell.
    void climb(std::vector<double>& place, std::vector<double>& best) const {
        constexpr int kHalvings = 9;
        constexpr int kStepsEach = 3;
        std::vector<double> shown;
        std::vector<double> wanted;
        double step = 0.5 / (lut_.size - 1);
        for (int halving = 0; halving < kHalvings; ++halving, step /= 2) {
            for (int i = 0; i < kStepsEach; ++i) {
                std::vector<double> tried;
                for (std::size_t k = 0; k < best.size(); ++k) {
                    for (int direction = 0; direction < kDirections; ++direction) {
                        for (std::size_t c = 0; c < 3; ++c) {
                            tried.push_back(std::clamp(
                                place[3 * k + c] + step * direction_of(direction, c), 0.0, 1.0));
                        }
                    }
                }
                const std::vector<double> errors =
                    this->errors(light_of(request_.encoding, tried), shown, wanted);
                bool is_better = false;
                for (std::size_t k = 0; k < errors.size(); ++k) {
                    const std::size_t start = k / kDirections;
                    if (errors[k] <= best[start]) continue;
                    best[start] = errors[k];
                    std::copy_n(&tried[3 * k], 3, &place[3 * start]);
                    is_better = true;
                }
                if (!is_better) break;
            }
        }
    }

    static constexpr int kDirections = 14;
    /// Six along the axes, then eight along the diagonals.
    static double direction_of(int direction, std::size_t channel) {
        if (direction < 6) {
            if (static_cast<std::size_t>(direction / 2) != channel) return 0;
            return direction % 2 ? 1 : -1;
        }
        return (static_cast<unsigned>(direction - 6) >> channel & 1U) ? 1 : -1;
    }

    const Lut& lut_;
    const LutRequest& request_;
    LutInterpolation interpolation_;
    ReferenceEngine engine_;
};

/// The error that the share of the colors stays within.
double percentile_of(const std::vector<double>& errors, const std::vector<double>& share,
                     double wanted) {
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return errors[a] < errors[b]; });
    double sum = 0;
    for (const std::size_t i : order) {
        sum += share[i];
        if (sum >= wanted) return errors[i];
    }
    return errors.empty() ? 0 : errors[order.back()];
}

}  // namespace

PhotographError photograph_error(const View& view, std::vector<double> shown,
                                 std::vector<double> wanted, const InputEncoding* encoding) {
    constexpr double kWithin = 0.999;
    constexpr double kCode = 1.0 / 255;
    const PhotographColors& colors = photograph_colors();
    const std::vector<float> light = photograph_light(find_input_space(view.input).primaries);
    const DisplayCode code(view);
    code.encode(shown);
    code.encode(wanted);
    // Light that is darker than the input holds becomes its black. Below 0 are colors outside its
    // primaries; conversions round 0 to less than this.
    constexpr double kRounding = 1e-6;
    const double darkest_held = encoding ? std::min(encoding->scene_lo, 0.0) - kRounding : 0;
    PhotographError error;
    std::vector<double> errors;
    std::vector<double> shares;
    double inside = 0;
    for (std::size_t i = 0; i < shown.size(); i += 3) {
        const double share = colors.share[i / 3];
        const bool is_inside =
            !encoding || std::all_of(&light[i], &light[i] + 3, [&](float channel) {
                const auto x = static_cast<double>(channel);
                return x >= darkest_held && x <= encoding->scene_hi;
            });
        double worst = 0;
        for (std::size_t c = 0; is_inside && c < 3; ++c)
            worst = std::max(worst, std::fabs(shown[i + c] - wanted[i + c]));
        errors.push_back(worst);
        shares.push_back(is_inside ? share : 0);
        inside += shares.back();
        error.mean += shares.back() * worst;
        if (worst > kCode) error.share += share;
    }
    constexpr double kSumRounding = 1e-12;
    error.outside = 1 - inside > kSumRounding ? 1 - inside : 0;
    if (!(inside > 0)) return error;
    error.mean /= inside;
    error.share /= inside;
    error.p999 = percentile_of(errors, shares, kWithin * inside);
    double most = -1;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double excess = shares[i] * (errors[i] - error.p999);
        if (excess <= most) continue;
        most = excess;
        error.worst = description_of({static_cast<double>(colors.rgb[3 * i]),
                                      static_cast<double>(colors.rgb[3 * i + 1]),
                                      static_cast<double>(colors.rgb[3 * i + 2])});
    }
    return error;
}

Vector3 interpolate(const Lut& lut, const Vector3& rgb, LutInterpolation interpolation) {
    Vector3 out{};
    if (lut.dimension == 1) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t channel = lut.channels == 1 ? 0 : c;
            out[c] = lut.is_half_domain ? interpolate_half(lut, rgb[c])
                                        : interpolate_1d(lut, rgb[c], channel);
        }
        return out;
    }
    const NodeWeights at = node_weights(rgb, static_cast<std::size_t>(lut.size), interpolation);
    for (std::size_t k = 0; k < at.count; ++k) {
        for (std::size_t c = 0; c < 3; ++c)
            out[c] += at.weight[k] * static_cast<double>(lut.values[3 * at.node[k] + c]);
    }
    return out;
}

std::vector<double> table_input(const Lut& lut, const LutRequest& request,
                                std::span<const float> light) {
    std::vector<double> code(light.begin(), light.end());
    if (lut.is_half_domain) return code;
    if (has_shaper(request.format)) {
        run_shaper(request.encoding, light, code);
    } else {
        ReferenceEngine({curve_stage(request.encoding.encode)})
            .run_rgb(light.data(), code.data(), light.size() / 3);
    }
    return code;
}

std::vector<float> light_of(const InputEncoding& encoding, std::span<const double> code) {
    const std::size_t count = code.size() / 3;
    std::array<std::vector<double>, 3> plane;
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < count; ++i)
            plane[c].push_back(code[3 * i + c]);
    }
    const std::array<double*, 3> p = {plane[0].data(), plane[1].data(), plane[2].data()};
    ReferenceEngine({curve_stage(encoding.decode)}).run({p[0], p[1], p[2]}, p, count);
    std::vector<float> light;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            light.push_back(
                static_cast<float>(std::clamp(plane[c][i], encoding.scene_lo, encoding.scene_hi)));
        }
    }
    return light;
}

LutError measure_lut(const Lut& lut, const LutRequest& request, LutInterpolation interpolation) {
    const Comparison comparison(lut, request, interpolation);
    const InputSpace& space = find_input_space(request.view.input);
    SampleSet samples = make_sample_set(space, {17, 50000});
    // Also samples table inputs over the whole 3D LUT, including corners that no scene color of the
    // set reaches.
    constexpr std::size_t kRandomCount = 50000;
    SampleRandom random(7);
    std::array<std::vector<double>, 3> inputs;
    for (auto& plane : inputs) {
        for (std::size_t i = 0; i < kRandomCount; ++i)
            plane.push_back(random.uniform(0, 1));
    }
    const std::array<double*, 3> planes = {inputs[0].data(), inputs[1].data(), inputs[2].data()};
    ReferenceEngine({curve_stage(request.encoding.decode)})
        .run({planes[0], planes[1], planes[2]}, planes, kRandomCount);
    for (std::size_t i = 0; i < kRandomCount; ++i) {
        samples.add(inputs[0][i], inputs[1][i], inputs[2][i], SampleKind::random);
    }
    std::vector<float> light;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const float* v = &samples.rgb[3 * i];
        if (samples.kind[i] != SampleKind::special && comparison.is_inside(v))
            light.insert(light.end(), v, v + 3);
    }
    std::vector<double> shown;
    std::vector<double> wanted;
    const std::vector<double> errors = comparison.errors(light, shown, wanted);
    const ErrorStats stats = summarise(errors);
    LutError result;
    result.max = lut.dimension == 3 ? comparison.largest_error(light, errors) : stats.max;
    result.p999 = stats.p999;
    result.mean = stats.mean;
    result.interpolation = lut.dimension == 1                             ? "linear"
                           : interpolation == LutInterpolation::trilinear ? "trilinear"
                                                                          : "tetrahedral";
    if (request.view.display != kLinearOutput && request.view.display != kNativeOutput) {
        const ErrorStats seen =
            summarise(delta_e_itp(find_display(request.view.display), shown, wanted));
        result.delta_e_max = seen.max;
        result.delta_e_p999 = seen.p999;
        result.delta_e_mean = seen.mean;
    }
    (void)comparison.errors(photograph_light(space.primaries), shown, wanted);
    result.photographs = photograph_error(request.view, shown, wanted,
                                          lut.is_half_domain ? nullptr : &request.encoding);
    return result;
}

TONEWRIGHT_NAMESPACE_END
