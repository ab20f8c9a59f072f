// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "image/canvas.h"
#include "tonewright/contact_sheet.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using Labeled = std::vector<std::pair<std::string, ImageBuf>>;

ImageBuf flat(int width, int height, const std::vector<float>& color,
              TypeDesc type = TypeDesc::UINT8) {
    ImageBuf picture(ImageSpec(width, height, static_cast<int>(color.size()), type));
    OIIO::ImageBufAlgo::fill(picture, color);
    return picture;
}

/// Columns and rows that hold the given color, within a code value.
OIIO::ROI extent_of(const ImageBuf& sheet, const std::vector<float>& color) {
    OIIO::ROI extent(sheet.xend(), 0, sheet.yend(), 0);
    for (int y = 0; y < sheet.yend(); ++y) {
        for (int x = 0; x < sheet.xend(); ++x) {
            bool same = true;
            for (int c = 0; c < 3; ++c) {
                same = same && std::fabs(sheet.getchannel(x, y, 0, c) -
                                         color[static_cast<std::size_t>(c)]) < 1.5F / 255;
            }
            if (!same) continue;
            extent.xbegin = std::min(extent.xbegin, x);
            extent.xend = std::max(extent.xend, x + 1);
            extent.ybegin = std::min(extent.ybegin, y);
            extent.yend = std::max(extent.yend, y + 1);
        }
    }
    return extent;
}

TEST(ContactSheet, PicturesKeepTheirShapeAndColors) {
    const std::vector<float> red = {0.8F, 0.2F, 0.1F};
    const std::vector<float> blue = {0.1F, 0.2F, 0.8F};
    const ImageBuf sheet =
        make_contact_sheet({{"wide", flat(200, 100, red)}, {"tall", flat(60, 90, blue)}}, 2, 120);
    EXPECT_EQ(sheet.spec().format, TypeDesc::UINT8);
    EXPECT_EQ(sheet.nchannels(), 3);
    EXPECT_EQ(sheet.spec().get_string_attribute("oiio:ColorSpace"), "sRGB");
    const OIIO::ROI wide = extent_of(sheet, red);
    EXPECT_EQ(wide.width(), 120);
    EXPECT_EQ(wide.height(), 60);
    const OIIO::ROI tall = extent_of(sheet, blue);
    EXPECT_EQ(tall.width(), 120);
    EXPECT_EQ(tall.height(), 180);
    // Margins: equal at the left, between, at the right and at the top.
    EXPECT_EQ(wide.xbegin, tall.ybegin);
    EXPECT_EQ(tall.xbegin - wide.xend, wide.xbegin);
    EXPECT_EQ(sheet.xend() - tall.xend, wide.xbegin);
    // The smaller picture stands in the middle of the row.
    EXPECT_EQ(wide.ybegin - tall.ybegin, tall.yend - wide.yend);
}

TEST(ContactSheet, LabelsAreBelow) {
    const std::vector<float> red = {0.8F, 0.2F, 0.1F};
    const auto lit_below = [&](const std::string& label) {
        const ImageBuf sheet = make_contact_sheet({{label, flat(100, 100, red)}}, 1, 200);
        const OIIO::ROI picture = extent_of(sheet, red);
        int lit = 0;
        for (int y = picture.yend; y < sheet.yend(); ++y) {
            for (int x = 0; x < sheet.xend(); ++x)
                lit += sheet.getchannel(x, y, 0, 1) > 0.5F ? 1 : 0;
        }
        return lit;
    };
    EXPECT_EQ(lit_below(""), 0);
    EXPECT_GT(lit_below("AgX"), 20);
    EXPECT_GT(lit_below("Hable (Uncharted 2)"), lit_below("AgX"));
    EXPECT_GT(lit_below("\xC3\xA4\xE6\x97\xA5"), 0);  // two question marks
}

