// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/random.h"
#include "lut/clf.h"
#include "lut/half_domain.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"

/// LUTs for tests of several folders.
TONEWRIGHT_NAMESPACE_BEGIN

inline LutRequest request_for(const char* op, const char* encoding,
                              LutFormat format = LutFormat::cube,
                              std::optional<int> size = std::nullopt,
                              const char* display = "srgb") {
    LutRequest r;
    r.encoding = parse_input_encoding(encoding);
    r.view = make_view(resolve_operator(op), r.encoding.default_input, 0, display);
    r.format = format;
    r.size = size;
    return r;
}

/// Table inputs over the cube, with equal fractions (the tetrahedra's faces) among them.
inline std::vector<Vector3> table_inputs(std::size_t count) {
    SampleRandom random(21);
    std::vector<Vector3> inputs = {{0, 0, 0}, {1, 1, 1}, {1, 0, 0.5}, {0.3, 0.3, 0.3}};
    for (std::size_t i = 0; i < count; ++i) {
        Vector3 v = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        if (i % 5 == 0) v[i % 3] = v[(i + 1) % 3];
        inputs.push_back(v);
    }
    return inputs;
}

/// The text of a half-domain table of f.
inline std::string half_table(const Expr& f, bool is_hue_preserving,
                              std::string* extension = nullptr) {
    const std::vector<float> values = sample_half_domain(f, 0, kHalfMax);
    ClfTable table;
    table.size = static_cast<int>(values.size());
    table.is_half_domain = true;
    table.is_hue_preserving = is_hue_preserving;
    table.values = values;
    if (extension) *extension = file_extension(table);
    return write_clf(table, "a < b", {"one & two"});
}

TONEWRIGHT_NAMESPACE_END
