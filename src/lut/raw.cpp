// SPDX-License-Identifier: Apache-2.0
#include "lut/raw.h"
#include "base/little_endian.h"
#include "tonewright/lut.h"

#include <fmt/format.h>

#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN

Lut parse_raw_lut(const std::string& path, std::string_view bytes) {
    constexpr std::size_t kNode = 3 * sizeof(float);
    const int n = static_cast<int>(
        std::lround(std::cbrt(static_cast<double>(bytes.size()) / static_cast<double>(kNode))));
    const auto edge = static_cast<std::size_t>(n);
    if (n < 2 || n > 129 || edge * edge * edge * kNode != bytes.size()) {
        throw FileError(fmt::format(
            "read: {}: has {} bytes; expected 12 for each of N x N x N nodes, N in [2, 129]", path,
            bytes.size()));
    }
    Lut lut;
    lut.size = n;
    lut.values = floats_of_little_endian(bytes);
    for (std::size_t i = 0; i < lut.values.size(); ++i) {
        if (!std::isfinite(lut.values[i])) {
            throw FileError(fmt::format("read: {}: number {} is {}; expected a finite number", path,
                                        i + 1, lut.values[i]));
        }
    }
    return lut;
}

TONEWRIGHT_NAMESPACE_END
