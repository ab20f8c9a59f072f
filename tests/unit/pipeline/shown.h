// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>

#include "tonewright/pipeline.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/errors.h"

/// Results of pipelines, for tests of pipelines and operators.
TONEWRIGHT_NAMESPACE_BEGIN

/// By plain recursion over the expressions: no engine is under test here.
inline Vector3 shown(const Pipeline& pipeline, const Vector3& rgb) {
    const std::array<Expr, 3> f = compose(pipeline);
    return {evaluate(f[0], rgb), evaluate(f[1], rgb), evaluate(f[2], rgb)};
}

inline void expect_rgb(const Vector3& actual, const Vector3& expected, double tolerance,
                       const std::string& what = "") {
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(actual[c], expected[c], tolerance) << what << ", channel " << c;
    }
}

/// Sums and products of a few doubles in another order: some units of 2^-53.
inline constexpr double kRounding = 1e-14;

inline std::string resolve_error(std::string_view name, const Settings& settings = {},
                                 std::string_view look = {}) {
    return error_of([&] { (void)resolve_operator(name, settings, look); });
}

inline Pipeline view_of(std::string_view op, std::string_view display, double stops = 0,
                        std::string_view input = "lin_rec709") {
    return build_view(make_view(resolve_operator(op), input, stops, display));
}

TONEWRIGHT_NAMESPACE_END
