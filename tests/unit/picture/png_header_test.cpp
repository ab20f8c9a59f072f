// SPDX-License-Identifier: Apache-2.0
#include "picture/png_header.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "unit/folder.h"
#include "unit/picture/written_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// The bytes before the first chunk IDAT. W3C PNG (third edition), 5.3: a chunk begins with the
/// length of its data.
std::string before_pixels(const std::string& file) {
    std::size_t at = 8;
    while (at + 8 < file.size() && file.compare(at + 4, 4, "IDAT") != 0) {
        std::size_t length = 0;
        for (std::size_t i = 0; i < 4; ++i)
            length = 256 * length + static_cast<unsigned char>(file[at + i]);
        at += 12 + length;
    }
    return file.substr(0, at);
}

/// Both headers of a picture with these attributes are equal.
void expect_equal(const std::string& what, const std::function<void(ImageSpec&)>& change,
                  TypeDesc type = TypeDesc::UINT8, int channels = 3) {
    const Folder folder;
    const std::string path = folder / "a.png";
    ImageSpec spec = straight_spec(5, 3, channels, type);
    change(spec);
    write_by_oiio(path, spec, values_of(spec, Content::noise));
    const std::optional<std::string> header = png_header(picture_spec(spec));
    ASSERT_TRUE(header) << what;
    EXPECT_EQ(*header, before_pixels(read(path))) << what;
}

TEST(PngHeader, EqualsThatOfOpenImageIO) {
    const auto with = [](const char* name, const auto& value) {
        return [=](ImageSpec& spec) { spec.attribute(name, value); };
    };
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16}) {
        for (int channels = 1; channels <= 4; ++channels)
            expect_equal(
                "layout", [](ImageSpec&) {}, type, channels);
    }
    for (const char* space : {"sRGB", "Linear", "Gamma2.2", "Gamma2.0", "Gamma", "Gamma99",
                              "gamma1.8", "Rec709", "Rec.2100-PQ"})
        expect_equal(space, with("oiio:ColorSpace", space));
    expect_equal("oiio:Gamma", [](ImageSpec& spec) {
        spec.attribute("oiio:ColorSpace", "Gamma");
        spec.attribute("oiio:Gamma", 1.8F);
    });
    for (const char* date :
         {"2026:11:30 12:34:56", "2026-11-30 12:34:56", "2026/1/3  1:2:3", "2026:13:01 00:00:00",
          "2026:11:30 24:00:00", "yesterday", "2026:11:30", "2026:11:30T12:34:56Z", ""})
        expect_equal(date, with("DateTime", date));
    for (const char* text : {"Artist", "DocumentName", "name", "ImageDescription", "Description",
                             "Software", "Copyright", "Compression", "planarconfig",
                             "tonewright:operator", "a name with  two blanks "})
        expect_equal(text, with(text, "two words"));
    expect_equal("long text", with("Comment", std::string(100000, 'x')));
    expect_equal("empty text", with("Comment", ""));
    expect_equal("numbers are no texts", with("Comment", 3.0F));
    expect_equal("lists are no texts", [](ImageSpec& spec) {
        const std::vector<const char*> two = {"a", "b"};
        spec.attribute("Comment", TypeDesc(TypeDesc::STRING, 2), two.data());
    });
    expect_equal("several texts", [](ImageSpec& spec) {
        spec.attribute("Software", "s");
        spec.attribute("Artist", "a");
        spec.attribute("DateTime", "2026:11:30 12:34:56");
        spec.attribute("Author", "b");
    });
}

TEST(PngHeader, ResolutionEqualsThatOfOpenImageIO) {
    for (const char* unit : {"", "in", "inch", "cm", "m", "meter", "none", "IN"}) {
        for (const float x : {0.0F, 72.0F, 118.11F}) {
            for (const float y : {0.0F, 300.0F}) {
                for (const float aspect : {0.0F, 1.0F, 0.5F}) {
                    expect_equal(unit, [&](ImageSpec& spec) {
                        if (*unit) spec.attribute("ResolutionUnit", unit);
                        if (x != 0) spec.attribute("XResolution", x);
                        if (y != 0) spec.attribute("YResolution", y);
                        if (aspect != 0) spec.attribute("PixelAspectRatio", aspect);
                    });
                }
            }
        }
    }
}

TEST(PngHeader, OriginEqualsThatOfOpenImageIO) {
    expect_equal("origin", [](ImageSpec& spec) {
        spec.x = 7;
        spec.y = -3;
    });
}

TEST(PngHeader, ProfileEqualsThatOfOpenImageIO) {
    // ICC.1:2022, 7.2: size, version 4.4, monitor, RGB, XYZ, signature; no tags.
    std::string profile(132, '\0');
    profile[3] = static_cast<char>(132);
    profile[8] = 4;
    profile.replace(12, 12, "mntrRGB XYZ ");
    profile.replace(36, 4, "acsp");
    profile.replace(68, 12, std::string("\0\0\xf6\xd6\0\1\0\0\0\0\xd3\x2d", 12));
    const auto set = [](ImageSpec& spec, const std::string& bytes) {
        spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, static_cast<int>(bytes.size())),
                       bytes.data());
    };
    expect_equal("profile", [&](ImageSpec& spec) { set(spec, profile); });
    ImageSpec spec = straight_spec(5, 3, 3, TypeDesc::UINT8);
    const std::optional<std::string> without = png_header(picture_spec(spec));
    set(spec, profile);
    const std::optional<std::string> with = png_header(picture_spec(spec));
    ASSERT_TRUE(without && with);
    EXPECT_EQ(without->find("iCCP"), std::string::npos);
    EXPECT_NE(with->find("iCCP"), std::string::npos);
    set(spec, std::string(200, 'x'));  // OpenImageIO fails, and says so
    EXPECT_FALSE(png_header(picture_spec(spec)));
}

TEST(PngHeader, LeavesConversionsAndRefusalsToOpenImageIO) {
    const auto header = [](const char* name, const auto& value) {
        ImageSpec spec = straight_spec(5, 3, 3, TypeDesc::UINT8);
        spec.attribute(name, value);
        return png_header(picture_spec(spec));
    };
    EXPECT_FALSE(header("XResolution", "72"));
    EXPECT_FALSE(header("PixelAspectRatio", 2));
    EXPECT_FALSE(header("ResolutionUnit", 2));
    EXPECT_FALSE(header(" ", "libpng needs a keyword"));
    EXPECT_TRUE(header("XResolution", 72.0F));
    ImageSpec wide(2000000, 1, 1, TypeDesc::UINT8);  // libpng's limit is a million
    EXPECT_FALSE(png_header(picture_spec(wide)));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
