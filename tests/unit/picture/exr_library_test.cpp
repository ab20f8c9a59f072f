// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_library.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kWidth = 100;
constexpr int kRows = 21;

class ExrLibraryOf : public testing::TestWithParam<exr_compression_t> {};

// Rows of planes with numbers that repeat. OpenEXR's documentation: B44 does not compress UINT and
// FLOAT, and DWAA and DWAB lose nothing of channels that are not colors. All others are tested with
// files, in exr_reader_test.cpp and exr_writer_test.cpp.
Bytes planes() {
    Bytes result(kWidth * 8 * kRows);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = static_cast<std::uint8_t>(i % 4 == 0 ? i / 4 % 7 : 0);
    return result;
}

ExrLibrary library_of(exr_compression_t compression, const std::string& name) {
    return {{{.name = name, .type = EXR_PIXEL_FLOAT}, {.name = "id", .type = EXR_PIXEL_UINT}},
            kWidth,
            compression};
}

TEST_P(ExrLibraryOf, KeepsDataThatAreNoColors) {
    for (const std::string& name : {std::string("Z"), std::string(255, 'Z')}) {
        const ExrLibrary library = library_of(GetParam(), name);
        const Bytes packed = library.pack(planes());
        EXPECT_LE(packed.size(), planes().size());
        Bytes unpacked(planes().size());
        library.unpack(packed.data(), packed.size(), kRows, unpacked.data());
        EXPECT_TRUE(unpacked == planes());
    }
}

TEST_P(ExrLibraryOf, ReportsBlocksThatAreCutOff) {
    const ExrLibrary library = library_of(GetParam(), "Z");
    const Bytes packed = library.pack(planes());
    Bytes unpacked(planes().size());
    for (const std::size_t left : {std::size_t{1}, packed.size() / 2})
        EXPECT_THROW(library.unpack(packed.data(), left, kRows, unpacked.data()), FileError)
            << left;
}

INSTANTIATE_TEST_SUITE_P(All, ExrLibraryOf,
                         testing::Values(EXR_COMPRESSION_B44, EXR_COMPRESSION_B44A,
                                         EXR_COMPRESSION_DWAA, EXR_COMPRESSION_DWAB));

TEST(ExrLibrary, KnowsWhatTheCoreOfVersion31Lacks) {
    for (const auto compression : {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                   EXR_COMPRESSION_ZIP, EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24})
        EXPECT_FALSE(ExrLibrary::knows(compression));
    EXPECT_TRUE(ExrLibrary::knows(EXR_COMPRESSION_DWAA));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
