// SPDX-License-Identifier: Apache-2.0
//
// The 3D LUT that holds ACES 2.0's channel-mixing stage, through OpenColorIO, on colors that it was
// not fitted to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "full_counts.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "ocio/lower.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// 99.9 % of the errors of a pixel's worst channel, in code values.
double p999_of(const std::string& display, const std::string& input) {
    const View view = make_view(resolve_operator("aces_20"), input, 0, display);
    const Pipeline pipeline = build_view(view);
    // The fit draws its colors from other seeds, and no grid.
    const SampleSet samples = make_sample_set(
        find_input_space(input),
        {.gamut_grid_size = count_of(33, 17), .random_count = count_of(100000U, 20000U)});
    std::vector<float> light;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!samples.is_non_negative(i)) continue;
        light.insert(light.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    std::vector<double> wanted(light.size());
    ReferenceEngine(pipeline).run_rgb(light.data(), wanted.data(), light.size() / 3);
    std::vector<float> shown(light.size());
    OcioCpu(make_processor(lower_to_ocio(pipeline, lower_options(*view.op.op)).ops),
            OCIO::OPTIMIZATION_LOSSLESS)
        .run_rgb(light.data(), shown.data(), light.size() / 3);
    std::vector<double> errors;
    for (std::size_t i = 0; i < light.size(); i += 3) {
        double worst = 0;
        for (std::size_t c = i; c < i + 3; ++c) {
            const double code = std::clamp(static_cast<double>(shown[c]), 0.0, 1.0);
            worst = std::max(worst, std::fabs(code - std::clamp(wanted[c], 0.0, 1.0)));
        }
        errors.push_back(worst);
    }
    return summarise(errors).p999;
}

// 4e-3, one code of 8 bits, is what the config's users were promised.
TEST(Aces20, OpenColorIOShowsColorsThatTheLutWasNotFittedTo) {
    std::vector<std::string> displays = {"srgb"};
    if (takes_full_counts()) {
        for (const char* other :
             {"display_p3", "rec1886", "rec2020", "g22", "rec2100_pq", "rec2100_hlg", "p3d65_pq"})
            displays.emplace_back(other);
    }
    for (const std::string& display : displays) {
        const double p999 = p999_of(display, "lin_rec709");
        std::printf("%s: %.2e\n", display.c_str(), p999);
        EXPECT_LE(p999, 4e-3) << display;
    }
}

TEST(Aces20, OpenColorIOShowsSaturatedColorsOfAp1) {
    if (!takes_full_counts()) GTEST_SKIP() << "a minute; with TONEWRIGHT_TEST_ALL=1";
    for (const char* display : {"srgb", "display_p3", "rec1886", "rec2020", "g22"}) {
        const double p999 = p999_of(display, "lin_ap1");
        std::printf("%s: %.2e\n", display, p999);
        EXPECT_LE(p999, 4e-3) << display;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
