// SPDX-License-Identifier: Apache-2.0
#include "plot/tone_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

View view_of(const std::string& op, const std::string& display = "srgb") {
    return make_view(resolve_operator(op), "lin_rec709", 0, display);
}

/// IEC 61966-2-1, above its straight line.
double srgb_of(double light) { return 1.055 * std::pow(light, 1 / 2.4) - 0.055; }

/// The place of mid gray.
std::size_t middle() {
    const std::vector<double>& stops = plot_stops();
    return static_cast<std::size_t>(std::find(stops.begin(), stops.end(), 0.0) - stops.begin());
}

TEST(ToneCurves, LinesAreCodesOrTheirLight) {
    ToneCurves request;
    request.curves = {{"reinhard", view_of("reinhard")}};
    request.clamp = view_of("clamp");
    const CurvePlot codes = plot_of(request);
    ASSERT_EQ(codes.lines.size(), 2U);
    EXPECT_EQ(codes.lines[0].id, "reinhard");
    EXPECT_FALSE(codes.lines[1].dashes.empty()) << "the clamp";
    const double light = 0.18 / 1.18;  // L/(1 + L)
    EXPECT_NEAR(codes.lines[0].values[middle()], srgb_of(light), 1e-12);
    EXPECT_NEAR(codes.lines[1].values[middle()], srgb_of(0.18), 1e-12);
    ASSERT_EQ(codes.marks.size(), 2U) << "mid gray and white";
    EXPECT_EQ(codes.marks[1].words, "1 \u2192 0.735") << "the sRGB code value of 0.5";

    request.quantity = PlotQuantity::light;
    EXPECT_NEAR(plot_of(request).lines[0].values[middle()], 100 * light, 1e-9) << "percent";
    request.quantity = PlotQuantity::log;
    EXPECT_NEAR(plot_of(request).lines[0].values[middle()], std::log10(100 * light), 1e-9);
}

TEST(ToneCurves, TitlesFitBesideTheirHeadings) {
    ToneCurves request;
    request.curves = {{"a", view_of("hable")}, {"b", view_of("agx_minimal")}};
    EXPECT_EQ(plot_of(request).title, "Tone curves");
    EXPECT_TRUE(plot_of(request).marks.empty()) << "of one operator alone";
    request.title = std::string(200, 'x');
    EXPECT_LT(plot_of(request).title.size(), 80U);
    EXPECT_TRUE(plot_of(request).title.ends_with("..."));
}

TEST(ToneCurves, TheClampIsThereOnce) {
    ToneCurves request;
    request.curves = {{"clamp", view_of("clamp")}};
    request.clamp = view_of("clamp");
    EXPECT_EQ(plot_of(request).lines.size(), 1U);
}

TEST(ToneCurves, LinearHasNoCodes) {
    ToneCurves request;
    request.curves = {{"hable", view_of("hable", "linear")}};
    EXPECT_THROW((void)plot_of(request), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
