// SPDX-License-Identifier: Apache-2.0
#include "picture/layers.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

PictureSpec spec_of(std::vector<std::string> channels) {
    PictureSpec spec;
    spec.width = spec.height = 1;
    spec.nchannels = static_cast<int>(channels.size());
    spec.format = OIIO::TypeDesc::HALF;
    spec.channelnames = std::move(channels);
    return spec;
}

TEST(Layers, AreGroupsOfThreeChannelsByAnySpelling) {
    // OpenEXR sorts channels by name, so blue comes first.
    const auto layers = color_layers(spec_of(
        {"A", "B", "G", "R", "ViewLayer.Combined.A", "ViewLayer.Combined.B", "ViewLayer.Combined.G",
         "ViewLayer.Combined.R", "AO.b", "AO.g", "AO.r", "Z", "uv.x"}));
    ASSERT_EQ(layers.size(), 3U);
    EXPECT_EQ(layers[0].name, "");
    EXPECT_EQ(layers[0].channels, (std::vector<int>{3, 2, 1, 0}));
    EXPECT_EQ(layers[1].name, "ViewLayer.Combined");
    EXPECT_EQ(layers[1].channels, (std::vector<int>{7, 6, 5, 4}));
    EXPECT_EQ(layers[2].channels, (std::vector<int>{10, 9, 8})) << "no alpha";
    EXPECT_TRUE(color_layers(spec_of({"Y", "Z"})).empty());
    EXPECT_TRUE(color_layers(spec_of({"a.R", "a.G", "b.B"})).empty()) << "of two layers";
}

TEST(Layers, ThePictureIsRgbOrWhatRenderersCallIt) {
    const auto picture = [](std::vector<std::string> channels) {
        const auto layers = color_layers(spec_of(std::move(channels)));
        const Layer* layer = picture_layer(layers);
        return layer ? layer->name : "none";
    };
    EXPECT_EQ(picture({"AO.R", "AO.G", "AO.B", "R", "G", "B"}), "");
    EXPECT_EQ(picture({"AO.R", "AO.G", "AO.B", "x.Combined.R", "x.Combined.G", "x.Combined.B"}),
              "x.Combined");
    EXPECT_EQ(picture({"normal.R", "normal.G", "normal.B", "key.R", "key.G", "key.B"}), "key")
        << "the first that holds no data";
    EXPECT_EQ(picture({"Z"}), "none");
    for (const char* name : {"Normal", "ViewLayer.Depth", "CryptoObject00", "ao", "Vector"})
        EXPECT_TRUE(is_data_layer(name)) << name;
    for (const char* name : {"", "Combined", "beauty", "key"})
        EXPECT_FALSE(is_data_layer(name)) << name;
}

TEST(Layers, AreFoundByTheLastPartsOfTheirName) {
    const auto layers =
        color_layers(spec_of({"a.Combined.R", "a.Combined.G", "a.Combined.B", "b.Diff.R",
                              "b.Diff.G", "b.Diff.B", "c.Diff.R", "c.Diff.G", "c.Diff.B"}));
    ASSERT_NE(find_layer(layers, "combined"), nullptr);
    EXPECT_EQ(find_layer(layers, "combined")->name, "a.Combined");
    EXPECT_EQ(find_layer(layers, "Diff"), nullptr) << "two of them";
    ASSERT_NE(find_layer(layers, "C.DIFF"), nullptr);
    EXPECT_EQ(find_layer(layers, "ombined"), nullptr) << "a part of a word";
    EXPECT_EQ(layer_names(layers).find("a.Combined, b.Diff"), 0U);
}

TEST(Layers, ReorderPutsALayerFirst) {
    PictureSpec spec = spec_of({"Z", "B", "G", "R"});
    const auto layers = color_layers(spec);
    ASSERT_EQ(layers.size(), 1U);
    const std::vector<int> order = order_of(layers[0], spec);
    EXPECT_EQ(order, (std::vector<int>{3, 2, 1, 0}));
    // Two pixels of two bytes a sample.
    const unsigned char stored[] = {1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 15, 16, 17, 18};
    std::vector<std::byte> out(sizeof stored);
    reorder(reinterpret_cast<const std::byte*>(stored), 4, order, 2, 2, out.data());
    const unsigned char expected[] = {7, 8, 5, 6, 3, 4, 1, 2, 17, 18, 15, 16, 13, 14, 11, 12};
    for (std::size_t i = 0; i < sizeof expected; ++i)
        EXPECT_EQ(std::to_integer<int>(out[i]), expected[i]) << i;
    reorder(spec, order, false);
    EXPECT_EQ(spec.channelnames, (std::vector<std::string>{"R", "G", "B", "Z"}));
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
    PictureSpec spec = spec_of({"Z", "b", "g", "r"});
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

}  // namespace
TONEWRIGHT_NAMESPACE_END