TEST(ContactSheet, Rows) {
    Labeled pictures;
    for (int i = 0; i < 5; ++i)
        pictures.emplace_back("p", flat(100, 50, {0.5F, 0.6F, 0.7F}));
    const ImageBuf two = make_contact_sheet(pictures, 2, 100);
    const ImageBuf five = make_contact_sheet(pictures, 5, 100);
    const ImageBuf many = make_contact_sheet(pictures, 9, 100);
    EXPECT_LT(two.spec().width, five.spec().width);
    EXPECT_GT(two.spec().height, 2 * five.spec().height);
    EXPECT_EQ(five.spec().width, many.spec().width);  // no empty columns
}

TEST(ContactSheet, ShrinksLightNotCodeValues) {
    ImageBuf checker(ImageSpec(200, 200, 3, TypeDesc::UINT8));
    OIIO::ImageBufAlgo::checker(checker, 1, 1, 1, {0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F});
    const ImageBuf sheet = make_contact_sheet({{"", checker}}, 1, 50);
    // Half of the light is the sRGB code value 187.5.
    EXPECT_NEAR(255 * sheet.getchannel(sheet.xend() / 2, 20, 0, 1), 187.5, 1.5);
}

TEST(ContactSheet, OtherPictures) {
    // Gray; float; with alpha; data window smaller than the display window; pixels not square.
    EXPECT_EQ(extent_of(make_contact_sheet({{"", flat(10, 10, {0.6F})}}, 1, 40), {0.6F, 0.6F, 0.6F})
                  .width(),
              40);
    EXPECT_EQ(extent_of(make_contact_sheet(
                            {{"", flat(10, 10, {0.6F, 0.3F, 0.9F, 0.5F}, TypeDesc::FLOAT)}}, 1, 40),
                        {0.6F, 0.3F, 0.9F})
                  .height(),
              40);
    ImageBuf window = flat(20, 20, {0.6F, 0.3F, 0.9F});
    window.set_full(0, 40, 0, 20, 0, 1);
    EXPECT_EQ(extent_of(make_contact_sheet({{"", window}}, 1, 40), {0.6F, 0.3F, 0.9F}).width(), 20);
    ImageBuf anamorphic = flat(20, 20, {0.6F, 0.3F, 0.9F});
    anamorphic.specmod().attribute("PixelAspectRatio", 2.0F);
    EXPECT_EQ(extent_of(make_contact_sheet({{"", anamorphic}}, 1, 40), {0.6F, 0.3F, 0.9F}).height(),
              20);
}

TEST(ContactSheet, WordsAndPatchesAround) {
    const std::vector<float> red = {0.8F, 0.2F, 0.1F};
    const Labeled one = {{"Title\nid", flat(100, 100, red)}};
    const ImageBuf plain = make_contact_sheet({{"Title", flat(100, 100, red)}}, 1, 200);
    const ImageBuf two_lines = make_contact_sheet(one, 1, 200);
    EXPECT_GT(two_lines.spec().height, plain.spec().height);
    SheetAnnotations around;
    around.heading = "picture.exr";
    around.remark = "exposure 0";
    around.legend = {{"-1", {0.9F, 0, 0}}, {"0", {0, 0.9F, 0}}, {"+1", {0, 0, 0.9F}}};
    const ImageBuf sheet = make_contact_sheet(one, 1, 200, around);
    EXPECT_EQ(sheet.spec().width, two_lines.spec().width);
    const OIIO::ROI picture = extent_of(sheet, red);
    EXPECT_EQ(picture.width(), 200);
    EXPECT_EQ(picture.height(), 200);
    EXPECT_GT(picture.ybegin, extent_of(two_lines, red).ybegin);
    // From the left edge of the pictures to their right one, one after the other, below.
    int left = picture.xbegin;
    for (const auto& [label, color] : around.legend) {
        const OIIO::ROI patch = extent_of(sheet, {color[0], color[1], color[2]});
        EXPECT_EQ(patch.xbegin, left) << label;
        EXPECT_GT(patch.ybegin, picture.yend);
        left = patch.xend;
    }
    EXPECT_EQ(left, picture.xend);
}

