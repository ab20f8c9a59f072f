// SPDX-License-Identifier: Apache-2.0
#include "picture/png_chunks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void append_big_endian(std::string& to, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0})
        to += static_cast<char>(value >> shift & 255U);
}

/// ISO 3309, as in W3C PNG (third edition), 5.5.
std::uint32_t checksum(std::string_view bytes) {
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit)
            crc = (crc & 1U) != 0 ? 0xEDB88320U ^ crc >> 1 : crc >> 1;
    }
    return ~crc;
}

}  // namespace

std::string png_chunk(std::string_view type, std::string_view data) {
    std::string chunk;
    append_big_endian(chunk, static_cast<std::uint32_t>(data.size()));
    chunk += type;
    chunk += data;
    append_big_endian(chunk, checksum(std::string_view(chunk).substr(4)));
    return chunk;
}

std::string cicp_chunk(const CodePoints& points) {
    constexpr char kRgb = 0;  // H.273, table 4: matrix coefficients
    constexpr char kFullRange = 1;
    const std::array<char, 4> data = {static_cast<char>(points.primaries),
                                      static_cast<char>(points.transfer), kRgb, kFullRange};
    return png_chunk("cICP", {data.data(), data.size()});
}

std::string clli_chunk(const LightLevels& levels) {
    std::string data;
    for (const double level : {levels.largest, levels.mean}) {
        constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
        append_big_endian(
            data, static_cast<std::uint32_t>(std::clamp(std::round(level * 1e4), 0.0, kMost)));
    }
    return png_chunk("cLLI", data);
}

TONEWRIGHT_NAMESPACE_END
