// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_header.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "picture/exr_reader.h"
#include "unit/folder.h"
#include "unit/picture/exr_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;

TEST(ExrHeader, NamesOfCompressionsAreThoseOfOpenImageIO) {
    for (const char* name :
         {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
        const auto compression = compression_of(name);
        ASSERT_TRUE(compression) << name;
        EXPECT_EQ(compression_name(*compression), name);
    }
    EXPECT_FALSE(compression_of("lzw"));
    EXPECT_EQ(compression_name(EXR_COMPRESSION_LAST_TYPE), "");
}

TEST(ExrHeader, ChannelsHaveTheOrderOfOpenImageIO) {
    const Folder folder;
    const std::vector<std::vector<std::string>> lists = {
        {"B", "A", "G", "R", "Z"},
        {"b", "g", "r", "a", "depth"},
        {"Y", "A"},
        {"X", "Y", "Z"},
        {"N.z", "N.x", "N.Y", "N.A"},
        {"X", "R", "Alpha"},
        {"left.R", "R", "left.A", "left.G", "G", "B", "left.B", "right.Z"},
        {"AB", "AG", "AR", "B", "G", "R"},
        {"RA", "BA", "GA", "Zback", "Z", "u", "imag", "real"},
        {"layer.sub.B", "layer.B", "layer.sub.R", "layer.R", "layer.", "x.Blue", "x.Red"}};
    for (const auto& names : lists) {
        const ImageSpec spec = spec_of_size(4, 4, names, OIIO::TypeHalf);
        write_by_oiio(folder / "names.exr", {spec}, 1);
        std::string error;
        const std::vector<ReadPicture> expected = read_by_oiio(folder / "names.exr", &error);
        ASSERT_EQ(error, "");
        const auto reader = open_exr(folder / "names.exr", 1);
        ASSERT_TRUE(reader);
        expect_same_spec(expected.at(0).spec, reader->spec(0));
    }
}

/// Textures have levels, of which the first is read.
TEST(ExrHeader, TexturesHaveTheAttributesOfOpenImageIO) {
    const Folder folder;
    OIIO::ImageBuf picture(ImageSpec(64, 32, 3, OIIO::TypeHalf));
    OIIO::ImageBufAlgo::noise(picture, "uniform", 0.0F, 1.0F);
    using OIIO::ImageBufAlgo::MakeTextureMode;
    for (const MakeTextureMode mode :
         {OIIO::ImageBufAlgo::MakeTxTexture, OIIO::ImageBufAlgo::MakeTxEnvLatl}) {
        const std::string path = folder / "texture.exr";
        ASSERT_TRUE(OIIO::ImageBufAlgo::make_texture(mode, picture, path, ImageSpec()));
        std::string error;
        const std::vector<ReadPicture> expected = read_by_oiio(path, &error);
        ASSERT_EQ(error, "");
        const auto reader = open_exr(path, 1);
        ASSERT_TRUE(reader);
        expect_same_spec(expected.at(0).spec, reader->spec(0));
        EXPECT_TRUE(all_rows(*reader, 0, 64) == expected.at(0).pixels);
    }
}

TEST(ExrHeader, TypesAndSizesOfChannels) {
    EXPECT_TRUE(type_of(EXR_PIXEL_HALF) == OIIO::TypeHalf);
    EXPECT_TRUE(type_of(EXR_PIXEL_FLOAT) == OIIO::TypeFloat);
    EXPECT_TRUE(type_of(EXR_PIXEL_UINT) == OIIO::TypeUInt32);
    for (const exr_pixel_type_t type : {EXR_PIXEL_HALF, EXR_PIXEL_FLOAT, EXR_PIXEL_UINT})
        EXPECT_EQ(pixel_type_of(type_of(type)), type);
    ExrPart part;
    part.channels = {{.name = "A", .type = EXR_PIXEL_HALF}, {.name = "Z", .type = EXR_PIXEL_FLOAT}};
    EXPECT_EQ(part.pixel_bytes(), 6U);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
