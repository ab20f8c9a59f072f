// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/frames.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/image_io.h"
#include "unit/errors.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Numbers = std::vector<int>;

TEST(Frames, RangesAreParsed) {
    EXPECT_EQ(parse_frames("3-1"), (Numbers{3, 2, 1}));
    EXPECT_EQ(parse_frames("1-9x4,-2"), (Numbers{1, 5, 9, -2}));
    for (const char* text : {"", "1-", "1-9x0", "a", "1,,2", "0-9999999"}) {
        EXPECT_NE(error_of([&] { (void)parse_frames(text); }).find("expected frames such as"),
                  std::string::npos)
            << text;
    }
}

TEST(Frames, AreFormattedInOrder) {
    EXPECT_EQ(format_frames({5, 1, 2, 3, 3}), "1-3,5");
    EXPECT_EQ(format_frames({1, 3, 5, 7, 8}), "1-7x2,8");
}

TEST(Frames, NumbersReplacePlaceholders) {
    EXPECT_EQ(frame_name("in", "a/s.####.exr", 7), "a/s.0007.exr");
    EXPECT_EQ(frame_name("in", "s_%03d.#.exr", 12), "s_012.0012.exr");
    EXPECT_EQ(frame_name("in", "a@/s.@@.exr", 5), "a@/s.05.exr");
    EXPECT_TRUE(is_frame_pattern("s.%d.exr"));
    EXPECT_FALSE(is_frame_pattern("s%.exr"));
    EXPECT_TRUE(error_of([] {
                    (void)frame_name("out", "s.exr", 1);
                }).starts_with("out is s.exr; expected a placeholder"));
}

/// The frames 1, 2 and 4 of a shot.
class PlannedShot : public testing::Test {
  protected:
    PlannedShot() {
        for (const int number : {1, 2, 4})
            write_image_atomically(make_rgb(8, 6), frame_name("in", in(), number));
    }
    [[nodiscard]] std::string in() const { return folder_ / "in.#.exr"; }
    [[nodiscard]] ShotRequest request(Numbers numbers, ShotRequest::Missing missing) const {
        return {in(), folder_ / "out.#.png", std::move(numbers), missing};
    }
    Folder folder_;
};

TEST_F(PlannedShot, MissingFramesHaveTheirReason) {
    const Shot shot = plan_shot(request({1, 3}, ShotRequest::Missing::error));
    ASSERT_EQ(shot.numbers, (Numbers{1, 3}));
    EXPECT_FALSE(shot.frames[0].problem);
    ASSERT_TRUE(shot.frames[1].problem);
    EXPECT_NE(unrendered(*shot.frames[1].problem).find("No such file"), std::string::npos);
}

TEST_F(PlannedShot, MissingFramesAreSkippedOrHeld) {
    const Shot skipped = plan_shot(request({1, 3, 4}, ShotRequest::Missing::skip));
    EXPECT_EQ(skipped.numbers, (Numbers{1, 4}));
    EXPECT_EQ(skipped.missing_count, 1U);
    const Shot held = plan_shot(request({3}, ShotRequest::Missing::hold));
    ASSERT_EQ(held.frames.size(), 1U);
    EXPECT_EQ(held.frames[0].in, frame_name("in", in(), 2));
    EXPECT_EQ(held.held_count, 1U);
}

TEST_F(PlannedShot, NothingIsReadAfterItWasWritten) {
    ShotRequest same = request({1, 2}, ShotRequest::Missing::hold);
    same.out = same.in;
    EXPECT_NE(error_of([&] { (void)plan_shot(same); }).find("which is also an input frame"),
              std::string::npos);
    same.missing = ShotRequest::Missing::error;
    EXPECT_NE(error_of([&] { (void)plan_shot(same); }).find("the same file as the input"),
              std::string::npos);
    same.is_in_place = true;
    EXPECT_EQ(plan_shot(same).frames.size(), 2U);
    EXPECT_EQ(error_of([&] {
                  (void)plan_shot(request({1, 1}, ShotRequest::Missing::skip));
              }),
              "frames names frame 1 twice; expected once");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
