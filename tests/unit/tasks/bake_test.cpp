// SPDX-License-Identifier: Apache-2.0
#include "tasks/bake.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

BakeRequest request_for(const char* op, const char* application = nullptr) {
    BakeRequest request;
    request.op = resolve_operator(op);
    if (application) request.application = &find_lut_application(application);
    return request;
}

/// bake(), and its warnings.
BakeResult baked(const BakeRequest& request, std::vector<std::string>* warnings = nullptr) {
    return bake(request, {.warn = [&](const std::string& line) {
                    if (warnings) warnings->push_back(line);
                }});
}

TEST(BakeTask, ApplicationDecidesWhatHasNoValue) {
    const LutApplication& resolve = find_lut_application("resolve");
    const LutRequest lut = lut_request_of(request_for("agx_sobotka", "resolve"), resolve.format);
    EXPECT_EQ(lut.encoding.id, resolve.encoding);
    EXPECT_EQ(lut.view.display, resolve.display);
    EXPECT_EQ(lut.size, resolve.size);
    EXPECT_EQ(lut.dimension, LutDimension::three);
    EXPECT_TRUE(has_usual_input(resolve, lut));

    BakeRequest given = request_for("agx_sobotka", "resolve");
    given.encoding = parse_input_encoding("logc3");
    given.display = "rec1886";
    given.size = 17;
    const LutRequest own = lut_request_of(given, resolve.format);
    EXPECT_EQ(own.encoding.id, "logc3");
    EXPECT_EQ(own.view.input, own.encoding.default_input);
    EXPECT_EQ(own.view.display, "rec1886");
    EXPECT_EQ(own.size, 17);
}

TEST(BakeTask, CurveIsATableWhereTheApplicationConvertsPrimaries) {
    const LutApplication& resolve = find_lut_application("resolve");
    BakeRequest request = request_for("reinhard", "resolve");
    EXPECT_EQ(lut_request_of(request, resolve.format).dimension, LutDimension::automatic);
    EXPECT_FALSE(lut_request_of(request, resolve.format).size);
    request.dimension = LutDimension::three;
    EXPECT_EQ(lut_request_of(request, resolve.format).size, resolve.size);
}

TEST(BakeTask, ChainOfAnApplicationIsSceneLinear) {
    const LutRequest lut = lut_request_of(request_for("gt7", "nuke"), LutFormat::ctf);
    EXPECT_TRUE(lut.encoding.is_linear);
    EXPECT_EQ(lut.view.input, lut.encoding.default_input);
    EXPECT_FALSE(lut.size);
    EXPECT_EQ(lut.dimension, LutDimension::automatic);
}

TEST(BakeTask, WithoutAnApplicationTheInputIsAcescct) {
    BakeRequest request = request_for("agx_sobotka");
    request.exposure_stops = 1;
    const LutRequest lut = lut_request_of(request, LutFormat::cube);
    EXPECT_EQ(lut.encoding.id, kDefaultLutEncoding);
    EXPECT_EQ(lut.view.input, "lin_ap1");
    EXPECT_EQ(lut.view.display, "srgb");
    EXPECT_EQ(lut.view.exposure_stops, 1);
    request.input = &find_input_space("lin_rec709");
    EXPECT_EQ(lut_request_of(request, LutFormat::cube).view.input, "lin_rec709");
}

TEST(BakeTask, RefusesContradictions) {
    BakeRequest request = request_for("agx_sobotka");
    request.icc_version = 4;
    EXPECT_EQ(error_of([&] { (void)lut_request_of(request, LutFormat::cube); }),
              "icc_version is given for cube; expected format icc with it");
    request.icc_version = 3;
    EXPECT_EQ(error_of([&] { (void)lut_request_of(request, LutFormat::icc); }),
              "icc version is 3; expected 2 or 4");
    request = request_for("agx_sobotka", "unreal");
    request.max_error = 0.1;
    EXPECT_EQ(error_of([&] { (void)lut_request_of(request, LutFormat::strip); }),
              "max_error is given for unreal; expected none, because its size is 16");
    request = request_for("agx_sobotka", "resolve");
    request.size = 129;
    EXPECT_EQ(error_of([&] { (void)lut_request_of(request, request.application->format); }),
              "size is 129; expected at most 65 for resolve");
}

