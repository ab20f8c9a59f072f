// SPDX-License-Identifier: Apache-2.0
//
// Layout of the file: Microsoft, "Programming Guide for DDS" and "DXGI_FORMAT enumeration".
#include "lut/dds.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/half_value.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kHeader = 4 + 124;  // the magic number, and the header
constexpr std::size_t kDx10Header = 20;

constexpr std::size_t kHeight = 12;
constexpr std::size_t kWidth = 16;
constexpr std::size_t kDepth = 24;
constexpr std::size_t kPixelFormat = 84;  // its four letters, or a number

enum class Texel : unsigned char { rgb9e5, rgba16f, rgba32f };

std::size_t size_of(Texel texel) {
    if (texel == Texel::rgb9e5) return 4;
    return texel == Texel::rgba16f ? 8 : 16;
}

std::uint32_t number_at(std::string_view bytes, std::size_t at, std::size_t size = 4) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
    return value;
}

float float_of(std::uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

/// Channel c of a texel.
float channel_of(Texel texel, std::string_view bytes, std::size_t c) {
    switch (texel) {
        case Texel::rgb9e5: {  // three 9-bit mantissas, and the exponent above them
            constexpr int kBias = 15 + 9;
            const std::uint32_t packed = number_at(bytes, 0);
            const auto mantissa = static_cast<float>(packed >> (9 * c) & 0x1FFU);
            return std::ldexp(mantissa, static_cast<int>(packed >> 27U) - kBias);
        }
        case Texel::rgba16f:
            return static_cast<float>(half_value(number_at(bytes, 2 * c, 2)));
        case Texel::rgba32f:
            break;
    }
    return float_of(number_at(bytes, 4 * c));
}

}  // namespace

Lut parse_dds(const std::string& path, std::string_view bytes) {
    const auto refuse = [&](const std::string& reason) {
        throw FileError("read: " + path + ": " + reason);
    };
    if (bytes.size() < kHeader || bytes.substr(0, 4) != "DDS " || number_at(bytes, 4) != 124)
        refuse("expected a DDS file");
    const std::uint32_t depth = number_at(bytes, kDepth);
    const std::uint32_t width = number_at(bytes, kWidth);
    const std::uint32_t height = number_at(bytes, kHeight);
    if (width != height || width != depth || width < 2 || width > 129) {
        refuse(fmt::format("has {} x {} x {} texels; expected a volume of N x N x N, N in [2, 129]",
                           width, height, depth));
    }
    const std::string_view code = bytes.substr(kPixelFormat, 4);
    std::size_t at = kHeader;
    std::uint32_t format = number_at(bytes, kPixelFormat);
    const bool has_dx10 = code == "DX10";
    if (has_dx10) {
        if (bytes.size() < kHeader + kDx10Header) refuse("ends in its header");
        format = number_at(bytes, kHeader);
        at += kDx10Header;
    }
    struct Known {
        std::uint32_t dxgi;
        std::uint32_t d3d9;
        Texel texel;
    };
    constexpr Known kKnown[] = {
        {2, 116, Texel::rgba32f}, {10, 113, Texel::rgba16f}, {67, 0, Texel::rgb9e5}};
    const Known* found = nullptr;
    for (const Known& known : kKnown) {
        if (format != 0 && format == (has_dx10 ? known.dxgi : known.d3d9)) found = &known;
    }
    if (!found) {
        refuse(fmt::format("format is {}; expected R9G9B9E5, RGBA16F or RGBA32F, uncompressed",
                           has_dx10 ? fmt::format("DXGI {}", format) : printable(code)));
    }
    const std::size_t texel = size_of(found->texel);
    const std::size_t count = std::size_t{width} * width * width;
    if (bytes.size() - at < count * texel) {
        refuse(fmt::format("ends early, after {} of {} bytes", bytes.size(), at + count * texel));
    }
    Lut lut;
    lut.size = static_cast<int>(width);
    lut.values.reserve(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            lut.values.push_back(channel_of(found->texel, bytes.substr(at + i * texel, texel), c));
            if (!std::isfinite(lut.values.back()))
                refuse(fmt::format("texel {} is {}; expected finite numbers", i + 1,
                                   lut.values.back()));
        }
    }
    return lut;
}

TONEWRIGHT_NAMESPACE_END
