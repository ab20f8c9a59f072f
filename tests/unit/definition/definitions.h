// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "tonewright/definition.h"
#include "tonewright/error.h"
#include "tonewright/view.h"

/// Operators from files, for tests of definitions.
TONEWRIGHT_NAMESPACE_BEGIN

inline const std::string kHead = "tonewright = 1\nid = \"my\"\n";
inline const std::string kStage = "[[stage]]\ncurve = \"max(x, 0)\"\n";

inline std::shared_ptr<const Operator> parsed(const std::string& rest) {
    return parse_operator(kHead + rest, "my.tone");
}

inline Pipeline built(const Operator& op, const Settings& settings = {},
                      const std::string& look = {}) {
    return resolve(op, nullptr, settings, look).build();
}

inline void expect_same(const Pipeline& a, const Pipeline& b, const std::string& what) {
    const std::array<Expr, 3> x = compose(a);
    const std::array<Expr, 3> y = compose(b);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_TRUE(same(x.at(i), y.at(i))) << what << ", channel " << i;
}

/// A 3D LUT of two nodes a side that inverts its channels, behind a 1D table that squares 0, 1/2
/// and 1. A file named "stated" says what goes in and comes out.
inline TableFile small_table(const std::string& path) {
    if (path.find("missing") != std::string::npos) throw FileError("read: " + path + ": gone");
    std::vector<double> nodes;
    for (int i = 0; i < 8; ++i) {
        for (const int place : {i / 4, i / 2 % 2, i % 2})
            nodes.push_back(1 - place);
    }
    const auto table = std::make_shared<const Table>(Table{{0, 0.25, 1}});
    TableFile file;
    file.stages = {
        curve_stage(lookup(table, Expr::input())),
        GridStage{Expr::input(), std::make_shared<const Grid>(2, [nodes] { return nodes; })}};
    file.title = "Small";
    if (path.find("stated") != std::string::npos) {
        file.encoding = "log2:-10:6.5";
        file.space = "lin_ap1";
        file.display = "rec1886";
    }
    return file;
}

inline std::array<double, 3> shown_by(const Pipeline& pipeline, double r, double g, double b) {
    const std::array<Expr, 3> rgb = compose(pipeline);
    const std::array<double, 3> in = {r, g, b};
    return {evaluate(rgb[0], in), evaluate(rgb[1], in), evaluate(rgb[2], in)};
}

TONEWRIGHT_NAMESPACE_END
