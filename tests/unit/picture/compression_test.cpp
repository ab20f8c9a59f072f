// SPDX-License-Identifier: Apache-2.0
#include "picture/compression.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <string>

#include "image/spec_conversion.h"
#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string refusal(const char* codec, const CompressionOptions& options) {
    return error_of([&] { check_compression("a", codec, options); });
}

TEST(Compression, WhatAFormatLacksIsAnError) {
    EXPECT_EQ(refusal("openexr", {.compression = "dwaa:45"}), "no error");
    EXPECT_EQ(refusal("jpeg", {.quality = 100, .subsampling = "4:2:2"}), "no error");
    EXPECT_EQ(refusal("hdr", {.compression = "zip"}),
              "a: compression is zip; expected none, because hdr has one method only");
    EXPECT_NE(refusal("openexr", {.compression = "zipp"}).find("did you mean zip"),
              std::string::npos);
    EXPECT_EQ(refusal("openexr", {.compression = "dwaa:0"}),
              "a: compression is dwaa:0; expected a quality of 1 or more after the colon");
    EXPECT_EQ(refusal("jpeg", {.quality = 101}), "a: quality is 101; expected [1, 100]");
    EXPECT_EQ(refusal("png", {.quality = 50}),
              "a: quality is 50; expected none, because png is lossless");
    EXPECT_EQ(refusal("webp", {.subsampling = "4:4:4"}),
              "a: subsampling is 4:4:4; expected none, because the writer of WebP has one kind "
              "only (4:2:0)");
    EXPECT_NE(refusal("jpeg", {.subsampling = "444"}).find("expected 4:4:4, 4:2:2"),
              std::string::npos);
}

TEST(Compression, TheSourcesStaysIfTheFormatHasIt) {
    const auto set = [](const char* codec, const char* source, const CompressionOptions& options) {
        PictureSpec spec;
        if (*source) spec.attribute("compression", source);
        set_compression(spec, codec, options);
        return spec.get_string_attribute("compression", "default");
    };
    EXPECT_EQ(set("openexr", "piz", {}), "piz");
    EXPECT_EQ(set("openexr", "lzw", {}), "default");
    EXPECT_EQ(set("openexr", "piz", {.compression = "zip"}), "zip");
    EXPECT_EQ(set("openexr", "dwaa:45", {.quality = 30}), "default") << "the number would count";
    EXPECT_EQ(set("avif", "", {.quality = 30}), "avif:30");
}

TEST(Compression, ChromaIsHalvedBelowQuality90) {
    for (const char* stated : {"", "jpeg", "jpeg:50", "jpeg:95", "jpeg:x", "jpeg:"}) {
        for (const int quality : {0, 85, 95}) {
            OIIO::ImageSpec spec;
            if (*stated) spec.attribute("compression", stated);
            if (quality > 0) spec.attribute("CompressionQuality", quality);
            // The quality that OpenImageIO's writer takes; its default is 98.
            const bool is_fine = spec.decode_compression_metadata("jpeg", 98).second >= 90;
            change_spec(spec, [](PictureSpec& of) { set_compression(of, "jpeg", {}); });
            EXPECT_EQ(spec.get_string_attribute("jpeg:subsampling"), is_fine ? "4:4:4" : "4:2:0")
                << stated << " " << quality;
        }
    }
    PictureSpec spec;
    set_compression(spec, "jpeg", {.quality = 50, .subsampling = "4:2:2"});
    EXPECT_EQ(spec.get_string_attribute("jpeg:subsampling"), "4:2:2");
}

TEST(Compression, BlocksOfOpenExr) {
    // OpenEXR 3.1, "OpenEXR File Layout": scan lines per block.
    EXPECT_EQ(rows_of_block("zips"), 1);
    EXPECT_EQ(rows_of_block("zip:6"), 16);
    EXPECT_EQ(rows_of_block("piz"), 32);
    EXPECT_EQ(rows_of_block("dwab:45"), 256);
    EXPECT_EQ(rows_of_block("htj2k"), 0);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