TEST(ContactSheet, APictureOfTheCellsSizeKeepsItsPixels) {
    ImageBuf picture(ImageSpec(64, 48, 3, TypeDesc::FLOAT));
    auto* pixels = static_cast<float*>(picture.localpixels());
    for (int i = 0; i < 64 * 48 * 3; ++i)
        pixels[i] = static_cast<float>(i % 4093) / 4093;
    const ImageBuf sheet = make_contact_sheet({{"", picture}}, 1, 64);
    ImageBuf expected;
    expected.copy(picture, TypeDesc::UINT8);
    const int margin = (sheet.spec().width - 64) / 2;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c) {
                ASSERT_EQ(sheet.getchannel(margin + x, margin + y, 0, c),
                          expected.getchannel(x, y, 0, c));
            }
        }
    }
}

TEST(ContactSheet, BadArguments) {
    const Labeled one = {{"a", flat(4, 4, {0.5F, 0.5F, 0.5F})}};
    EXPECT_THROW((void)make_contact_sheet({}, 1, 100), Error);
    EXPECT_THROW((void)make_contact_sheet(one, 0, 100), Error);
    EXPECT_THROW((void)make_contact_sheet(one, 1, 15), Error);
    EXPECT_THROW((void)make_contact_sheet({{"a", ImageBuf()}}, 1, 100), Error);
    EXPECT_THROW((void)make_contact_sheet({{"a", ImageBuf("/nonexistent.png")}}, 1, 100), Error);
    // A million pixels high: no sheet that anything could show.
    EXPECT_THROW((void)make_contact_sheet({{"a", flat(1, 1000, {0.5F})}}, 1, 1000), Error);
}

TEST(Canvas, TextIsMeasuredAndCut) {
    EXPECT_EQ(text_width("", 10), 0);
    EXPECT_GT(text_width("WW", 10), text_width("ii", 10));
    EXPECT_NEAR(text_width("AgX", 20), 2 * text_width("AgX", 10), 1e-9);
    EXPECT_EQ(fit_text("AgX", 10, 1000), "AgX");
    const std::string cut = fit_text("Reinhard Extended on the largest channel", 10, 100);
    EXPECT_TRUE(cut.ends_with("...")) << cut;
    EXPECT_TRUE(cut.starts_with("Reinh")) << cut;
    EXPECT_LE(text_width(cut, 10), 100);
    EXPECT_EQ(fit_text("abc", 10, 0), "...");
}

TEST(Canvas, EveryPrintableCharacterIsDrawn) {
    for (char c = '!'; c <= '~'; ++c) {
        Canvas canvas(40, 40, gray_of(0));
        canvas.text(std::string(1, c), 10, 28, 16, gray_of(1));
        double sum = 0;
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 40; ++x)
                sum += static_cast<double>(canvas.at(x, y)[0]);
        }
        EXPECT_GT(sum, 1.5) << c;
        EXPECT_LT(sum, 200) << c;
    }
}

/// Number of connected light (or dark) parts of a picture: with 8 neighbors for light parts, 4 for
/// dark ones.
int parts_of(Canvas& canvas, bool is_light) {
    const int width = canvas.width();
    const int height = canvas.height();
    std::vector<bool> is_seen(static_cast<std::size_t>(width * height));
    const auto is_new = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < width && y < height &&
               (canvas.at(x, y)[0] > 0.5F) == is_light &&
               !is_seen[static_cast<std::size_t>(y * width + x)];
    };
    int parts = 0;
    for (int start = 0; start < width * height; ++start) {
        std::vector<std::pair<int, int>> open;
        const auto visit = [&](int x, int y) {
            if (!is_new(x, y)) return;
            is_seen[static_cast<std::size_t>(y * width + x)] = true;
            open.emplace_back(x, y);
        };
        visit(start % width, start / width);
        parts += open.empty() ? 0 : 1;
        while (!open.empty()) {
            const auto [x, y] = open.back();
            open.pop_back();
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    if (is_light || dx == 0 || dy == 0) visit(x + dx, y + dy);
                }
            }
        }
    }
    return parts;
}

