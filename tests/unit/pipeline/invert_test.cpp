// SPDX-License-Identifier: Apache-2.0
//
// From what a view shows back to the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct InverseRow {
    const char* peak;
    const char* limit;
    Vector3 shown;  // display-linear in the limiting primaries, 1 is 100 cd/m2
    Vector3 scene;  // ACES2065-1
};

/// aces2_inverse_* of the reference collection (check_values.json): an implementation in double of
/// the published algorithm, within 5e-7 of the code of OpenColorIO 2.5.1 compiled in double.
const InverseRow kAces20[] = {
    {"100", "rec709", {0.1, 0.1, 0.1}, {0.18000102319, 0.18000102319, 0.18000102319}},
    {"100", "rec709", {1, 1, 1}, {128, 128, 128}},
    {"100", "rec709", {0.5, 0.3, 0.1}, {0.660001309544, 0.53366247166, 0.178331700447}},
    {"100", "rec709", {0.9, 0.1, 0.05}, {0.822901850029, 0.266542953246, 0.0939035225115}},
    {"100", "rec709", {0.05, 0.6, 0.3}, {0.536586493129, 1.16911166287, 0.609809020562}},
    {"100", "rec709", {0.2, 0.1, 0.8}, {0.481954734427, 0.311477120883, 1.32450146627}},
    {"100", "rec709", {0.98, 0.9, 0.5}, {6.33879553293, 6.12989876648, 1.20168333459}},
    {"1000", "rec2020", {1, 1, 1}, {0.939755894599, 0.939755894599, 0.939755894599}},
    {"1000", "rec2020", {10, 10, 10}, {512, 512, 512}},
    {"1000", "rec2020", {5, 3, 1}, {4.74592356133, 2.89444146959, 0.502463393507}},
    {"1000", "rec2020", {9, 1, 0.5}, {7.50421908101, 0.98260023501, 0.255613535223}},
    {"1000", "rec2020", {0.5, 6, 3}, {1.86835225406, 6.53334791499, 3.49846059745}},
    {"1000", "rec2020", {2, 1, 8}, {3.00616969049, 1.61617891921, 9.36933073827}},
    {"1000", "rec2020", {9.8, 9, 5}, {43.4083304502, 36.3808512105, 2.69991493345}},
    {"1000", "p3d65", {1, 1, 1}, {0.939755894599, 0.939755894599, 0.939755894599}},
    {"1000", "p3d65", {10, 10, 10}, {512, 512, 512}},
    {"1000", "p3d65", {5, 3, 1}, {4.15786002396, 2.9659136444, 0.536705202558}},
    {"1000", "p3d65", {9, 1, 0.5}, {5.9610813262, 1.14468503793, 0.176056312397}},
    {"1000", "p3d65", {0.5, 6, 3}, {2.40010197333, 6.9396305097, 3.36513577236}},
    {"1000", "p3d65", {2, 1, 8}, {3.1031772733, 1.70963724341, 9.52953481997}},
    {"1000", "p3d65", {9.8, 9, 5}, {38.0791866058, 34.9158978785, 2.91444857863}},
};

TEST(InverseView, Aces20IsThatOfTheReferenceCollection) {
    for (const InverseRow& row : kAces20) {
        const View view =
            make_view(resolve_operator("aces_20", {{"peak", row.peak}, {"limit", row.limit}}),
                      "lin_ap0", 0, kNativeOutput);
        const Vector3 scene = ReferenceEngine(build_inverse_view(view))(row.shown);
        for (std::size_t c = 0; c < 3; ++c) {
            // Two computations in double, whose tables and solver steps differ in the last digits.
            EXPECT_NEAR(scene[c], row.scene[c], 2e-6 * std::max(std::fabs(row.scene[c]), 1e-2))
                << row.peak << " " << row.limit << " " << row.shown[0] << " " << row.shown[1] << " "
                << row.shown[2] << ", channel " << c;
        }
    }
}

// pbrNeutral.glsl by hand: less 0.04 below the start; n = 1 - 0.24^2/(p + 0.24 - 0.76) and
// g = 1 - 1/(0.15 (p - n) + 1) above; x - 6.25 x^2 of a smallest channel below 0.08.
const std::array<std::array<Vector3, 2>, 5> kNeutral = {{
    {{{0.46, 0.16, 0.06}, {0.5, 0.2, 0.1}}},
    {{{0.19, 0.04, 0.01}, {0.22, 0.07, 0.04}}},
    {{{0.869090909091, 0.869090909091, 0.869090909091}, {1, 1, 1}}},
    {{{0, 0, 0}, {0, 0, 0}}},
    // p = 2.96, n = 0.976393443, 1 - g = 0.770680, chroma 0.254218
    {{{0.976393442623, 0.264573640, 0.442528608}, {3, 0.2, 0.9}}},
}};

TEST(InverseView, OfKhronosNeutralIsTheSceneThatItShows) {
    const View view =
        make_view(resolve_operator("khronos_neutral"), "lin_rec709", 0, kNativeOutput);
    for (const auto& [shown, scene] : kNeutral) {
        const Vector3 back = ReferenceEngine(build_inverse_view(view))(shown);
        // Nine decimals are given; next to white an error grows by (1 - n)^-2 0.24^2 = 103.
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(back[c], scene[c], 2e-7) << shown[0] << " " << shown[1] << " " << shown[2];
    }
    // White is as bright as a half float can be, not infinite.
    const Vector3 white = ReferenceEngine(build_inverse_view(view))({1, 1, 1});
    EXPECT_NEAR(white[0], 65504, 1);
}

TEST(InverseView, RoundTripsOnEveryDisplay) {
    const Vector3 scene = {0.3, 0.2, 0.05};
    for (const Display& display : all_displays()) {
        for (const double white : {100.0, 203.0}) {
            if (white != 100 && !display.is_hdr) continue;
            const View view =
                make_view(resolve_operator("aces_20"), "lin_rec709", 1, display.id, white);
            const Vector3 back =
                ReferenceEngine(build_inverse_view(view))(ReferenceEngine(build_view(view))(scene));
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(back[c], scene[c], 1e-5 * scene[c]) << display.id << " " << white;
        }
    }
}

TEST(InverseView, OfAnOperatorWithoutOneIsAnErrorThatNamesTheStage) {
    const View view = make_view(resolve_operator("reinhard_jodie"), "lin_rec709", 0, "srgb");
    try {
        (void)build_inverse_view(view);
        FAIL() << "no error";
    } catch (const Error& e) {
        EXPECT_STREQ(
            e.what(),
            "reinhard_jodie has no inverse: stage 2 is a cross-talk, which mixes channels");
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
