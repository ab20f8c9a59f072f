// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/compare.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/registry.h"
#include "unit/errors.h"
#include "unit/image/picture_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class ComparisonFiles : public PictureFiles {
  protected:
    ComparisonFiles() { write_image_atomically(make_rgb(64, 48), file("in.exr")); }
    [[nodiscard]] ComparisonRequest request(const std::vector<std::string>& operators) const {
        ComparisonRequest request;
        request.in = file("in.exr");
        request.file = file("sheet.png");
        for (const std::string& op : operators)
            request.operators.push_back(resolve_picture_operator(op));
        request.cell_width = 64;
        return request;
    }
};

TEST_F(ComparisonFiles, OutputsAreOtherFiles) {
    ComparisonRequest same = request({"hable"});
    same.file = same.in;
    EXPECT_NE(error_of([&] { Comparison comparison(same); }).find("the same file as the input"),
              std::string::npos);
    EXPECT_TRUE(is_same_file(same.in, same.file));
    EXPECT_FALSE(is_same_file(same.in, file("none")));
}

TEST_F(ComparisonFiles, SheetAndPicturesAreWritten) {
    ComparisonRequest wanted = request({"hable", "drago"});
    wanted.pictures = file("pictures");
    wanted.difference = 2;
    wanted.columns = 3;
    Comparison(wanted).write(make_rgb(64, 48));
    EXPECT_GT(read_image(file("sheet.png")).spec().width, 3 * 64);
    EXPECT_EQ(read_image(file("pictures/hable.png")).spec().width, 64);
    EXPECT_EQ(read_image(file("pictures/drago.png")).spec().width, 64);
}

TEST_F(ComparisonFiles, SplitHasThePicturesSize) {
    ComparisonRequest wanted = request({"hable", "clamp"});
    wanted.split = 0.5;
    wanted.has_labels = false;
    wanted.resize = "32";
    Comparison(wanted).write(make_rgb(64, 48));
    wanted.operators.pop_back();
    EXPECT_THROW(Comparison comparison(wanted), Error) << "one operator";
    const OIIO::ImageBuf sheet = read_image(file("sheet.png"));
    EXPECT_EQ(sheet.spec().width, 32);
    // Each half is that of the operator alone.
    for (const auto& [op, x] : {std::pair("hable", 8), std::pair("clamp", 24)}) {
        ComparisonRequest alone = request({op});
        alone.resize = "32";
        alone.pictures = file("alone");
        Comparison(alone).write(make_rgb(64, 48));
        const OIIO::ImageBuf shown = read_image(file("alone/" + std::string(op) + ".png"));
        for (int c = 0; c < 3; ++c)
            EXPECT_EQ(sheet.getchannel(x, 12, 0, c), shown.getchannel(x, 12, 0, c)) << op;
    }
}

TEST_F(ComparisonFiles, SheetsHaveALimit) {
    ComparisonRequest wanted = request({"hable"});
    wanted.cell_width = 16384;
    EXPECT_NE(
        error_of([&] { Comparison(wanted).write(make_rgb(64, 64)); }).find("expected at most"),
        std::string::npos);
}

TEST(Legend, IsBelowThePicture) {
    const OIIO::ImageBuf picture = make_rgb(320, 100);
    const OIIO::ImageBuf shown = with_legend(picture);
    EXPECT_GT(shown.spec().height, 120);
    ASSERT_EQ(shown.nchannels(), 3);
    const int margin = (shown.spec().width - 320) / 2;
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(319, 99), std::pair(160, 50)}) {
        for (int c = 0; c < 3; ++c) {
            // Sheets have 8 bits.
            EXPECT_NEAR(shown.getchannel(x + margin, y + margin, 0, c),
                        picture.getchannel(x, y, 0, c), 0.51 / 255)
                << x << " " << y;
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
