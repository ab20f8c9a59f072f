// SPDX-License-Identifier: Apache-2.0
#include "formula/glsl_products.h"

#include <algorithm>

TONEWRIGHT_NAMESPACE_BEGIN
namespace glsl {

void make_product(std::vector<GlslProduct>& products, GlslValue& value, const GlslValue& a,
                  const GlslValue& b) {
    const bool is_row = b.type.is_matrix;
    const GlslValue& matrix = is_row ? b : a;
    const GlslValue& color = is_row ? a : b;
    const auto is_constant = [](const Expr& e) { return e.is_constant(); };
    const bool is_product = matrix.type.is_matrix && matrix.type.size == 3 &&
                            color.type.is_vector() &&
                            std::all_of(matrix.e.begin(), matrix.e.end(), is_constant) &&
                            !std::all_of(color.e.begin(), color.e.end(), is_constant);
    if (!is_product) return;
    GlslProduct product{{}, {color.e[0], color.e[1], color.e[2]}};
    for (std::size_t i = 0; i < 9; ++i)
        product.matrix.at(i / 3).at(i % 3) = matrix.e[is_row ? i % 3 * 3 + i / 3 : i].value();
    const auto is_same = [&](const GlslProduct& other) {
        return other.matrix == product.matrix && same(other.color[0], product.color[0]) &&
               same(other.color[1], product.color[1]) && same(other.color[2], product.color[2]);
    };
    const auto known = std::find_if(products.begin(), products.end(), is_same);
    const auto k = 1 + static_cast<std::size_t>(known - products.begin());
    if (known == products.end()) products.push_back(std::move(product));
    for (std::size_t i = 0; i < 3; ++i)
        value.e[i] = Expr::input(static_cast<int>(3 * k + i));
}

}  // namespace glsl
TONEWRIGHT_NAMESPACE_END
