// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "formula/glsl.h"

TONEWRIGHT_NAMESPACE_BEGIN

using Color = std::array<double, 3>;

/// The function of a shader at a color, matrix by matrix.
inline Color value_at(const std::string& shader, const Color& in) {
    const GlslFunction f = parse_glsl(shader, {});
    std::vector<double> inputs(in.begin(), in.end());
    for (const GlslProduct& product : f.products) {
        Color color{};
        for (std::size_t i = 0; i < 3; ++i)
            color.at(i) = evaluate(product.color.at(i), inputs);
        for (const auto& row : product.matrix)
            inputs.push_back(row[0] * color[0] + row[1] * color[1] + row[2] * color[2]);
    }
    Color result{};
    for (std::size_t i = 0; i < f.values.size(); ++i)
        result.at(i) = evaluate(f.values[i], inputs);
    return result;
}

TONEWRIGHT_NAMESPACE_END
