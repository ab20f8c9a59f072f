// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut_applications.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/error.h"
#include "tonewright/input_encoding.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

namespace tonewright {
namespace {

LutRequest request_of(const LutApplication& application, const std::string& op) {
    LutRequest request;
    request.format = application.format;
    request.encoding = parse_input_encoding(application.encoding);
    request.view =
        make_view(resolve_operator(op), lut_input_of(application, find_operator(op)), 0, "srgb");
    return request;
}

TEST(LutApplications, HaveAnInterpolation) {
    EXPECT_EQ(interpolation_of(nullptr), LutInterpolation::automatic);
    EXPECT_EQ(interpolation_of(&find_lut_application("unreal")), LutInterpolation::trilinear);
    EXPECT_EQ(interpolation_of(&find_lut_application("resolve")), LutInterpolation::tetrahedral);
}

TEST(LutApplications, ReadTheSizeThatTheyGet) {
    for (const LutApplication& application : all_lut_applications()) {
        EXPECT_LE(application.size, application.largest_size) << application.id;
        EXPECT_NO_THROW(check_lut_size(application, application.largest_size)) << application.id;
        EXPECT_THROW(check_lut_size(application, application.largest_size + 1), Error)
            << application.id;
    }
}

TEST(LutApplications, ARefusedSizeIsOneLineWithTheLargest) {
    try {
        check_lut_size(find_lut_application("resolve"), 129);
        FAIL();
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(), "size is 129; expected at most 65 for resolve");
    }
}

TEST(LutApplications, HaveTheirUsualInput) {
    for (const LutApplication& application : all_lut_applications()) {
        for (const char* op : {"agx_blender", "hable"}) {
            LutRequest request = request_of(application, op);
            EXPECT_TRUE(has_usual_input(application, request)) << application.id;
            request.view.input = "lin_egamut";
            EXPECT_FALSE(has_usual_input(application, request)) << application.id;
        }
    }
    const LutApplication& premiere = find_lut_application("premiere");
    LutRequest request = request_of(premiere, "hable");
    request.encoding = parse_input_encoding("slog3");
    EXPECT_FALSE(has_usual_input(premiere, request));
}

TEST(LutApplications, ThoseThatReadChainsHaveSceneLinearRec709) {
    const LutApplication& nuke = find_lut_application("nuke");
    LutRequest request = request_of(nuke, "hable");
    request.format = LutFormat::ctf;
    request.encoding = parse_input_encoding("linear");
    EXPECT_FALSE(has_usual_input(nuke, request));  // ACEScg
    request.view.input = "lin_rec709";
    EXPECT_TRUE(has_usual_input(nuke, request));
    request.format = LutFormat::cube;
    EXPECT_FALSE(has_usual_input(nuke, request));
}

TEST(LutApplications, CurvesAreTablesWhereTheApplicationConvertsPrimaries) {
    const LutApplication& resolve = find_lut_application("resolve");
    EXPECT_TRUE(is_table_for(resolve, request_of(resolve, "hable").view));
    EXPECT_FALSE(is_table_for(resolve, request_of(resolve, "agx_blender").view));
    const LutApplication& obs = find_lut_application("obs");
    EXPECT_FALSE(is_table_for(obs, request_of(obs, "hable").view));
}

TEST(LutApplications, ChainsAreOfSceneLinearInput) {
    int count = 0;
    for (const LutApplication& application : all_lut_applications()) {
        for (const LutFormat format : {LutFormat::clf, LutFormat::ctf, LutFormat::cube}) {
            const bool is_chain = reads_chains(application, format);
            count += is_chain;
            EXPECT_FALSE(is_chain && format == LutFormat::cube) << application.id;
            EXPECT_EQ(lut_encoding_of(application, format),
                      is_chain ? "linear" : application.encoding);
            EXPECT_EQ(&lut_steps_of(application, format),
                      is_chain ? &application.chain_steps : &application.steps);
            EXPECT_FALSE(lut_steps_of(application, format).empty()) << application.id;
        }
    }
    EXPECT_GT(count, 0) << "else the loop says nothing";
}

TEST(LutApplications, LogsOfSceneLightTakeAnyDisplay) {
    EXPECT_TRUE(takes_any_display(find_lut_application("resolve")))
        << "timelines in DaVinci Intermediate";
    for (const LutApplication& application : all_lut_applications()) {
        if (takes_any_display(application)) {
            EXPECT_NE(application.encoding, "srgb") << application.id;
        }
    }
}

TEST(LutFormatOfFile, ExtensionsDecideOrMustAgree) {
    EXPECT_EQ(lut_format_of_file("a.cube", {}, nullptr), LutFormat::cube);
    EXPECT_EQ(lut_format_of_file("a.clf", {}, nullptr), LutFormat::clf);
    EXPECT_EQ(lut_format_of_file("a.cube", LutFormat::resolve_cube, nullptr),
              LutFormat::resolve_cube)
        << "the format wins";
    EXPECT_THROW((void)lut_format_of_file("a.txt", {}, nullptr), Error);
    EXPECT_THROW((void)lut_format_of_file("a.cube", LutFormat::clf, nullptr), Error);
    for (const LutApplication& application : all_lut_applications()) {
        EXPECT_THROW((void)lut_format_of_file("a.txt", {}, &application), Error) << application.id;
        if (reads_chains(application, LutFormat::clf)) {
            EXPECT_EQ(lut_format_of_file("a.clf", {}, &application), LutFormat::clf);
        }
    }
}

}  // namespace
}  // namespace tonewright
