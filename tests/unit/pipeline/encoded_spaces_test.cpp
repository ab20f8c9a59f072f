// SPDX-License-Identifier: Apache-2.0
#include "pipeline/encoded_spaces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tonewright/engine.h"
#include "tonewright/input_encoding.h"
#include "tonewright/source_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

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

// The config's logs are OpenColorIO's LogAffineTransform; pictures have the makers' formula.
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
        if (!c.linear_break) continue;
        // OpenColorIO continues with the slope of the logarithm at the break.
        const double at_break = c.linear_slope * *c.linear_break + c.linear_offset;
        const double code = c.log_slope * std::log(at_break) / std::log(c.base) + c.log_offset;
        const double slope = c.log_slope * c.linear_slope / (at_break * std::log(c.base));
        EXPECT_NEAR(decode({code, code, code})[0], *c.linear_break, 1e-8) << space.title;
        const double below = code - 0.02 * slope;
        EXPECT_NEAR(decode({below, below, below})[0], *c.linear_break - 0.02, 1e-8) << space.title;
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

}  // namespace
TONEWRIGHT_NAMESPACE_END
