// SPDX-License-Identifier: Apache-2.0
#include "image/resize.h"

#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cstring>
#include <tuple>
#include <vector>

#include "image/picture_file.h"
#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "picture/picture_error.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Resize, SizesAreReadAsTheyAreMeant) {
    for (const auto& [text, width, height, percent] :
         {std::tuple("1920x1080", 1920, 1080, 0.0), std::tuple("1920", 1920, 0, 0.0),
          std::tuple("50%", 0, 0, 50.0), std::tuple("33.3%", 0, 0, 33.3),
          std::tuple("1x1", 1, 1, 0.0)}) {
        const ResizeSize size = parse_resize(text);
        EXPECT_EQ(size.width, width) << text;
        EXPECT_EQ(size.height, height) << text;
        EXPECT_EQ(size.percent, percent) << text;
    }
    for (const char* text : {"", "0", "-5", "+5", "abc", "1e9", "50 %", "0%", "inf%", "1x", "x1",
                             "1x0", "1x1x1", "2147483648"})
        EXPECT_THROW((void)parse_resize(text), Error) << text;
}

TEST(Resize, WindowsCoverTheSamePartOfThePicture) {
    OIIO::ImageSpec spec = make_spec(60, 40, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT);
    spec.x = -10;
    spec.y = -6;
    spec.full_x = spec.full_y = 0;
    spec.full_width = 40;
    spec.full_height = 28;
    const OIIO::ImageSpec half = resized_spec(spec, "50%", kMaxPixels);
    EXPECT_EQ(std::tuple(half.x, half.y, half.width, half.height), std::tuple(-5, -3, 30, 20));
    EXPECT_EQ(std::tuple(half.full_x, half.full_y, half.full_width, half.full_height),
              std::tuple(0, 0, 20, 14));
    // Overscan counts.
    EXPECT_THROW((void)resized_spec(spec, "50%", 599), PictureError);
    EXPECT_NO_THROW((void)resized_spec(spec, "50%", 600));
    OIIO::ImageSpec far = spec;
    far.x = 1 << 29;
    EXPECT_THROW((void)resized_spec(far, "1000%", 1e12), PictureError);
    far = spec;
    far.full_width = far.full_height = 1;
    EXPECT_THROW((void)resized_spec(far, "1920", kMaxPixels), PictureError);
    spec.depth = 2;
    EXPECT_THROW((void)resized_spec(spec, "50%", kMaxPixels), PictureError);
}

TEST(Resize, LightKeepsItsColor) {
    SourceColor color = find_source_color("rec2100_pq");
    OIIO::ImageSpec spec = make_spec(4, 4, {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const OIIO::ImageSpec light = light_spec(spec, color, TonemapOptions::Unpremult::automatic);
    EXPECT_EQ(light.format, OIIO::TypeFloat);
    EXPECT_EQ(light.get_int_attribute("oiio:UnassociatedAlpha", 0), 0);
    for (const char* input : {"auto", "logc3"}) {
        const SourceColor found = source_color(picture_spec(light), input);
        EXPECT_TRUE(found.primaries == color.primaries);
        EXPECT_TRUE(found.is_absolute);
        EXPECT_TRUE(found.decode.empty());
        EXPECT_NE(found.name, color.name);
    }
    // Rows have the color of their picture.
    EXPECT_TRUE(source_color(with_color_metadata_alone(picture_spec(light)), "auto").is_absolute);
}

TEST(Resize, RowsAreThoseOfTheWholePicture) {
    const Folder folder;
    const std::string path = folder / "in.exr";
    ASSERT_TRUE(make_rgb(90, 70, OIIO::TypeDesc::HALF, 3).write(path));
    ReadOptions read;
    read.resize = "33x50";
    PictureReader whole(path, 1, read);
    whole.convert_colors({});
    const OIIO::ImageBuf picture = whole.read_all();
    EXPECT_EQ(picture.spec().width, 33);
    EXPECT_EQ(picture.spec().height, 50);
    // Threads change no bit.
    PictureReader rows(path, 3, read);
    rows.convert_colors({});
    EXPECT_EQ(rows.spec().height, 50);
    std::vector<float> row(33 * 3);
    for (int y = 49; y >= 0; --y) {
        rows.read_rows(y, y + 1, reinterpret_cast<std::byte*>(row.data()));
        EXPECT_EQ(std::memcmp(row.data(), picture.pixeladdr(0, y), row.size() * sizeof(float)), 0);
    }
    EXPECT_TRUE(same_bits(read_image(path, read), picture));
}

TEST(Resize, LightAboveTheOperatorsWhiteHasNoNegativeLobes) {
    const Folder folder;
    const std::string path = folder / "lamp.exr";
    OIIO::ImageBuf lamp(make_spec(32, 32, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::fill(lamp, {0.0F, 0.0F, 0.0F});
    set(lamp, 15, 15, {64, 64, 64});
    ASSERT_TRUE(lamp.write(path));
    ReadOptions read;
    read.resize = "16";
    const auto least = [&](double stops) {
        TonemapOptions options;
        options.exposure_stops = stops;
        PictureReader reader(path, 1, read);
        reader.convert_colors(options);
        const OIIO::ImageBuf picture = reader.read_all();
        float value = 0;
        for (OIIO::ImageBuf::ConstIterator<float> p(picture); !p.done(); ++p)
            value = std::min(value, static_cast<float>(p[0]));
        return value;
    };
    // At -6 stops the lamp is white, and Lanczos filters all of it.
    EXPECT_LT(least(-6), -1);
    EXPECT_NEAR(least(0), least(-6) / 64, 1e-6);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
