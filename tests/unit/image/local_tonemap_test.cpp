// SPDX-License-Identifier: Apache-2.0
//
// Local operators on pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

TonemapOptions options_of(const Operator& op, const std::string& display = "linear") {
    TonemapOptions options;
    options.op = resolve_picture_operator(op.id);
    options.display = display;
    return options;
}

class LocalPicture : public testing::TestWithParam<std::string> {
  protected:
    [[nodiscard]] const Operator& op() const { return *resolve_picture_operator(GetParam()).op; }
};

TEST_P(LocalPicture, ThreadsDoNotMatter) {
    const ImageBuf source = make_rgb(700, 300, OIIO::TypeDesc::FLOAT, 30);
    const ImageBuf one = tonemap(source, options_of(op()), {}, 1);
    ASSERT_FALSE(one.has_error()) << one.geterror();
    for (const int threads : {2, 3, 8})
        EXPECT_TRUE(same_bits(one, tonemap(source, options_of(op()), {}, threads))) << threads;
}

TEST_P(LocalPicture, NumbersOfAllKinds) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::vector<float> values = {0,     -0.0F, 1e-38F, -1,    1e-6F,        0.18F,
                                       65504, 1e30F, kInf,   -kInf, std::nanf("")};
    ImageBuf source(make_spec(11 * 3, 11, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT));
    for (int y = 0; y < 11; ++y) {
        for (int x = 0; x < 33; ++x) {
            set(source, x, y,
                {values[static_cast<std::size_t>(x % 11)], values[static_cast<std::size_t>(y)],
                 values[static_cast<std::size_t>((x + y) % 11)]});
        }
    }
    for (const double stops : {-60.0, 0.0, 60.0}) {
        TonemapOptions options = options_of(op());
        options.exposure_stops = stops;
        const ImageBuf result = tonemap(source, options);
        ASSERT_FALSE(result.has_error()) << result.geterror();
        for (int y = 0; y < 11; ++y) {
            for (int x = 0; x < 33; ++x) {
                for (const float v : pixel(result, x, y)) {
                    EXPECT_TRUE(std::isfinite(v) && v >= 0)
                        << v << " at " << x << ", " << y << " with " << stops << " stops";
                }
            }
        }
    }
}

TEST_P(LocalPicture, RegionIsThatOfTheWholePicture) {
    const ImageBuf source = make_rgb(90, 60, OIIO::TypeDesc::FLOAT, 10);
    const ImageBuf whole = tonemap(source, options_of(op(), "srgb"));
    const ROI roi(17, 50, 11, 43);
    const ImageBuf part = tonemap(source, options_of(op(), "srgb"), roi);
    ASSERT_FALSE(part.has_error()) << part.geterror();
    for (int y = roi.ybegin; y < roi.yend; ++y) {
        for (int x = roi.xbegin; x < roi.xend; ++x)
            EXPECT_EQ(pixel(part, x, y), pixel(whole, x, y));
    }
}

TEST_P(LocalPicture, DataWindowBeginsAnywhere) {
    const ImageBuf source = make_rgb(40, 30, OIIO::TypeDesc::FLOAT, 10);
    const ImageBuf expected = tonemap(source, options_of(op(), "srgb"));
    for (const auto& [x0, y0] : {std::pair{-7, 11}, {5, -3}}) {
        ImageBuf moved(source);
        moved.set_origin(x0, y0);
        const ImageBuf result = tonemap(moved, options_of(op(), "srgb"));
        ASSERT_FALSE(result.has_error()) << result.geterror();
        ASSERT_EQ(result.roi(), moved.roi());
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 40; ++x)
                EXPECT_EQ(pixel(result, x0 + x, y0 + y), pixel(expected, x, y));
        }
    }
}

TEST_P(LocalPicture, InPlaceAndOtherTypes) {
    ImageBuf source = make_rgb(40, 30, OIIO::TypeDesc::FLOAT, 10);
    const ImageBuf expected = tonemap(source, options_of(op(), "srgb"));
    EXPECT_TRUE(tonemap(source, source, options_of(op(), "srgb")));
    EXPECT_TRUE(same_bits(source, expected));
    const ImageBuf bytes = make_rgb(40, 30, OIIO::TypeDesc::UINT8);
    EXPECT_FALSE(tonemap(bytes, options_of(op(), "srgb")).has_error());
}

