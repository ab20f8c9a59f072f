// SPDX-License-Identifier: Apache-2.0
//
// Rows have the pixels and the metadata of tonemap(), whose values tests/unit/image/ compares with
// formulas.
#include "picture/row_tonemapper.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "image/spec_conversion.h"
#include "picture/picture_error.h"
#include "tonewright/tonemap.h"
#include "unit/errors.h"
#include "unit/image/pictures.h"
#include "unit/image/tonemapped.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Rows [0, count) of a picture without a data window, in a type.
std::vector<std::byte> pixels_of(const ImageBuf& picture, const TypeDesc& type) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(picture.spec().image_pixels()) *
                                 static_cast<std::size_t>(picture.nchannels()) * type.size());
    EXPECT_TRUE(picture.get_pixels(picture.roi(), type, bytes.data()));
    return bytes;
}

void expect_same(const TonemapOptions& options, const ImageBuf& src, const TypeDesc& type) {
    const ImageBuf whole = tonemap(src, options);
    ASSERT_FALSE(whole.has_error()) << whole.geterror();
    const RowTonemapper rows(options);
    const PictureSpec spec = picture_spec(src.spec());
    const ImageSpec result = image_spec(rows.result_spec(spec));
    EXPECT_EQ(result.to_xml(), whole.spec().to_xml());

    ImageSpec typed_spec = whole.spec();
    typed_spec.set_format(type);
    ImageBuf typed(typed_spec);
    ASSERT_TRUE(tonemap(typed, src, options)) << typed.geterror();
    const std::vector<std::byte> expected = pixels_of(typed, type);
    const std::vector<std::byte> from = pixels_of(src, src.spec().format);
    for (const unsigned threads : {1U, 3U}) {
        std::vector<std::byte> to(expected.size());
        rows.run(spec, from.data(), src.spec().height, type, to.data(), threads);
        EXPECT_TRUE(to == expected) << type.c_str() << ", " << threads;
    }
}

TEST(RowTonemapper, RowsHaveThePixelsAndTheMetadataOfPictures) {
    const std::vector<std::vector<std::string>> names = {
        {"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}, {"R", "G", "B", "Z", "A"}};
    const TonemapOptions golden = {.op = resolve_picture_operator("agx_sobotka", {}, "golden"),
                                   .exposure_stops = 1,
                                   .dither = true};
    for (const std::vector<std::string>& channels : names) {
        for (const TypeDesc::BASETYPE type : {TypeDesc::HALF, TypeDesc::UINT8, TypeDesc::FLOAT}) {
            // More pixels than a task has, in rows that spans do not divide.
            const ImageBuf src = make_picture(make_spec(1500, 40, channels, type), 7);
            for (const TypeDesc::BASETYPE to :
                 {TypeDesc::HALF, TypeDesc::FLOAT, TypeDesc::UINT16}) {
                expect_same(hable(), src, to);
                expect_same(golden, src, to);
            }
        }
    }
}

TEST(RowTonemapper, MetadataOfTheResultIsThatOfThePicture) {
    ImageSpec spec = make_spec(4, 3, {"R", "G", "B", "A"}, TypeDesc::HALF);
    spec.x = 2;
    spec.y = -3;
    spec.full_x = -4;
    spec.full_width = 30;
    spec.tile_width = spec.tile_height = 16;
    spec.tile_depth = 1;
    spec.attribute("oiio:SHA-1", "0123");
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("Orientation", 6);
    spec.attribute("compression", "dwaa:30");
    const char* views[] = {"left", "right"};
    spec.attribute("multiView", TypeDesc(TypeDesc::STRING, 2), views);
    const ImageBuf src = make_picture(spec);
    for (const char* display : {"srgb", "rec2100_pq", "native"}) {
        TonemapOptions options = hable();
        options.display = display;
        EXPECT_EQ(image_spec(RowTonemapper(options).result_spec(picture_spec(spec))).to_xml(),
                  tonemap(src, options).spec().to_xml());
    }
    // Statistics change no metadata.
    const TonemapOptions reinhard = {.op = resolve_picture_operator("reinhard_devlin")};
    const RowTonemapper measuring(reinhard);
    ASSERT_TRUE(measuring.takes_statistics());
    EXPECT_EQ(image_spec(measuring.result_spec(picture_spec(spec))).to_xml(),
              tonemap(src, reinhard).spec().to_xml());
}

TEST(RowTonemapper, WrongPicturesAreRefused) {
    const RowTonemapper rows(hable());
    PictureSpec spec = picture_spec(make_spec(2, 2, {"R", "G"}, TypeDesc::FLOAT));
    EXPECT_THROW((void)rows.result_spec(spec), PictureError);
    spec = picture_spec(make_spec(2, 2, {"R", "G", "B"}, TypeDesc::UINT64));
    EXPECT_THROW((void)rows.result_spec(spec), PictureError);
    spec = picture_spec(make_spec(2, 2, {"R", "G", "B"}, TypeDesc::FLOAT));
    spec.deep = true;
    EXPECT_EQ(error_of([&] { (void)rows.result_spec(spec); }),
              "source is deep; expected flat pixels (oiiotool --flatten)");
    spec.deep = false;
    spec.depth = 2;
    EXPECT_NO_THROW((void)rows.result_spec(spec));
    const RowTonemapper local({.op = resolve_picture_operator("reinhard_local")});
    ASSERT_TRUE(local.needs_whole_picture());
    EXPECT_EQ(error_of([&] { (void)local.result_spec(spec); }),
              "picture has 2 slices; expected one: local operators work on flat pictures");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
