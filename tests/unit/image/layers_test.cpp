// SPDX-License-Identifier: Apache-2.0
#include "image/layers.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

OIIO::ImageSpec spec_of(std::vector<std::string> channels) {
    OIIO::ImageSpec spec(1, 1, static_cast<int>(channels.size()), OIIO::TypeDesc::HALF);
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
    OIIO::ImageSpec spec = spec_of({"Z", "B", "G", "R"});
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

}  // namespace
TONEWRIGHT_NAMESPACE_END