TEST(BakeTask, WritesTheFileAndTellsTheErrors) {
    const Folder folder;
    BakeRequest request = request_for("clamp");
    request.file = folder / "a.cube";
    request.input = &find_input_space("lin_rec709");
    request.dimension = LutDimension::three;
    request.size = 17;
    request.nodes = LutNodes::sampled;
    const BakeResult result = baked(request);
    EXPECT_NE(read(request.file).find("LUT_3D_SIZE 17"), std::string::npos);
    EXPECT_EQ(result.baked.lut.size, 17);
    EXPECT_EQ(result.request.size, 17);
    EXPECT_GT(result.baked.error.max, 0);
    EXPECT_TRUE(result.operations.empty());
    EXPECT_TRUE(result.steps.empty()) << "no application";
}

TEST(BakeTask, WarnsBeforeItWrites) {
    const Folder folder;
    BakeRequest request = request_for("drago");
    request.file = folder / "a.cube";
    request.size = 17;
    request.nodes = LutNodes::sampled;
    std::vector<std::string> warnings;
    (void)baked(request, &warnings);
    ASSERT_FALSE(warnings.empty());
    EXPECT_NE(warnings[0].find("measures each picture"), std::string::npos) << warnings[0];
    std::filesystem::remove(request.file);
    const auto refuse = [](const std::string& line) { throw Error(line); };
    EXPECT_EQ(error_of([&] { (void)bake(request, {.warn = refuse}); }), render(warnings[0]));
    EXPECT_TRUE(folder.files().empty());
}

TEST(BakeTask, PictureIsForTheCallerToWrite) {
    const Folder folder;
    BakeRequest request = request_for("agx_sobotka");
    request.file = folder / "a.tif";
    request.format = LutFormat::hald;
    request.size = 16;
    request.nodes = LutNodes::sampled;
    std::vector<int> written;
    request.write_picture = [&](const Lut& lut, LutFormat format, const std::string& path,
                                int bits) {
        EXPECT_EQ(format, LutFormat::hald);
        EXPECT_EQ(path, request.file);
        written = {lut.size, bits};
    };
    (void)baked(request);
    EXPECT_EQ(written, (std::vector<int>{16, 16}));
    request.file = folder / "a.exr";
    EXPECT_EQ(error_of([&] { (void)baked(request); }),
              "file is " + request.file + "; expected .png or .tif for 16 bits");
}

TEST(BakeTask, StepsAreForTheFile) {
    const Folder folder;
    BakeRequest request = request_for("reinhard", "ffmpeg");
    request.file = folder / "a.cube";
    request.size = 17;
    request.nodes = LutNodes::sampled;
    const std::vector<std::string> steps = baked(request).steps;
    ASSERT_EQ(steps.size(), 1U);
    EXPECT_NE(steps[0].find(request.file), std::string::npos) << steps[0];
    request.file = folder / "with blank.cube";
    EXPECT_NE(baked(request).steps[0].find("FILE"), std::string::npos);
}

TEST(BakeTask, RefusesAFolderFirst) {
    const Folder folder;
    BakeRequest request = request_for("agx_sobotka");
    request.file = folder.path();
    EXPECT_EQ(error_of([&] { (void)baked(request); }), "write: " + folder.path() + ": is a folder");
}

TEST(BakeTask, NamesOfNodes) {
    EXPECT_EQ(parse_lut_nodes("auto"), LutNodes::automatic);
    EXPECT_EQ(parse_lut_nodes("sampled"), LutNodes::sampled);
    EXPECT_EQ(parse_lut_nodes("fitted"), LutNodes::fitted);
    EXPECT_EQ(parse_lut_nodes("smooth"), LutNodes::smooth);
    EXPECT_THROW((void)parse_lut_nodes("round"), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
