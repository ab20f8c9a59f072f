// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lut/stated_input.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string file_of(const std::string& encoding, const std::string& space, LutFormat format) {
    LutRequest request;
    request.encoding = parse_input_encoding(encoding);
    request.view = make_view(resolve_operator("hable"), space, 0, "srgb");
    request.format = format;
    request.size = 17;
    request.dimension = LutDimension::three;
    return write_lut(sample_lut(request), request, {});
}

TEST(StatedInput, MatchesTheBakedFile) {
    for (const char* encoding : {"acescct", "logc3", "logc4", "slog3", "davinci", "unity_logc",
                                 "unreal_log", "srgb", "pq:100", "pq:203", "log2:-10:6.5"}) {
        const auto stated = read_stated_input(file_of(encoding, "lin_ap1", LutFormat::cube));
        ASSERT_TRUE(stated) << encoding;
        EXPECT_EQ(stated->encoding, encoding);
        EXPECT_EQ(stated->space, "lin_ap1");
    }
    for (const InputSpace& space : all_input_spaces()) {
        const auto stated = read_stated_input(file_of("davinci", space.id, LutFormat::cube));
        ASSERT_TRUE(stated) << space.id;
        EXPECT_EQ(stated->space, space.id);
    }
}

TEST(StatedInput, IsInAllFormatsWithText) {
    for (const LutFormat format : {LutFormat::cube, LutFormat::clf, LutFormat::ctf, LutFormat::csp,
                                   LutFormat::resolve_cube}) {
        const auto stated = read_stated_input(file_of("acescct", "lin_ap1", format));
        ASSERT_TRUE(stated) << name_of(format);
        EXPECT_EQ(stated->encoding, has_shaper(format) ? "linear" : "acescct");
        EXPECT_EQ(stated->space, "lin_ap1");
    }
}

TEST(StatedDisplay, MatchesTheBakedFile) {
    LutRequest request;
    request.encoding = parse_input_encoding("acescct");
    request.size = 17;
    request.dimension = LutDimension::three;
    std::vector<std::string> ids = {"linear"};
    for (const Display& display : all_displays())
        ids.push_back(display.id);
    for (const std::string& id : ids) {
        request.view = make_view(resolve_operator("hable"), "lin_ap1", 0, id);
        const Lut lut = sample_lut(request);
        for (const LutFormat format : {LutFormat::cube, LutFormat::clf, LutFormat::csp}) {
            request.format = format;
            EXPECT_EQ(read_stated_display(write_lut(lut, request, {})), id) << name_of(format);
        }
    }
    request.view = make_view(resolve_operator("hable"), "lin_ap1", 0, "native");
    EXPECT_FALSE(read_stated_display(write_lut(sample_lut(request), request, {})));
    EXPECT_FALSE(read_stated_display("# Output: sRGB code values\n"));
}

TEST(StatedInput, IsInTheDescriptorsOfAClf) {
    const std::string clf = file_of("acescct", "lin_ap1", LutFormat::clf);
    EXPECT_NE(clf.find("<InputDescriptor>ACEScct (Academy S-2016-001: AP1 primaries, log with a "
                       "linear toe), of scene-linear ACEScg</InputDescriptor>"),
              std::string::npos);
    EXPECT_NE(clf.find("<OutputDescriptor>sRGB code values"), std::string::npos);
}

TEST(StatedInput, IgnoresHeadersOfOtherPrograms) {
    EXPECT_FALSE(
        read_stated_input("LUT_3D_SIZE 2\n# Input: DaVinci Intermediate, of scene-linear "
                          "ACEScg\n"));
    EXPECT_FALSE(
        read_stated_input("# Tonewright: x\n# Input: somebody's log, of scene-linear ACEScg"));
    EXPECT_FALSE(
        read_stated_input("# Tonewright: x\n# Input: PQ (SMPTE ST 2084), scene-linear 1 at x "
                          "cd/m2, of scene-linear ACEScg"));
    EXPECT_FALSE(read_stated_input(""));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
