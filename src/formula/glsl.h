// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formula/formula.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A number that stays a parameter: a further argument of the function, or a uniform.
struct GlslParameter {
    std::string name;
    double value = 0;
    TextPosition at;
};

/// A matrix of numbers times a color. Later expressions read the product as inputs 3k, 3k + 1, 3k +
/// 2, where k is 1 for the first product.
struct GlslProduct {
    std::array<std::array<double, 3>, 3> matrix{};
    std::array<Expr, 3> color;
};

/// A value that the shader has a name for.
struct GlslName {
    Expr value;
    std::string variable;
    std::size_t component = 0;
    std::size_t components = 1;
};

/// A function of a shader as expressions.
struct GlslFunction {
    std::string name;
    TextPosition at;
    /// False: `float f(float)`, whose one value is of input 0. True: `vec3 f(vec3)`, whose three
    /// are of inputs 0, 1, 2 and of those of `products`.
    bool is_color = false;
    std::vector<Expr> values;
    std::vector<GlslProduct> products;
    std::vector<GlslName> names;
    std::vector<GlslParameter> parameters;
    /// Names of other functions that could have been taken.
    std::vector<std::string> others;
};

struct GlslSettings {
    /// Name of the function; empty: the last one that no other function calls.
    std::string function;
    /// Values of further arguments and uniforms. Those that the shader does not have are ignored.
    std::map<std::string, double, std::less<>> parameters;
    /// GLSL does not define powers and square roots of negatives: count the negatives as 0.
    bool limits_powers = false;
};

inline constexpr std::size_t kLongestShader = kLongestFormula;  // bytes

/// Reads a function of straight-line GLSL or HLSL; docs/tone_files.md lists what is supported.
/// @throws FormulaError
[[nodiscard]] TONEWRIGHT_API GlslFunction parse_glsl(std::string_view text,
                                                     const GlslSettings& settings);

TONEWRIGHT_NAMESPACE_END
