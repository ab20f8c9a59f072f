// SPDX-License-Identifier: Apache-2.0
//
// Local operators on planes. Their numbers are held to NumPy by
// python_check/local_operators.py; here is what has to be so for every picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "tonewright/local.h"
#include "tonewright/registry.h"
#include "unit/local/planes.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class Local : public testing::TestWithParam<std::string> {
  protected:
    [[nodiscard]] const Operator& op() const { return *resolve_picture_operator(GetParam()).op; }
};

TEST(LocalOperators, AreSortedAndApartFromTheOthers) {
    ASSERT_FALSE(local_operators().empty());
    for (std::size_t i = 0; i < local_operators().size(); ++i) {
        const Operator& op = local_operators()[i];
        EXPECT_TRUE(op.is_local()) << op.id;
        EXPECT_TRUE(op.build(resolve_picture_operator(op.id).params).empty()) << op.id;
        if (i > 0) {
            EXPECT_LT(local_operators()[i - 1].id, op.id);
        }
        for (const Operator& other : all_operators())
            EXPECT_NE(other.id, op.id);
        for (const std::string& text : {op.title, op.character, op.source, op.license})
            EXPECT_FALSE(text.empty()) << op.id;
    }
    for (const Operator& op : all_operators())
        EXPECT_FALSE(op.is_local()) << op.id;
}

TEST(LocalOperators, OtherBackendsRefuseThem) {
    for (const Operator& op : local_operators()) {
        for (const bool resolve : {false, true}) {
            try {
                if (resolve) {
                    (void)resolve_operator(op.id);
                } else {
                    (void)find_operator(op.id);
                }
                ADD_FAILURE() << op.id << " was found";
            } catch (const Error& e) {
                const std::string message = e.what();
                EXPECT_TRUE(message.starts_with("operator is " + op.id +
                                                ", a local operator, which needs a picture"))
                    << message;
                EXPECT_NE(message.find("or apply with a picture"), std::string::npos) << message;
            }
        }
    }
}

TEST(LocalOperators, WrongPlanesAndOperatorsAreRefused) {
    ScenePlanes picture = make_light(4, 3);
    EXPECT_THROW(run_local_operator(resolve_operator("hable"), picture), Error);
    picture.rgb[1].pop_back();
    EXPECT_THROW(run_local_operator(resolve_picture_operator("reinhard_local"), picture), Error);
    ScenePlanes empty;
    EXPECT_THROW(run_local_operator(resolve_picture_operator("reinhard_local"), empty), Error);
}

TEST(LocalOperators, WholeNumbersOnly) {
    for (const auto& [op, name] :
         {std::pair("reinhard_local", "scales"), std::pair("exposure_fusion", "mip"),
          std::pair("exposure_fusion", "display_mip")}) {
        EXPECT_NO_THROW((void)resolve_picture_operator(op, {{name, "2"}}));
        EXPECT_THROW((void)resolve_picture_operator(op, {{name, "2.5"}}), Error);
    }
}

TEST_P(Local, PartsDoNotMatter) {
    // Wider than the strips that the operators work in, and odd.
    const ScenePlanes picture = make_light(1301, 71);
    const auto whole = run(op(), picture);
    for (const int step : {1, 7, 32}) {
        ScenePlanes parts = picture;
        parts.for_rows = [step](int count, const std::function<void(int, int)>& body) {
            // From the last to the first: none relies on another.
            for (int begin = (count - 1) / step * step; begin >= 0; begin -= step)
                body(begin, std::min(begin + step, count));
        };
        const auto result = run(op(), parts);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(std::memcmp(whole[c].data(), result[c].data(), 4 * whole[c].size()), 0)
                << step << ", channel " << c;
        }
    }
}

TEST_P(Local, BlackStaysBlackAndSmallPicturesAreNoError) {
    for (const auto& [width, height] :
         {std::pair(1, 1), std::pair(1, 9), std::pair(9, 1), std::pair(2, 2), std::pair(7, 5)}) {
        for (const float peak : {0.0F, 3.0F}) {
            ScenePlanes picture = make_light(width, height, peak);
            for (const std::vector<float>& plane : run(op(), picture)) {
                for (std::size_t i = 0; i < plane.size(); ++i) {
                    EXPECT_TRUE(std::isfinite(plane[i]) && plane[i] >= 0) << plane[i];
                    const float light = picture.rgb[0][i] + picture.rgb[1][i] + picture.rgb[2][i];
                    if (light == 0) {
                        EXPECT_EQ(plane[i], 0);
                    }
                }
            }
        }
    }
}

TEST_P(Local, ExposureIsACorrectionOnTop) {
    // A uniform picture: brighter with exposure, whatever was measured.
    ScenePlanes picture;
    picture.width = picture.height = 8;
    for (std::vector<float>& plane : picture.rgb)
        plane.assign(64, 0.1F);
    const float normal = run(op(), picture)[1][20];
    picture.exposure = 2;
    const float brighter = run(op(), picture)[1][20];
    EXPECT_GT(brighter, normal * 1.2F);
}

std::vector<std::string> ids() {
    std::vector<std::string> all;
    for (const Operator& op : local_operators())
        all.push_back(op.id);
    return all;
}
INSTANTIATE_TEST_SUITE_P(Every, Local, testing::ValuesIn(ids()),
                         [](const auto& of) { return of.param; });

TEST(LocalOperators, RowsInTurnAreOnePart) {
    std::vector<std::pair<int, int>> parts;
    run_rows_in_turn(7, [&](int begin, int end) { parts.emplace_back(begin, end); });
    EXPECT_EQ(parts, (std::vector<std::pair<int, int>>{{0, 7}}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
