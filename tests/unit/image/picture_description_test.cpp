// SPDX-License-Identifier: Apache-2.0
//
// Facts in headers. Files of every format are in tests/tags; here are pictures in memory, names of
// layers, and fields of other programs.
#include "image/picture_description.h"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <string>
#include <thread>
#include <vector>

#include "image/header_tags.h"
#include "image/layers.h"
#include "image/picture_file.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

namespace {

using namespace tonewright;  // NOLINT(google-build-using-namespace)
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

ImageSpec spec_of(const std::vector<std::string>& names, const TypeDesc& type = OIIO::TypeHalf) {
    ImageSpec spec(4, 3, static_cast<int>(names.size()), type);
    spec.channelnames = names;
    return spec;
}

std::string picture_of(const std::vector<std::string>& names) {
    const std::vector<Layer> layers = color_layers(spec_of(names));
    const Layer* layer = picture_layer(layers);
    return layer ? layer->name : "none";
}

TEST(Layers, ThePictureIsFoundAmongData) {
    EXPECT_EQ(picture_of({"AO.R", "AO.G", "AO.B", "R", "G", "B"}), "");
    EXPECT_EQ(picture_of({"V.AO.R", "V.AO.G", "V.AO.B", "V.Combined.R", "V.Combined.G",
                          "V.Combined.B", "V.Emit.R", "V.Emit.G", "V.Emit.B"}),
              "V.Combined");
    EXPECT_EQ(picture_of({"Crypto00.r", "Crypto00.g", "Crypto00.b", "Crypto00.a", "beauty.red",
                          "beauty.green", "beauty.blue"}),
              "beauty");
    EXPECT_EQ(
        picture_of({"Normal.X", "Normal.Y", "Normal.Z", "diffuse.R", "diffuse.G", "diffuse.B"}),
        "diffuse");
    EXPECT_EQ(picture_of({"N.R", "N.G", "N.B", "uCryptoAsset.red", "uCryptoAsset.green",
                          "uCryptoAsset.blue"}),
              "none");
    EXPECT_EQ(picture_of({"Z"}), "none");
}

TEST(Layers, NamesAreFoundByTheirLastParts) {
    const std::vector<Layer> layers =
        color_layers(spec_of({"a.beauty.R", "a.beauty.G", "a.beauty.B", "b.beauty.R", "b.beauty.G",
                              "b.beauty.B", "Diffuse.r", "Diffuse.g", "Diffuse.b"}));
    ASSERT_EQ(layers.size(), 3U);
    EXPECT_EQ(find_layer(layers, "beauty"), nullptr) << "two layers have that name";
    EXPECT_EQ(find_layer(layers, "B.Beauty"), &layers[1]);
    EXPECT_EQ(find_layer(layers, "diffuse"), &layers[2]);
    EXPECT_EQ(find_layer(layers, "ffuse"), nullptr);
}

TEST(Layers, PixelsFollowTheirNames) {
    ImageSpec spec = spec_of({"Z", "b", "g", "r"}, OIIO::TypeFloat);
    spec.z_channel = 0;
    const std::vector<Layer> layers = color_layers(spec);
    ASSERT_EQ(layers.size(), 1U);
    const std::vector<int> order = order_of(layers[0], spec);
    EXPECT_EQ(order, (std::vector<int>{3, 2, 1, 0}));
    reorder(spec, order, false);
    EXPECT_EQ(spec.channelnames, (std::vector<std::string>{"R", "G", "B", "Z"}));
    EXPECT_EQ(spec.alpha_channel, -1);
    EXPECT_EQ(spec.z_channel, 3);
    const std::vector<float> from = {9, 3, 2, 1, 8, 6, 5, 4};
    std::vector<float> to(from.size());
    reorder(reinterpret_cast<const std::byte*>(from.data()), 4, order, sizeof(float), 2,
            reinterpret_cast<std::byte*>(to.data()));
    EXPECT_EQ(to, (std::vector<float>{1, 2, 3, 9, 4, 5, 6, 8}));
}

TEST(PictureDescription, ConvertedPixelsAreNotDecodedAgain) {
    ImageSpec spec = spec_of({"R", "G", "B"}, OIIO::TypeUInt8);
    spec.attribute(file_tag::kFormat, "png");
    spec.attribute(file_tag::kColorSpace, "sRGB");
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute(file_tag::kSrgb, 0);
    EXPECT_EQ(source_color(spec, "auto").name, "sRGB");
    // A program has converted them since they were read, and OpenImageIO renames the space.
    spec.attribute("oiio:ColorSpace", "lin_rec709");
    EXPECT_EQ(source_color(spec, "auto").name, "lin_rec709");
}

TEST(PictureDescription, CodePointsComeBeforeAProfileInPngAndAfterItInHeif) {
    for (const auto& [format, rule] : {std::pair("png", "cICP"), std::pair("heif", "nclx")}) {
        ImageSpec spec = spec_of({"R", "G", "B"}, OIIO::TypeUInt16);
        spec.attribute(file_tag::kFormat, format);
        spec.attribute(file_tag::kColorSpace, "");
        const int points[4] = {9, 16, 0, 1};
        spec.attribute(kCicpTag, TypeDesc(TypeDesc::INT, 4), points);
        const PictureDescription said = describe_picture(spec, "auto");
        EXPECT_EQ(said.color.name, "Rec.2100-PQ");
        EXPECT_EQ(said.rule, rule);
        EXPECT_EQ(said.transfer, "PQ");
        EXPECT_EQ(said.units, "cd/m2");
    }
}

TEST(PictureDescription, OwnTagsEndWithTheNextProgram) {
    ImageSpec spec = spec_of({"R", "G", "B"});
    spec.attribute(file_tag::kFormat, "openexr");
    spec.attribute(file_tag::kColorSpace, "Linear");
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("tonewright:display", "rec2020, reference white 203");
    EXPECT_EQ(source_color(spec, "auto").name, "Rec.2020");
    spec.attribute("Software", "OpenImageIO 2.4.7.1 : oiiotool a.exr --colorconvert a b -o b.exr");
    EXPECT_EQ(source_color(spec, "auto").name, "lin_rec709");
}

/// A profile of no colors, with private tags (ICC.1:2022, 7.3), whose names no other profile has.
std::string profile_with_tags(int count, int first) {
    const auto u32 = [](std::size_t value) {
        std::string bytes;
        for (const int shift : {24, 16, 8, 0})
            bytes += static_cast<char>(value >> shift & 255U);
        return bytes;
    };
    const std::size_t table = 132 + 12 * static_cast<std::size_t>(count);
    std::string profile(128, '\0');
    profile.replace(0, 4, u32(table + 12));
    profile.replace(8, 4, u32(0x04300000));
    profile.replace(12, 12, "mntrRGB XYZ ");
    profile.replace(36, 4, "acsp");
    profile += u32(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
        profile += fmt::format("{:04x}", first + i) + u32(table) + u32(12);
    return profile + std::string("text\0\0\0\0tag", 12);
}

// OpenImageIO 2.4 notes names of tags that it does not know in a static table, while it decodes a
// profile: without our lock, most runs end in a crash.
TEST(PictureReader, ThreadsOpenPicturesWithProfiles) {
    const Folder folder;
    constexpr int kThreads = 4;
    constexpr int kFiles = 40;  // for each thread
    constexpr int kTags = 100;
    const auto name = [&](int i) { return folder / (std::to_string(i) + ".tif"); };
    for (int i = 0; i < kThreads * kFiles; ++i) {
        const std::string profile = profile_with_tags(kTags, kTags * i);
        ImageSpec spec = spec_of({"R", "G", "B"}, OIIO::TypeUInt8);
        spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, static_cast<int>(profile.size())),
                       profile.data());
        ImageBuf picture(spec);
        OIIO::ImageBufAlgo::zero(picture);
        ASSERT_TRUE(picture.write(name(i)));
    }
    std::vector<std::jthread> threads;
    std::latch start(kThreads);
    std::atomic<int> read = 0;
    for (int t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            start.arrive_and_wait();
            for (int i = t * kFiles; i < (t + 1) * kFiles; ++i) {
                const PictureReader reader(name(i), 1);
                if (reader.spec().find_attribute("ICCProfile")) ++read;
            }
        });
    }
    threads.clear();
    EXPECT_EQ(read, kThreads * kFiles);
}

TEST(PictureDescription, PicturesAreTurnedWithTheirMetadata) {
    // Exif's corners of the first row and the first column: JEITA CP-3451, 4.6.4. The stored pixel
    // 0,0 must come to that corner, and 1,0 beside it along the row.
    struct Corner {
        int orientation, x, y, next_x, next_y;
    };
    for (const Corner& c : {Corner{1, 0, 0, 1, 0}, Corner{2, 3, 0, 2, 0}, Corner{3, 3, 2, 2, 2},
                            Corner{4, 0, 2, 1, 2}, Corner{5, 0, 0, 0, 1}, Corner{6, 2, 0, 2, 1},
                            Corner{7, 2, 3, 2, 2}, Corner{8, 0, 3, 0, 2}}) {
        ImageSpec spec = spec_of({"R", "G", "B", "A"}, OIIO::TypeUInt8);
        spec.alpha_channel = 3;
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
        EXPECT_EQ(orientation_of(turned.spec()), 1);
        EXPECT_EQ(turned.spec().get_string_attribute(file_tag::kFormat), "jpeg");
    }
}

}  // namespace
