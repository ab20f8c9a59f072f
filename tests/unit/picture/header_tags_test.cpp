// SPDX-License-Identifier: Apache-2.0
//
// Tags of files about their colors.
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "lut/icc.h"
#include "picture/color_tags.h"
#include "picture/png_chunks.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"
#include "unit/folder.h"
#include "unit/image/picture_files.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

std::string icc_of(const std::string& path) {
    const ImageBuf file = read_image(path);
    const OIIO::ParamValue* icc = file.spec().find_attribute("ICCProfile");
    if (!icc) return {};
    return {static_cast<const char*>(icc->data()), static_cast<std::size_t>(icc->datasize())};
}

TEST(FileTags, PngOfAnHdrDisplayHasItsCodePoints) {
    const Folder folder;
    const std::string path = folder / "a.png";
    const std::vector<std::pair<std::string, std::string>> displays = {
        {"rec2100_pq", cicp_chunk({9, 16})},
        {"rec2100_hlg", cicp_chunk({9, 18})},
        {"p3d65_pq", cicp_chunk({12, 16})}};
    for (const auto& [display, chunk] : displays) {
        for (const int channels : {1, 3}) {
            const ImageBuf picture = shown_on(display, channels);
            EXPECT_TRUE(warnings_of(picture, path).empty()) << display;
            const std::string bytes = read(path);
            EXPECT_EQ(bytes.substr(kAfterPngHeader, chunk.size()), chunk) << display;
            EXPECT_EQ(bytes.substr(12, 4), "IHDR");
            EXPECT_EQ(bytes.find("sRGB"), std::string::npos);
            const ImageBuf back = read_image(path);
            EXPECT_EQ(back.spec().format, TypeDesc::UINT16) << "8 bits show bands";
            EXPECT_LE(OIIO::ImageBufAlgo::compare(picture, back, 1, 1).maxerror, 1.0 / 65535);
            write_image_atomically(picture, path);
            EXPECT_EQ(read(path), bytes) << "the same on every run";
        }
    }
    EXPECT_EQ(warnings_of(shown_on("rec2100_pq"), path, {.type = TypeDesc::UINT8}),
              std::vector<std::string>{"gradients in 8 bits show bands"});
}

TEST(FileTags, SdrDisplaysHaveTheirProfile) {
    if (!has_icc()) GTEST_SKIP() << "built without Little CMS";
    const Folder folder;
    const IccCurve srgb = {2.4, true};
    struct Case {
        const char* display;
        Primaries primaries;
        IccCurve curve;
        const char* name;
    };
    const std::vector<Case> cases = {
        {"srgb", kRec709, srgb, "sRGB"},          {"display_p3", kP3D65, srgb, "Display P3"},
        {"rec1886", kRec709, {2.4}, "Gamma 2.4"}, {"rec2020", kRec2020, {2.4}, "Rec.2020"},
        {"g22", kRec709, {2.2}, "Gamma 2.2"},     {"linear", kRec709, {1}, "linear light"}};
    for (const Case& c : cases) {
        for (const int channels : {1, 3}) {
            const ImageBuf picture = shown_on(c.display, channels);
            for (const char* name : {"a.png", "a.jpg", "a.tif"}) {
                const std::string path = folder / name;
                EXPECT_TRUE(warnings_of(picture, path).empty()) << c.display << " " << name;
                const bool has_chunk =
                    std::string(c.display) == "srgb" && std::string(name) == "a.png";
                const std::string wanted =
                    has_chunk ? "" : write_display_icc(c.primaries, c.curve, c.name, channels == 1);
                EXPECT_TRUE(icc_of(path) == wanted) << c.display << " " << name << " " << channels;
                if (has_chunk) {
                    EXPECT_NE(read(path).find("sRGB"), std::string::npos);
                }
            }
        }
    }
    // A picture that says nothing of its colors gets nothing.
    const std::string path = folder / "a.tif";
    write_image_atomically(make_rgb(4, 4), path);
    EXPECT_EQ(icc_of(path), "");
}

TEST(FileTags, EveryDisplayIsDescribed) {
    const std::vector<double> codes = {0, 0.02, 0.1, 0.35, 0.7, 1};
    for (const Display& display : all_displays()) {
        PictureSpec spec;
        spec.nchannels = 3;
        tag_as_result_of(make_view(resolve_operator("clamp"), "lin_rec709", 0, display.id), spec);
        const std::optional<TaggedColor> color = tagged_color(spec);
        ASSERT_TRUE(color) << display.id;
        EXPECT_EQ(color->code_points.has_value(), display.is_hdr);
        EXPECT_EQ(color->primaries, display.primaries);
        if (!color->curve) continue;
        // The curve is that of the display, whose formula stands elsewhere.
        const ReferenceEngine decode(display.decode);
        for (const double code : codes) {
            const auto in = static_cast<float>(code);
            const std::array<float, 3> rgb = {in, in, in};
            std::array<double, 3> light{};
            decode.run_rgb(rgb.data(), light.data(), 1);
            const double x = static_cast<double>(in);
            const IccCurve& curve = *color->curve;
            const double said = curve.is_srgb && x <= 0.04045 ? x / 12.92
                                : curve.is_srgb ? std::pow((x + 0.055) / 1.055, curve.exponent)
                                                : std::pow(x, curve.exponent);
            EXPECT_NEAR(said, light[0], 1e-7) << display.id;
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
