// SPDX-License-Identifier: Apache-2.0
#include "shader/measured_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "base/format_number.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kMostImplementations = 8;
struct MeasuredErrors {
    std::string_view definition;
    std::array<double, kMostImplementations> errors;
};

#include "shader/measured_errors.inc"

}  // namespace

std::string measured_errors(std::string_view definition) {
    const auto* const row =
        std::find_if(std::begin(kMeasured), std::end(kMeasured),
                     [&](const MeasuredErrors& m) { return m.definition == definition; });
    std::string text;
    for (std::size_t i = 0; row != std::end(kMeasured) && i < kImplementations.size(); ++i) {
        if (row->errors[i] < 0) continue;
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", rounded_up(row->errors[i]),
                            kImplementations[i]);
    }
    return text;
}

TONEWRIGHT_NAMESPACE_END
