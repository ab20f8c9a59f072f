// SPDX-License-Identifier: Apache-2.0
#include "base/ktx2.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

unsigned number_at(const std::string& bytes, std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8U | static_cast<unsigned char>(bytes.at(at + i));
    return value;
}

TEST(Ktx2, HeaderAndTexelsAreWhereTheSpecificationHasThem) {
    const std::vector<float> rgba = {0, 0.5, 0.25, 1, 1, 2, -1, 1};
    const std::string half = ktx2_file(rgba, {2, 1, 1}, Ktx2Texel::half, "");
    const std::string single = ktx2_file(rgba, {2, 1, 1}, Ktx2Texel::single, "a note");
    EXPECT_EQ(half.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    EXPECT_EQ(number_at(half, 12), 97U) << "VK_FORMAT_R16G16B16A16_SFLOAT";
    EXPECT_EQ(number_at(single, 12), 109U) << "VK_FORMAT_R32G32B32A32_SFLOAT";
    EXPECT_EQ(number_at(half, 16), 2U);
    EXPECT_EQ(number_at(half, 20), 2U);
    EXPECT_EQ(number_at(half, 28), 0U) << "pixelDepth of a 2D texture";
    EXPECT_EQ(number_at(ktx2_file(std::vector<float>(32), {2, 2, 2}, Ktx2Texel::half, ""), 28), 2U);
    for (const std::string& file : {half, single}) {
        const std::size_t begin = number_at(file, 80);
        EXPECT_EQ(begin % 16, 0U);
        EXPECT_EQ(begin + number_at(file, 88), file.size());
        EXPECT_EQ(number_at(file, number_at(file, 48)), number_at(file, 52))
            << "the descriptor's size";
    }
    EXPECT_EQ(half.substr(half.size() - 16, 8), std::string("\0\0\0\x38\0\x34\0\x3c", 8));
    EXPECT_NE(single.find(std::string("Tonewright\0a note\0", 18)), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
