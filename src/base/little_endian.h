// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

/// Floats as bytes of files and of hashes, the same on every processor.
TONEWRIGHT_NAMESPACE_BEGIN

[[nodiscard]] inline std::string little_endian_bytes(const std::vector<float>& values) {
    std::string bytes;
    bytes.reserve(values.size() * sizeof(float));
    for (const float value : values) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (unsigned shift = 0; shift < 32; shift += 8)
            bytes += static_cast<char>(static_cast<unsigned char>(bits >> shift));
    }
    return bytes;
}

/// Bytes after the last whole float are left out.
[[nodiscard]] inline std::vector<float> floats_of_little_endian(std::string_view bytes) {
    std::vector<float> values(bytes.size() / sizeof(float));
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < sizeof(float); ++k)
            bits |= std::uint32_t{static_cast<unsigned char>(bytes[i * sizeof(float) + k])}
                    << (8 * k);
        values[i] = std::bit_cast<float>(bits);
    }
    return values;
}

TONEWRIGHT_NAMESPACE_END