TEST_P(LocalPicture, AlphaAndOtherChannels) {
    const ImageBuf opaque = make_rgb(31, 20, OIIO::TypeDesc::FLOAT, 4);
    ImageBuf source(make_spec(31, 20, {"R", "G", "B", "A", "Z"}, OIIO::TypeDesc::FLOAT));
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 31; ++x) {
            const float alpha = x % 2 == 0 ? 0.5F : 0.25F;  // exact
            std::vector<float> v = pixel(opaque, x, y);
            set(source, x, y, {v[0] * alpha, v[1] * alpha, v[2] * alpha, alpha, 7});
        }
    }
    const ImageBuf expected = tonemap(opaque, options_of(op(), "srgb"));
    const ImageBuf result = tonemap(source, options_of(op(), "srgb"));
    ASSERT_FALSE(result.has_error()) << result.geterror();
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 31; ++x) {
            const float alpha = x % 2 == 0 ? 0.5F : 0.25F;
            const std::vector<float> v = pixel(expected, x, y);
            EXPECT_EQ(pixel(result, x, y),
                      (std::vector<float>{v[0] * alpha, v[1] * alpha, v[2] * alpha, alpha, 7}));
        }
    }
}

TEST_P(LocalPicture, GrayStaysGray) {
    const ImageBuf source = make_picture(make_spec(20, 16, {"Y"}, OIIO::TypeDesc::FLOAT), 5);
    const ImageBuf result = tonemap(source, options_of(op(), "srgb"));
    ASSERT_FALSE(result.has_error()) << result.geterror();
    EXPECT_EQ(result.nchannels(), 1);
}

TEST_P(LocalPicture, VolumesAreRefused) {
    OIIO::ImageSpec spec = make_spec(4, 4, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT);
    spec.depth = spec.full_depth = 3;
    const ImageBuf result = tonemap(ImageBuf(spec), options_of(op()));
    EXPECT_TRUE(result.has_error());
    EXPECT_NE(result.geterror().find("3 slices; expected one"), std::string::npos);
}

TEST_P(LocalPicture, FilesAreThoseOfTheLibrary) {
    const Folder folder;
    const ImageBuf source = make_rgb(50, 200, OIIO::TypeDesc::FLOAT, 10);
    ASSERT_TRUE(source.write(folder / "in.exr"));
    const Tonemapper tonemapper(options_of(op(), "srgb"));
    EXPECT_TRUE(tonemapper.needs_whole_picture());
    tonemap_file(tonemapper, folder / "in.exr", folder / "out.exr", OIIO::TypeFloat);
    EXPECT_TRUE(same_bits(read_image(folder / "out.exr"), [&] {
        ImageBuf result;
        EXPECT_TRUE(tonemapper(result, source));
        return result;
    }()));
}

TEST(ExposureFusion, WithoutOtherExposuresItIsItsCurve) {
    const ImageBuf source = make_rgb(30, 20, OIIO::TypeDesc::FLOAT, 6);
    TonemapOptions options = {
        .op = resolve_picture_operator("exposure_fusion",
                                       {{"shadows", "0"}, {"highlights", "0"}, {"exposure", "1"}})};
    const ImageBuf fused = tonemap(source, options);
    const ImageBuf curve = tonemap(source, {.op = resolve_picture_operator("aces_hill:threejs")});
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 30; ++x) {
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(pixel(fused, x, y)[c], pixel(curve, x, y)[c], 4e-6);  // two engines
        }
    }
}

std::vector<std::string> ids() {
    std::vector<std::string> all;
    for (const Operator& op : local_operators())
        all.push_back(op.id);
    return all;
}
INSTANTIATE_TEST_SUITE_P(Every, LocalPicture, testing::ValuesIn(ids()),
                         [](const auto& of) { return of.param; });

}  // namespace
TONEWRIGHT_NAMESPACE_END
