// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "lut/half_domain.h"
#include "lut/shaper.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

double interpolate_half(const Lut& lut, double x) {
    x = sanitise(x);
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

/// What the table before a cube makes of light: straight lines between equal steps.
void run_shaper(const InputEncoding& encoding, const std::vector<float>& light,
                std::vector<double>& code) {
    std::vector<float> steps;
    const double lo = encoding.scene_lo;
    const double span = encoding.scene_hi - lo;
    for (int i = 0; i < kShaperSteps; ++i)
        steps.push_back(
            static_cast<float>(evaluate(encoding.encode, lo + span * i / (kShaperSteps - 1.0))));
    const Lut shaper = {1, kShaperSteps, 1, false, std::move(steps)};
    for (std::size_t i = 0; i < light.size(); ++i)
        code[i] = interpolate_1d(shaper, (static_cast<double>(light[i]) - lo) / span, 0);
}

}  // namespace

Vector3 interpolate(const Lut& lut, const Vector3& rgb, bool trilinear) {
    Vector3 out{};
    if (lut.dimension == 1) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t channel = lut.channels == 1 ? 0 : c;
            out[c] = lut.is_half_domain ? interpolate_half(lut, rgb[c])
                                        : interpolate_1d(lut, rgb[c], channel);
        }
        return out;
    }
    const auto n = static_cast<std::size_t>(lut.size);
    std::array<std::size_t, 3> corner{};
    std::array<double, 3> f{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double position =
            (rgb[c] > 0 ? std::min(rgb[c], 1.0) : 0.0) * static_cast<double>(n - 1);
        corner[c] = std::min(static_cast<std::size_t>(position), n - 2);
        f[c] = position - static_cast<double>(corner[c]);
    }
    const auto add = [&](std::array<std::size_t, 3> step, double weight) {
        const std::size_t node =
            ((corner[2] + step[2]) * n + corner[1] + step[1]) * n + corner[0] + step[0];
        for (std::size_t c = 0; c < 3; ++c) {
            out[c] += weight * static_cast<double>(lut.values[3 * node + c]);
        }
    };
    if (trilinear) {
        for (std::size_t i = 0; i < 8; ++i) {
            double weight = 1;
            const std::array<std::size_t, 3> step = {i & 1, i >> 1 & 1, i >> 2 & 1};
            for (std::size_t c = 0; c < 3; ++c)
                weight *= step[c] ? f[c] : 1 - f[c];
            add(step, weight);
        }
        return out;
    }
    // Tetrahedral: from the near corner to the far one along the axes, largest fraction first.
    std::array<std::size_t, 3> order = {0, 1, 2};
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return f[a] > f[b]; });
    std::array<std::size_t, 3> step{};
    add(step, 1 - f[order[0]]);
    for (std::size_t k = 0; k < 3; ++k) {
        step[order[k]] = 1;
        add(step, f[order[k]] - (k < 2 ? f[order[k + 1]] : 0));
    }
    return out;
}

LutError measure_lut(const Lut& lut, const LutRequest& request, bool trilinear) {
    const InputSpace& space = find_input_space(request.view.input);
    SampleSet samples = make_sample_set(space, {17, 50000});
    // And table inputs over the whole cube: the corners that no scene colour of the set reaches.
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
    // Table input as a client has it: float, of the float colour.
    std::vector<double> code(samples.rgb.size());
    {
        const ReferenceEngine encode({curve_stage(request.encoding.encode)});
        if (lut.is_half_domain) {
            std::copy(samples.rgb.begin(), samples.rgb.end(), code.begin());
        } else if (has_shaper(request.format)) {
            run_shaper(request.encoding, samples.rgb, code);
        } else {
            encode.run_rgb(samples.rgb.data(), code.data(), samples.size());
        }
    }
    const ReferenceEngine engine(build_view(request.view));
    std::vector<double> truth(samples.rgb.size());
    engine.run_rgb(samples.rgb.data(), truth.data(), samples.size());

    std::vector<double> errors;
    std::vector<double> shown;
    std::vector<double> wanted;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples.kind[i] == SampleKind::special) continue;
        const float* v = &samples.rgb[3 * i];
        bool inside = true;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto x = static_cast<double>(v[c]);
            inside = inside && (lut.is_half_domain ||
                                (x >= request.encoding.scene_lo && x <= request.encoding.scene_hi));
        }
        if (!inside) continue;
        const Vector3 out =
            interpolate(lut, {code[3 * i], code[3 * i + 1], code[3 * i + 2]}, trilinear);
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = std::fabs(out[c] - truth[3 * i + c]);
            worst = std::max(worst, std::isnan(difference) ? kInfinity : difference);
            shown.push_back(out[c]);
            wanted.push_back(truth[3 * i + c]);
        }
        errors.push_back(worst);
    }
    const ErrorStats stats = summarise(errors);
    LutError result;
    result.max = stats.max;
    result.p999 = stats.p999;
    result.mean = stats.mean;
    result.interpolation = lut.dimension == 1 ? "linear" : trilinear ? "trilinear" : "tetrahedral";
    if (request.view.display != kLinearOutput && request.view.display != kNativeOutput) {
        const ErrorStats seen =
            summarise(delta_e_itp(find_display(request.view.display), shown, wanted));
        result.delta_e_max = seen.max;
        result.delta_e_p999 = seen.p999;
        result.delta_e_mean = seen.mean;
    }
    return result;
}

TONEWRIGHT_NAMESPACE_END
