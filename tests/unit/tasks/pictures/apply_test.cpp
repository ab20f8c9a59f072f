// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/apply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "picture/row_fitter.h"
#include "tasks/pictures/read_picture.h"
#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/image/picture_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using ApplyFiles = PictureFiles;
using Unpremult = TonemapOptions::Unpremult;

TEST(Apply, WithoutAlphaColorIsTakenAsItIs) {
    TonemapOptions options;
    WriteOptions write;
    take_alpha(options, write);
    EXPECT_EQ(options.unpremult, Unpremult::automatic);
    write.alpha = WriteOptions::Alpha::opaque;
    take_alpha(options, write);
    EXPECT_EQ(options.unpremult, Unpremult::no);
    options.unpremult = Unpremult::yes;
    EXPECT_EQ(error_of([&] { take_alpha(options, write); }),
              "alpha is opaque; expected keep with unpremult=yes, which divides by alpha");
}

TEST_F(ApplyFiles, FilesWithAProblemAreLeftOut) {
    write_image_atomically(make_rgb(16, 12), file("a.exr"));
    std::vector<FrameFiles> files = {{file("a.exr"), file("a.png")},
                                     {file("a.exr"), file("b.png")}};
    files[1].problem = Problem{.what = "known"};
    std::vector<std::string> done;
    SequenceOptions options;
    options.done = [&](const FrameFiles& frame) { done.push_back(frame.out); };
    tonemap_pictures(Tonemapper({.op = resolve_picture_operator("hable")}), files, options, 0);
    EXPECT_FALSE(files[0].problem);
    EXPECT_EQ(files[1].problem->what, "known");
    EXPECT_EQ(done, (std::vector<std::string>{file("a.png")}));
    EXPECT_FALSE(std::filesystem::exists(file("b.png")));
}

TEST_F(ApplyFiles, LegendIsBelowThePicture) {
    const Tonemapper tonemapper({.op = resolve_picture_operator("false_color")});
    write_with_legend(tonemapper, make_rgb(320, 100), {"a.exr", file("a.png")}, {}, {}, 1);
    const OIIO::ImageBuf shown = read_image(file("a.png"));
    EXPECT_GT(shown.spec().width, 319);
    EXPECT_GT(shown.spec().height, 120);
    OIIO::ImageBuf alone;
    ASSERT_TRUE(tonemapper(alone, make_rgb(320, 100)));
    const int margin = (shown.spec().width - 320) / 2;
    for (int c = 0; c < 3; ++c) {  // the file has 8 bits
        EXPECT_NEAR(shown.getchannel(200 + margin, 60 + margin, 0, c),
                    alone.getchannel(200, 60, 0, c), 1.01 / 255);
    }
}

TEST_F(ApplyFiles, LutGetsEncodedColors) {
    Lut identity;
    identity.dimension = 3;
    identity.size = 2;
    for (int i = 0; i < 8; ++i) {
        for (const int bit : {1, 2, 4})
            identity.values.push_back((i & bit) != 0 ? 1.0F : 0.0F);
    }
    const LutFile lut(identity);
    TonemapOptions light;
    light.input = "lin_rec709";
    const OIIO::ImageBuf picture = noise_picture();
    const LutSource source = lut_source(picture, "a.exr", light, {}, 1);
    EXPECT_EQ(source.name, "lin_rec709");
    LutPictureRequest request = {.lut = lut,
                                 .lut_name = "identity.cube",
                                 .before = {},
                                 .display = "srgb",
                                 .unpremult = Unpremult::no,
                                 .resize = {},
                                 .write = {},
                                 .nthreads = 1};
    request.write.write_provenance = true;
    write_through_lut(source, {"a.exr", file("out.exr")}, request);
    const OIIO::ImageBuf written = read_image(file("out.exr"));
    EXPECT_NE(written.spec()["Software"].get().find("LUT identity.cube"), std::string::npos);
    std::vector<float> was(160 * 120 * 3), is(160 * 120 * 3);
    picture.get_pixels(picture.roi(), OIIO::TypeFloat, was.data());
    written.get_pixels(written.roi(), OIIO::TypeFloat, is.data());
    for (std::size_t i = 0; i < was.size(); ++i)
        ASSERT_NEAR(was[i], is[i], 1e-6);
    ReadOptions resize;
    resize.resize = "80";
    EXPECT_EQ(lut_source(picture, "a.exr", light, resize, 1).picture.spec().width, 80);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
