// SPDX-License-Identifier: Apache-2.0
#include "tonewright/format_color.h"

#include <gtest/gtest.h>

#include <set>

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(FormatColors, SpacesAreNamesOfSourceColors) {
    for (const FormatColor& row : all_format_colors()) {
        EXPECT_NO_THROW((void)find_source_color(row.integer_space)) << row.title;
        EXPECT_NO_THROW((void)find_source_color(row.float_space)) << row.title;
        EXPECT_FALSE(row.extensions.empty()) << row.title;
    }
}

TEST(FormatColors, ExtensionsAreUnique) {
    std::set<std::string_view> extensions;
    for (const FormatColor& row : all_format_colors()) {
        for (const std::string_view extension : row.extensions)
            EXPECT_TRUE(extensions.insert(extension).second) << extension;
    }
}

TEST(FormatColors, FilesFindTheirRow) {
    const auto title = [](std::string_view format, std::string_view extension) {
        const FormatColor* row = find_format_color(format, extension);
        return row ? std::string(row->title) : "none";
    };
    EXPECT_EQ(title("", "PFM"), "PFM");
    EXPECT_EQ(title("pnm", "pfm"), "PFM");
    EXPECT_EQ(title("pnm", "ppm"), "PNM");
    EXPECT_EQ(title("pnm", "dat"), "PNM") << "integers are code values, floats are linear";
    EXPECT_EQ(title("heif", "avif"), "AVIF");
    EXPECT_EQ(title("heif", "dat"), "HEIF");
    EXPECT_EQ(title("openexr", "dat"), "OpenEXR");
    EXPECT_EQ(title("tiff", "png"), "TIFF") << "the contents count";
    EXPECT_EQ(title("", "dat"), "none");
    EXPECT_EQ(title("bayer", "png"), "none");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
