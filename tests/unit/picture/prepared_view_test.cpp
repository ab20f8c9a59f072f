// SPDX-License-Identifier: Apache-2.0
#include "picture/prepared_view.h"

#include <gtest/gtest.h>

#include <array>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

View view_of(const char* op, double stops = 0, const char* display = "linear",
             const char* look = "") {
    return make_view(resolve_operator(op, {}, look), "lin_rec709", stops, display);
}

std::array<float, 3> run(const PreparedView& prepared, std::array<float, 3> color) {
    prepared.engine.run_rgb(color.data(), color.data(), 1);
    return color;
}

TEST(PreparedView, OneProgramServesAllLiveExposures) {
    EXPECT_FALSE(is_live_exposure(0));
    EXPECT_TRUE(is_live_exposure(-16));
    EXPECT_FALSE(is_live_exposure(16.5));
    const PreparedView program(view_of("clamp", 1), {}, 1);
    ASSERT_EQ(program.uniforms.size(), 1U);
    const PreparedView one(program, view_of("clamp", 1));
    EXPECT_EQ(run(one, {0.125F, 0.25F, 0.5F}), (std::array<float, 3>{0.25F, 0.5F, 1}));
    const PreparedView two(program, view_of("clamp", -2));
    EXPECT_EQ(run(two, {0.5F, 1, 2}), (std::array<float, 3>{0.125F, 0.25F, 0.5F}));
    EXPECT_TRUE(PreparedView(view_of("clamp", 20), {}, 1).uniforms.empty());
}

TEST(PreparedView, GraysStayGrayUnlessALookTintsThem) {
    EXPECT_TRUE(PreparedView(view_of("hable", 1, "srgb"), {}, 1).keeps_gray());
    EXPECT_FALSE(PreparedView(view_of("agx_sobotka", 0, "srgb", "golden"), {}, 1).keeps_gray());
}

TEST(PreparedView, MixIsAShareOfTheOperator) {
    // Reinhard's 0.5 / (1 + 0.5), half of it, and half of the clamp's 0.5.
    const PreparedView half(view_of("reinhard"), {}, 0.5);
    EXPECT_NEAR(run(half, {0.5F, 0.5F, 0.5F})[0], 0.5 * (0.5 / 1.5) + 0.25, 1e-6)
        << "a few roundings of floats";
    EXPECT_NO_THROW(check_mix(0, view_of("hable")));
    EXPECT_EQ(error_of([] { check_mix(1.5, view_of("hable")); }), "mix is 1.5; expected [0, 1]");
    EXPECT_EQ(error_of([] { check_mix(0.5, view_of("hable", 0, "native")); }),
              "mix is 0.5; expected 1 with display native");
    const View local =
        make_view(resolve_picture_operator("reinhard_local"), "lin_rec709", 0, "srgb");
    EXPECT_NE(error_of([&] { check_mix(0.5, local); }).find("surroundings"), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
