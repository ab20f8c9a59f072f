// SPDX-License-Identifier: Apache-2.0
//
// Numbers, vectors and matrices of shaders, as arrays of expressions.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct GlslType {
    enum class Base : unsigned char { boolean, integer, number };
    Base base = Base::number;
    std::size_t size = 1;    // components of a vector; rows and columns of a matrix
    bool is_matrix = false;  // components are row by row
    bool is_hlsl = false;    // of a matrix: its constructor takes rows, mul() multiplies

    [[nodiscard]] std::size_t components() const { return is_matrix ? size * size : size; }
    [[nodiscard]] bool is_scalar() const { return size == 1; }
    [[nodiscard]] bool is_vector() const { return size > 1 && !is_matrix; }
    friend bool operator==(const GlslType&, const GlslType&) = default;
};

/// The type of this name, of GLSL or HLSL: `vec3`, `float3x3`. Empty: no type that is read.
[[nodiscard]] std::optional<GlslType> glsl_type(std::string_view name);
/// The name in GLSL: `vec3`.
[[nodiscard]] std::string glsl_name(const GlslType& type);

struct GlslValue {
    GlslType type;
    std::vector<Expr> e;
    int depth = 1;  // of operations that depend on each other, at least as many as there are
};

/// An argument that a function or operator does not accept. The parser knows the position.
class GlslMisuse : public Error {
  public:
    using Error::Error;
};

/// Scalars beside vectors count for every component.
/// @throws GlslMisuse
[[nodiscard]] GlslValue glsl_binary(std::string_view sign, const GlslValue& a, const GlslValue& b);
[[nodiscard]] GlslValue glsl_negative(const GlslValue& a);
[[nodiscard]] GlslValue glsl_not(const GlslValue& a);
/// @param condition  a boolean, or one for each component
[[nodiscard]] GlslValue glsl_select(const GlslValue& condition, const GlslValue& yes,
                                    const GlslValue& no);
/// `vec3(...)`: the parts one after the other, or one number for all components.
[[nodiscard]] GlslValue glsl_construct(const GlslType& type, const std::vector<GlslValue>& parts);
/// True if glsl_convert() does it: numbers become vectors, integers numbers.
[[nodiscard]] bool glsl_converts(const GlslType& from, const GlslType& to);
/// A value as another type.
[[nodiscard]] GlslValue glsl_convert(const GlslValue& value, const GlslType& type);

/// True for a function of GLSL or HLSL that is read.
[[nodiscard]] bool is_glsl_function(std::string_view name);
/// @pre is_glsl_function(name)
[[nodiscard]] GlslValue glsl_call(std::string_view name, const std::vector<GlslValue>& in);
/// Why a function is not read, or an empty text.
[[nodiscard]] std::string why_no_glsl_function(std::string_view name);
/// Names of all functions, for messages.
[[nodiscard]] std::vector<std::string> glsl_functions();

TONEWRIGHT_NAMESPACE_END
