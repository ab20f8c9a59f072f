// SPDX-License-Identifier: Apache-2.0
#include "lut/dds.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void append(std::string& bytes, std::uint32_t value, std::size_t size = 4) {
    for (std::size_t i = 0; i < size; ++i)
        bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
}

/// A volume of 2 texels a side with the header of Direct3D 10.
std::string dds_of(std::uint32_t dxgi, const std::string& texels) {
    std::string bytes = "DDS ";
    for (const std::uint32_t value : {124U, 0x801007U, 2U, 2U, 0U, 2U, 1U})
        append(bytes, value);
    bytes.resize(4 + 72, '\0');
    append(bytes, 32);
    append(bytes, 4);
    bytes += "DX10";
    bytes.resize(128, '\0');
    for (const std::uint32_t value : {dxgi, 4U, 0U, 1U, 0U})
        append(bytes, value);
    return bytes + texels;
}

std::string error_of(const std::string& bytes) {
    try {
        (void)parse_dds("a.dds", bytes);
    } catch (const FileError& e) {
        return e.what();
    }
    return "no error";
}

TEST(Dds, ReadsSharedExponents) {
    // DXGI_FORMAT_R9G9B9E5_SHAREDEXP: mantissa/512 * 2^(exponent - 15). Nine bits of 256 are 1/2.
    std::string texels;
    append(texels, 256U | 128U << 9U | 511U << 18U | 15U << 27U);
    append(texels, 1U | 0U << 9U | 256U << 18U | 16U << 27U);
    append(texels, 1U);  // the smallest number: 2^-24
    for (int i = 3; i < 8; ++i)
        append(texels, 0);
    const Lut lut = parse_dds("a.dds", dds_of(67, texels));
    EXPECT_EQ(lut.size, 2);
    const std::vector<float> first(lut.values.begin(), lut.values.begin() + 7);
    EXPECT_EQ(first, (std::vector<float>{0.5F, 0.25F, 511.0F / 512, 1.0F / 256, 0, 1, 0x1p-24F}));
}

TEST(Dds, ReadsHalfAndSingleFloats) {
    std::string halves;
    std::string singles;
    for (int i = 0; i < 8; ++i) {
        for (const std::uint32_t bits : {0x3C00U, 0xC000U, 0x3555U, 0x3C00U})  // 1, -2, 0.33325, 1
            append(halves, bits, 2);
        for (const std::uint32_t bits : {0x3F800000U, 0xC0000000U, 0x3EAAA000U, 0x3F800000U})
            append(singles, bits);
    }
    for (const Lut& lut :
         {parse_dds("a.dds", dds_of(10, halves)), parse_dds("a.dds", dds_of(2, singles))}) {
        EXPECT_EQ(lut.values.size(), 24U);
        EXPECT_EQ(lut.values[21], 1);
        EXPECT_EQ(lut.values[22], -2);
        EXPECT_EQ(lut.values[23], 0.333251953125F);
    }
}

TEST(Dds, RefusesEverythingElse) {
    const std::string good = dds_of(67, std::string(32, '\0'));
    EXPECT_EQ(error_of(good), "no error");
    for (std::size_t length = 0; length < good.size(); ++length) {
        const std::string error = error_of(good.substr(0, length));
        EXPECT_EQ(error.find("read: a.dds: "), 0U) << length << ": " << error;
    }
    EXPECT_EQ(error_of(good.substr(0, good.size() - 1)),
              "read: a.dds: ends early, after 179 of 180 bytes");
    EXPECT_EQ(
        error_of(dds_of(98, std::string(32, '\0'))),
        "read: a.dds: format is DXGI 98; expected R9G9B9E5, RGBA16F or RGBA32F, uncompressed");
    std::string flat = good;
    flat[24] = 1;
    EXPECT_EQ(error_of(flat),
              "read: a.dds: has 2 x 2 x 1 texels; expected a volume of N x N x N, N "
              "in [2, 129]");
    std::string infinite(64, '\0');
    infinite[1] = 0x7C;
    EXPECT_EQ(error_of(dds_of(10, infinite)),
              "read: a.dds: texel 1 is inf; expected finite numbers");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
