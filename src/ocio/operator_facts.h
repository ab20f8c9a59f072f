// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ocio/lower.h"

TONEWRIGHT_NAMESPACE_BEGIN

// Facts about single operators that only OpenColorIO and its configs need. The tables are data: an
// operator without a row is lowered by its structure.

/// An operator that equals one of OpenColorIO's built-in transforms from ACES2065-1 to CIE XYZ D65.
struct BuiltinRow {
    std::string_view op;
    Settings settings;       // the others are the defaults
    std::string_view style;  // after kBuiltinPrefix
};
inline constexpr const char* kBuiltinPrefix = "ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - ";
[[nodiscard]] TONEWRIGHT_API const std::vector<BuiltinRow>& builtin_rows();

/// The style of the built-in transform that the operator with its parameters equals; empty: none.
[[nodiscard]] TONEWRIGHT_API std::string builtin_style(const ResolvedOperator& op);

/// Sentence for descriptions, with a leading space, if Blender's view of the same name
/// intentionally differs; otherwise empty.
[[nodiscard]] std::string blender_difference(const ResolvedOperator& op);

/// Ids of the operators whose 3D LUTs are fitted, because they bend in many directions.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string_view>& fitted_operators();

/// Options for lowering the operator's views.
/// @param cache_folder  @see LowerOptions
[[nodiscard]] TONEWRIGHT_API LowerOptions lower_options(const Operator& op,
                                                        const std::string& cache_folder = {});

TONEWRIGHT_NAMESPACE_END
