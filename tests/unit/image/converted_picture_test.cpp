// SPDX-License-Identifier: Apache-2.0
#include "image/converted_picture.h"

#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include "image/spec_conversion.h"
#include "picture/header_tags.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;

TEST(ConvertedPicture, PicturesAreTurnedWithTheirMetadata) {
    // Exif's corners of the first row and the first column: JEITA CP-3451, 4.6.4. The stored pixel
    // 0,0 must come to that corner, and 1,0 beside it along the row.
    struct Corner {
        int orientation, x, y, next_x, next_y;
    };
    for (const Corner& c : {Corner{1, 0, 0, 1, 0}, Corner{2, 3, 0, 2, 0}, Corner{3, 3, 2, 2, 2},
                            Corner{4, 0, 2, 1, 2}, Corner{5, 0, 0, 0, 1}, Corner{6, 2, 0, 2, 1},
                            Corner{7, 2, 3, 2, 2}, Corner{8, 0, 3, 0, 2}}) {
        OIIO::ImageSpec spec(4, 3, 4, OIIO::TypeDesc::UINT8);
        spec.attribute("Orientation", c.orientation);
        spec.attribute(file_tag::kFormat, "jpeg");
        ImageBuf stored(spec);
        OIIO::ImageBufAlgo::zero(stored);
        const float first[4] = {1, 0, 0, 1};
        const float second[4] = {0, 1, 0, 1};
        stored.setpixel(0, 0, first);
        stored.setpixel(1, 0, second);
        const ImageBuf turned = upright(stored);
        EXPECT_EQ(turned.getchannel(c.x, c.y, 0, 0), 1) << c.orientation;
        EXPECT_EQ(turned.getchannel(c.next_x, c.next_y, 0, 1), 1) << c.orientation;
        EXPECT_EQ(turned.spec().format, OIIO::TypeUInt8);
        EXPECT_EQ(turned.spec().alpha_channel, 3);
        EXPECT_EQ(orientation_of(picture_spec(turned.spec())), 1);
        EXPECT_EQ(turned.spec().get_string_attribute(file_tag::kFormat), "jpeg");
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
