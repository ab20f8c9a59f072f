// SPDX-License-Identifier: Apache-2.0
#include "measure/sample_set.h"
#include "base/random.h"

#include <array>
#include <cmath>
#include <limits>

TONEWRIGHT_NAMESPACE_BEGIN

bool SampleSet::is_non_negative(std::size_t i) const {
    for (std::size_t c = 0; c < 3; ++c) {
        const float x = rgb[3 * i + c];
        if (!(x >= 0 && std::isfinite(x))) return false;
    }
    return true;
}

void SampleSet::add(double r, double g, double b, SampleKind k) {
    rgb.push_back(static_cast<float>(r));
    rgb.push_back(static_cast<float>(g));
    rgb.push_back(static_cast<float>(b));
    kind.push_back(k);
}

SampleSet make_sample_set(const InputSpace& input, const SampleSetOptions& options) {
    SampleSet set;
    SampleRandom random(20021);

    set.add(0, 0, 0, SampleKind::gray);
    for (int step = -12 * 64; step <= 12 * 64; ++step) {
        const double gray = 0.18 * std::exp2(step / 64.0);
        set.add(gray, gray, gray, SampleKind::gray);
    }

    const int n = options.gamut_grid_size;
    for (const Primaries& gamut : {kRec709, kRec2020, kAP1}) {
        const Matrix3 to_input = rgb_to_rgb(gamut, input.primaries);
        for (const double exposure : {-6.0, -2.0, 0.0, 3.0, 6.0}) {
            const double gain = std::exp2(exposure) / (n - 1);
            for (int r = 0; r < n; ++r) {
                for (int g = 0; g < n; ++g) {
                    for (int b = 0; b < n; ++b) {
                        const Vector3 v = multiply(to_input, Vector3{gain * r, gain * g, gain * b});
                        set.add(v[0], v[1], v[2], SampleKind::grid);
                    }
                }
            }
        }
    }

    const auto log_uniform = [&](double lo, double hi) {
        return std::exp2(random.uniform(lo, hi));
    };
    for (std::size_t i = 0; i < options.random_count; ++i) {
        Vector3 v = {log_uniform(-16, 12), log_uniform(-16, 12), log_uniform(-16, 12)};
        if (i % 10 == 0) v[i / 10 % 3] = 0;
        set.add(v[0], v[1], v[2], SampleKind::random);
    }
    for (std::size_t i = 0; i < options.random_count / 20; ++i) {
        // One statement for each channel: compilers evaluate arguments in different orders.
        const double b = log_uniform(-148, -10);
        const double g = log_uniform(-148, -10);
        const double r = log_uniform(-148, -10);
        set.add(r, g, b, SampleKind::near_black);
    }
    for (std::size_t i = 0; i < options.random_count / 5; ++i) {
        Vector3 v = {log_uniform(-12, 12), log_uniform(-12, 12), log_uniform(-12, 12)};
        const std::size_t first = i % 3;
        v[first] = -v[first];
        if (i % 2) v[(first + 1) % 3] *= -1;
        set.add(v[0], v[1], v[2], SampleKind::negative);
    }

    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const auto huge = static_cast<double>(std::numeric_limits<float>::max());
    constexpr double kPlain = 0.18;
    for (const double s : {nan, inf, -inf, huge, -huge}) {
        set.add(s, s, s, SampleKind::special);
        set.add(s, kPlain, kPlain, SampleKind::special);
        set.add(kPlain, s, kPlain, SampleKind::special);
        set.add(kPlain, kPlain, s, SampleKind::special);
        for (const double t : {nan, inf, -inf, huge})
            set.add(s, t, kPlain, SampleKind::special);
    }
    return set;
}

TONEWRIGHT_NAMESPACE_END