// Facts about Latin letters and digits that do not depend on how they are drawn.
TEST(Canvas, LettersHaveTheHolesAndPartsOfTheirShapes) {
    const std::string one_hole = "ADOPRabdegopq0469#";
    const std::string two_holes = "B8%";
    const std::string two_parts = "ij:;!?=\"";
    for (char c = '!'; c <= '~'; ++c) {
        if (std::string("$&@Q").find(c) != std::string::npos) continue;  // drawn in several ways
        Canvas canvas(160, 200, gray_of(0));
        canvas.text(std::string(1, c), 20, 150, 112, gray_of(1));
        const auto is_in = [&](const std::string& set) { return set.find(c) != std::string::npos; };
        EXPECT_EQ(parts_of(canvas, false) - 1, is_in(two_holes) ? 2 : is_in(one_hole) ? 1 : 0) << c;
        EXPECT_EQ(parts_of(canvas, true), c == '%' ? 3 : is_in(two_parts) ? 2 : 1) << c;
    }
}

TEST(Canvas, LettersAreSymmetricWhereTheirShapesAre) {
    // The strokes of one letter, mirrored, are those of the other. y up.
    const auto looks_like = [](char letter, char other, bool mirrors_y) {
        const auto draw = [](char c) {
            Canvas canvas(160, 200, gray_of(0));
            canvas.text(std::string(1, c), 80, 130, 56, gray_of(1), Canvas::Align::center);
            return canvas;
        };
        Canvas a = draw(letter);
        Canvas b = draw(other);
        const auto is_small = [](char c) {
            return std::islower(static_cast<unsigned char>(c)) != 0;
        };
        const int axis =
            is_small(letter) ? 130 - 20 : 130 - 28;  // half of 5 or 7 units of 8 pixels
        double common = 0;
        double all = 0;
        for (int y = 10; y < 190; ++y) {
            for (int x = 0; x < 160; ++x) {
                const bool in_a = a.at(x, y)[0] > 0.5F;
                const int other_y = mirrors_y ? 2 * axis - 1 - y : y;
                const int other_x = mirrors_y ? x : 159 - x;
                const bool in_b = other_y >= 0 && other_y < 200 && b.at(other_x, other_y)[0] > 0.5F;
                common += in_a && in_b ? 1 : 0;
                all += in_a || in_b ? 1 : 0;
            }
        }
        return common / all > 0.8;  // an edge of antialiased strokes 7 pixels wide
    };
    for (const char c : std::string("AHIMOTUVWXYovwx0+-=_|^*!\":.'"))
        EXPECT_TRUE(looks_like(c, c, false)) << c;
    for (const auto& [left, right] : {std::pair{'(', ')'},
                                      {'[', ']'},
                                      {'<', '>'},
                                      {'{', '}'},
                                      {'/', '\\'},
                                      {'b', 'd'},
                                      {'p', 'q'}})
        EXPECT_TRUE(looks_like(left, right, false)) << left << right;
    for (const char c : std::string("CDEHIOX0oxc"))
        EXPECT_TRUE(looks_like(c, c, true)) << c;
    for (const char c : std::string("BCDEFGJKLNPQRSZ"))
        EXPECT_FALSE(looks_like(c, c, false)) << c;
}

TEST(Canvas, NothingIsDrawnOutside) {
    Canvas canvas(10, 10, gray_of(0));
    canvas.text("Tonewright", -50, 5, 12, gray_of(1));
    canvas.text("Tonewright", 8, 500, 12, gray_of(1));
    canvas.fill(-5, -5, 3, 3, gray_of(1));
    canvas.fill(8, 8, 100, 100, gray_of(1));
    EXPECT_EQ(canvas.at(0, 0)[0], 1);
    EXPECT_EQ(canvas.at(9, 9)[0], 1);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
