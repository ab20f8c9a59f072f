// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tonewright/color.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// True if the output is display-linear, not a code value.
[[nodiscard]] inline bool is_light(const View& view) {
    if (view.display == kNativeOutput) return view.op.output() != OutputKind::code_value;
    return view.display == kLinearOutput;
}

/// Encodes display-linear as sRGB, so that a step of 1/255 is as visible as in code values.
class DisplayCode {
  public:
    explicit DisplayCode(const View& view) : is_light_(is_light(view)) {
        if (!is_light_) return;
        const Expr encode = srgb_encode(Expr::input());
        const Expr decode = srgb_decode(Expr::input());
        for (std::size_t i = 0; i <= kSteps; ++i) {
            const double x = static_cast<double>(i) / kSteps;
            encode_.push_back(evaluate(encode, x * x));
            decode_.push_back(evaluate(decode, x));
        }
    }

    [[nodiscard]] double of(double value) const {
        return is_light_ ? at(encode_, std::sqrt(std::clamp(value, 0.0, 1.0))) : value;
    }
    [[nodiscard]] double value(double code) const {
        return is_light_ ? at(decode_, std::clamp(code, 0.0, 1.0)) : code;
    }
    void encode(std::vector<double>& values) const {
        if (!is_light_) return;
        for (double& value : values)
            value = of(value);
    }

  private:
    /// Straight lines between this many have an error of 1e-6; the bounds are 1/255 and 0.02.
    static constexpr std::size_t kSteps = 4096;

    static double at(const std::vector<double>& table, double x) {
        const double place = x * kSteps;
        const auto i = std::min(static_cast<std::size_t>(place), kSteps - 1);
        return table[i] + (place - static_cast<double>(i)) * (table[i + 1] - table[i]);
    }

    bool is_light_;
    std::vector<double> encode_;  // over the square root of light
    std::vector<double> decode_;
};

TONEWRIGHT_NAMESPACE_END
