// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "pipeline/encoded_spaces.h"
#include "tonewright/engine.h"
#include "tonewright/format_color.h"
#include "tonewright/input_encoding.h"
#include "tonewright/source_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// ITU-T H.273 (07/2021), tables 2 and 3: values that are neither reserved nor unspecified.
const std::set<int> kPrimariesOfTable2 = {1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 22};
const std::set<int> kTransfersOfTable3 = {1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18};

TEST(CodePoints, EveryPairOfTheTablesHasAColor) {
    for (int primaries = -1; primaries <= 256; ++primaries) {
        for (int transfer = -1; transfer <= 256; ++transfer) {
            const bool is_known =
                kPrimariesOfTable2.count(primaries) > 0 && kTransfersOfTable3.count(transfer) > 0;
            ASSERT_EQ(color_of_code_points(primaries, transfer).has_value(), is_known)
                << primaries << "/" << transfer;
        }
    }
}

TEST(CodePoints, NamesAreThoseOfDisplaysAndSpaces) {
    const auto name = [](int primaries, int transfer) {
        return color_of_code_points(primaries, transfer)->name;
    };
    EXPECT_EQ(name(1, 13), "sRGB");
    EXPECT_EQ(name(12, 13), "Display P3");
    EXPECT_EQ(name(9, 16), "Rec.2100-PQ");
    EXPECT_EQ(name(9, 18), "Rec.2100-HLG");
    EXPECT_EQ(name(12, 16), "P3-D65 PQ");
    EXPECT_EQ(name(1, 1), "Rec.1886");
    EXPECT_EQ(name(9, 14), "Rec.2020");
    EXPECT_EQ(name(1, 8), "lin_rec709");
    EXPECT_EQ(name(9, 8), "lin_rec2020");
    EXPECT_EQ(name(10, 8), "lin_ciexyzd65_scene");
    EXPECT_EQ(name(9, 13), "cicp:9/13");
    EXPECT_EQ(name(1, 16), "cicp:1/16");
}

/// A cache may compare names, so each name must find one color.
TEST(CodePoints, NamesFindTheSameColor) {
    const Vector3 codes = {0.9, 0.3, 0.05};
    for (const int primaries : kPrimariesOfTable2) {
        for (const int transfer : kTransfersOfTable3) {
            const SourceColor color = *color_of_code_points(primaries, transfer);
            const SourceColor again = find_source_color(color.name);
            EXPECT_EQ(again.name, color.name);
            EXPECT_EQ(again.primaries, color.primaries) << color.name;
            EXPECT_EQ(again.is_absolute, color.is_absolute) << color.name;
            EXPECT_EQ(again.is_absolute, transfer == 16 || transfer == 18) << color.name;
            EXPECT_EQ(ReferenceEngine(again.decode)(codes), ReferenceEngine(color.decode)(codes))
                << color.name;
        }
    }
}

TEST(CodePoints, MessagesNameBoth) {
    EXPECT_EQ(code_point_names(9, 16), "BT.2020 / PQ");
    EXPECT_EQ(code_point_names(2, 13), "unspecified / sRGB");
    EXPECT_EQ(code_point_names(3, 19), "reserved 3 / reserved 19");
    EXPECT_EQ(code_point_names(22, 7), "EBU 3213-E / SMPTE 240M");
}

TEST(SourceColors, EveryListedNameAndAliasFindsOneColor) {
    for (const SourceColorName& source : all_source_color_names()) {
        if (source.kind == SourceColorName::Kind::other) continue;
        const SourceColor color = find_source_color(source.id);
        std::vector<std::string> others = source.aliases;
        // Titles of encodings are texts of LUT headers.
        const bool has_title =
            source.kind != SourceColorName::Kind::encoding && source.id != "unknown";
        if (has_title) others.push_back(source.title);
        for (const std::string& alias : others) {
            const SourceColor other = find_source_color(alias);
            EXPECT_EQ(other.primaries, color.primaries) << alias;
            const Vector3 codes = {0.6, 0.35, 0.1};
            EXPECT_EQ(ReferenceEngine(other.decode)(codes), ReferenceEngine(color.decode)(codes))
                << alias << ", " << source.id;
        }
    }
}

TEST(SourceColors, EveryEncodingOfLutsIsOne) {
    for (const std::string& id : input_encoding_names()) {
        const InputEncoding encoding = parse_input_encoding(id);
        const SourceColor color = find_source_color(encoding.id);
        const double code = 0.4;
        EXPECT_EQ(color.primaries, find_input_space(encoding.default_input).primaries) << id;
        // A display's power and the encoding may be other expressions of one curve.
        EXPECT_NEAR(ReferenceEngine(color.decode)({code, code, code})[0],
                    evaluate(encoding.decode, code), 1e-12)
            << id;
    }
}

TEST(SourceColors, AbsoluteLightIsThatOfHdrDisplays) {
    for (const Display& display : all_displays())
        EXPECT_EQ(find_source_color(display.id).is_absolute, display.is_hdr) << display.id;
    EXPECT_TRUE(find_source_color("pq").is_absolute);
    EXPECT_FALSE(find_source_color("pq:203").is_absolute) << "its white is stated";
    EXPECT_FALSE(find_source_color("hlg").is_absolute) << "light of the scene";
}

/// The config's logs are OpenColorIO's LogAffineTransform; pictures have the makers' formula.
TEST(SourceColors, LogsOfTheConfigAreTheSameCurve) {
    for (const EncodedSpace& space : all_encoded_spaces()) {
        if (space.kind != EncodedSpace::Kind::log) continue;
        const LogCurve& c = space.curve;
        const ReferenceEngine decode(space.decode);
        for (const double code : {0.2, 0.4, 0.7, 1.0}) {
            const double light =
                (std::pow(c.base, (code - c.log_offset) / c.log_slope) - c.linear_offset) /
                c.linear_slope;
            // Makers print their constants with 7 digits.
            EXPECT_NEAR(decode({code, code, code})[0] / light, 1, 1e-6) << space.title;
        }
    }
}

TEST(SourceColors, WhereLightIsNeededTheMessageSaysSo) {
    const auto error = [](std::string_view name) {
        try {
            (void)find_input_space(name);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    for (const char* name : {"ACEScct", "logc3", "sRGB - Texture", "Rec.2100-HLG", "cicp:9/16"}) {
        EXPECT_EQ(error(name).find(std::string("input is ") + name +
                                   ", a color of pictures; expected lin_rec709, "),
                  0)
            << error(name);
    }
}

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
