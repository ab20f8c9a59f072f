// SPDX-License-Identifier: Apache-2.0
#include "picture/png_chunks.h"

#include <gtest/gtest.h>

#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(PngChunks, HaveLengthTypeDataAndChecksum) {
    // The last chunk of every PNG file.
    EXPECT_EQ(png_chunk("IEND", ""), std::string("\0\0\0\0IEND\xAE\x42\x60\x82", 12));
    // Checksums by zlib. Code points: H.273, BT.2020 is 9, P3-D65 is 12, PQ is 16, HLG is 18.
    EXPECT_EQ(cicp_chunk({9, 16}), std::string("\0\0\0\4cICP\x09\x10\x00\x01\x4D\x23\x23\xFE", 16));
    EXPECT_EQ(cicp_chunk({9, 18}), std::string("\0\0\0\4cICP\x09\x12\x00\x01\x4E\xA7\xF7\x90", 16));
    EXPECT_EQ(cicp_chunk({12, 16}),
              std::string("\0\0\0\4cICP\x0C\x10\x00\x01\x7A\xFD\xD3\xCC", 16));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
