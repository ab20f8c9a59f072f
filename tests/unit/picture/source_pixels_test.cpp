// SPDX-License-Identifier: Apache-2.0
//
// Channels of pictures. Pixels are in tests/unit/image/source_picture_test.cpp.
#include "picture/source_pixels.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "image/spec_conversion.h"
#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(SourcePixels, MissingNamesAreThoseOfOpenImageIO) {
    for (int count = 0; count < 7; ++count) {
        for (const int alpha : {-1, 1, 9}) {
            OIIO::ImageSpec other(1, 1, count, OIIO::TypeDesc::FLOAT);
            other.default_channel_names();
            PictureSpec spec;
            spec.nchannels = count;
            spec.alpha_channel = alpha;
            spec.z_channel = 8;
            complete_channel_names(spec);
            EXPECT_EQ(spec.channelnames, other.channelnames);
            // The reader's alpha stays where there is such a channel.
            EXPECT_EQ(spec.alpha_channel, alpha == 1 && count > 1 ? 1 : other.alpha_channel);
            EXPECT_EQ(spec.z_channel, -1);
        }
    }
    PictureSpec named;
    named.nchannels = 1;
    named.channelnames = {"depth"};
    complete_channel_names(named);
    EXPECT_EQ(named.channelnames, std::vector<std::string>{"depth"});
}

TEST(SourcePixels, AlphaIsFoundByItsName) {
    PictureSpec spec;
    spec.nchannels = 2;
    for (const char* name : {"A", "alpha", "ALPHA", "beauty.a", "x.y.Alpha"}) {
        spec.channelnames = {"Y", name};
        EXPECT_EQ(channel_layout(spec).alpha, 1) << name;
    }
    for (const char* name : {"alphabet", "x", ".alpha.x", ""}) {
        spec.channelnames = {"Y", name};
        EXPECT_THROW((void)channel_layout(spec), PictureError) << name;
    }
}

TEST(SourcePixels, TypesWithoutPixelsAreRefused) {
    EXPECT_NO_THROW(check_pixel_type("source", OIIO::TypeDesc::HALF));
    EXPECT_EQ(error_of([] { check_pixel_type("source", OIIO::TypeDesc::UINT64); }),
              "source pixel type is uint64; expected an integer of 8, 16 or 32 bits, half, float "
              "or double");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
