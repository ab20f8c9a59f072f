// SPDX-License-Identifier: Apache-2.0
//
// The requirement on shipped LUTs: 99.9 % of the errors within 0.02 on the pixels of the test chart
// and of real HDR pictures, and along rising exposure of a lamp no channel falls by more than 2/255
// where the operator's does not.
#include <gtest/gtest.h>

#include <OpenImageIO/imagebuf.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/random.h"
#include "full_counts.h"
#include "lut/ringing.h"
#include "lut/shipped_set.h"
#include "lut/table_input.h"
#include "measure/error_metric.h"
#include "measure/photographs.h"
#include "tonewright/chart.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

LutRequest request_of(const char* op, const char* encoding, const char* input, const char* display,
                      int size) {
    LutRequest request;
    request.encoding = parse_input_encoding(encoding);
    request.view = make_view(resolve_operator(op), input, 0, display);
    request.dimension = LutDimension::three;
    request.size = size;
    return request;
}

/// Scene-linear Rec.709 of every n-th pixel.
std::vector<float> pixels_of(const OIIO::ImageBuf& picture, std::size_t step) {
    const OIIO::ImageSpec& spec = picture.spec();
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<float> all(spec.image_pixels() * channels);
    picture.get_pixels(picture.roi(), OIIO::TypeDesc::FLOAT, all.data());
    std::vector<float> some;
    for (std::size_t i = 0; i < spec.image_pixels(); i += step) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float v = all[i * channels + std::min(c, channels - 1)];
            some.push_back(std::isfinite(v) ? v : 0.0F);
        }
    }
    return some;
}

/// Errors of a LUT on light of Rec.709, as a display of sRGB shows light; what its encoding does
/// not hold goes in clipped.
std::vector<double> errors_of(const ShippedLut& lut, std::vector<float> light) {
    const LutRequest& request = lut.request;
    const Matrix3 to_input = rgb_to_rgb(kRec709, find_input_space(request.view.input).primaries);
    for (std::size_t i = 0; i < light.size(); i += 3) {
        const Vector3 v = multiply(
            to_input, Vector3{static_cast<double>(light[i]), static_cast<double>(light[i + 1]),
                              static_cast<double>(light[i + 2])});
        for (std::size_t c = 0; c < 3; ++c) {
            light[i + c] = static_cast<float>(
                std::clamp(v[c], request.encoding.scene_lo, request.encoding.scene_hi));
        }
    }
    const std::vector<double> code = table_input(lut.lut, request, light);
    std::vector<double> wanted(light.size());
    ReferenceEngine(build_view(request.view))
        .run_rgb(light.data(), wanted.data(), light.size() / 3);
    const auto shown_as = [&](double v) {
        if (request.view.display != kLinearOutput) return v;
        v = std::clamp(v, 0.0, 1.0);  // IEC 61966-2-1
        return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    };
    std::vector<double> errors;
    for (std::size_t i = 0; i < light.size(); i += 3) {
        const Vector3 shown = interpolate(lut.lut, {code[i], code[i + 1], code[i + 2]},
                                          interpolation_of(lut.set->host));
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c)
            worst = std::max(worst, std::fabs(shown_as(shown[c]) - shown_as(wanted[i + c])));
        errors.push_back(worst);
    }
    return errors;
}

/// The real pictures, where there are any.
std::vector<float> photographs() {
    std::vector<float> light;
    const char* shared = std::getenv("TONEWRIGHT_SHARED");
    const std::filesystem::path folder = std::filesystem::path(shared ? shared : "") / "data/hdr";
    std::error_code error;
    if (!shared || !std::filesystem::is_directory(folder, error)) {
        std::printf("the chart alone: TONEWRIGHT_SHARED, the folder of data/hdr, is unset\n");
        return light;
    }
    for (const char* name : {"CandleGlass.exr", "Desk.exr", "StageEnvLatLong.exr", "StillLife.exr",
                             "Tree.exr", "composited.exr", "memorial.hdr"}) {
        OIIO::ImageBuf picture((folder / name).string());
        if (!picture.read(0, 0, true, OIIO::TypeDesc::FLOAT)) continue;
        const std::vector<float> some = pixels_of(picture, 29);
        light.insert(light.end(), some.begin(), some.end());
    }
    return light;
}

TEST(ShippedSet, FollowsItsOperators) {
    const std::vector<float> chart = pixels_of(make_chart(768, 432), 3);
    const std::vector<float> pictures = photographs();
    std::size_t measured = 0;
    for (ShippedLut& lut : plan_shipped_luts()) {
        // By default two that take a second each.
        if (!takes_full_counts() && lut.path != "photoshop/agx_blender_srgb_to_srgb.cube" &&
            lut.path != "unreal/hable_srgb_to_srgb.png")
            continue;
        ++measured;
        bake_shipped_lut(lut);
        const double chart_p999 = summarise(errors_of(lut, chart)).p999;
        const double picture_p999 = pictures.empty() ? 0 : summarise(errors_of(lut, pictures)).p999;
        std::printf("%-55s chart %.4f, pictures %.4f of 0.03; fall %.4f of %.4f\n",
                    lut.path.c_str(), chart_p999, picture_p999, lut.ringing.fall, kLargestFall);
        const bool is_approximate = lut.set->approximate.contains(lut.request.view.op.op->id);
        if (lut.lut.dimension == 3) {
            // README.md states the others' errors.
            EXPECT_EQ(follows_operator(lut.ringing), !is_approximate)
                << lut.path << ": " << to_string(lut.ringing) << ", 99.9 % " << lut.ringing.p999;
        }
        if (is_approximate) continue;
        // The bound of the rays, and half as much again: pictures have other shares of lamps.
        EXPECT_LE(chart_p999, 0.03) << lut.path;
        EXPECT_LE(picture_p999, 0.03) << lut.path;
    }
    EXPECT_GE(measured, 2U);
}

TEST(Ringing, ARec709CurveInACameraGamutRings) {
    const LutRequest request = request_of("hable", "davinci", "lin_davinci_wg", "rec1886", 33);
    const LutRinging ringing =
        measure_ringing(sample_lut(request), request, LutInterpolation::trilinear);
    // In saturated lamps, where Hable's own channels rise and stay: issue of the shipped set.
    EXPECT_TRUE(rings(ringing));
    EXPECT_GT(ringing.fall, 0.2);
    EXPECT_GT(ringing.p999, 0.3);
    const LutRequest own = request_of("hable", "log2", "lin_rec709", "srgb", 33);
    EXPECT_FALSE(rings(measure_ringing(sample_lut(own), own, LutInterpolation::trilinear)));
    EXPECT_LT(measure_ringing(sample_lut(own), own).p999, 0.02);
}

TEST(Ringing, IsTheDepthOfADent) {
    // A channel of one gray node lower by 0.3: the ray of grays comes down to it from the node
    // before it, which is lower than the dented one was.
    const LutRequest request = request_of("hable", "log2", "lin_rec709", "srgb", 33);
    Lut lut = sample_lut(request);
    const std::size_t n = 33;
    const std::size_t node = 20;
    const auto green = [&](std::size_t i) -> float& {
        return lut.values[3 * ((i * n + i) * n + i) + 1];
    };
    const double expected =
        static_cast<double>(green(node - 1)) - (static_cast<double>(green(node)) - 0.3);
    green(node) -= 0.3F;
    for (const auto interpolation : {LutInterpolation::tetrahedral, LutInterpolation::trilinear}) {
        const LutRinging ringing = measure_ringing(lut, request, interpolation);
        // Sixteen exposures a stop, of half a stop between two nodes: within an eighth of the
        // slope.
        EXPECT_NEAR(ringing.fall, expected, 0.3 / 8);
        EXPECT_EQ(ringing.channel, "green");
        EXPECT_NEAR(ringing.stops, -10 + 16.5 * 20 / 32, 1.0 / 16);
    }
}

TEST(Ringing, FittedRaysTakeADentOut) {
    const LutRequest request = request_of("hable", "log2", "lin_rec709", "srgb", 33);
    Lut lut = sample_lut(request);
    lut.values[3 * ((20 * 33 + 20) * 33 + 20) + 1] -= 0.3F;
    RayFit(lut, request, LutInterpolation::tetrahedral, RayNodes::all).fit(lut, {.has_band = true});
    const LutRinging ringing = measure_ringing(lut, request);
    EXPECT_FALSE(rings(ringing)) << to_string(ringing);
    EXPECT_LE(ringing.p999, 0.02);
}

TEST(Ringing, RepairsSparePhotographs) {
    const LutRequest request = request_of("agx_blender", "davinci", "lin_rec2020", "rec1886", 17);
    const Lut fitted = fit_lut(request, sample_lut(request), 0.8);
    ASSERT_TRUE(rings(measure_ringing(fitted, request)));
    const double before = measure_lut(fitted, request).photographs.mean;
    Lut spared = fitted;
    RayFit(fitted, request, LutInterpolation::tetrahedral, RayNodes::unused).fit(spared, {});
    EXPECT_FALSE(rings(measure_ringing(spared, request)));
    Lut bent = fitted;
    RayFit(fitted, request, LutInterpolation::tetrahedral, RayNodes::all)
        .fit(bent, {.has_band = true});
    const double cost = measure_lut(spared, request).photographs.mean - before;
    const double cost_of_others = measure_lut(bent, request).photographs.mean - before;
    EXPECT_LT(cost, cost_of_others / 2);
    // Grays stay.
    for (std::size_t i = 0; i < 17; ++i) {
        const std::size_t gray = 3 * (i * (1 + 17 + 17 * 17));
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(spared.values[gray + c], fitted.values[gray + c]) << i;
    }
}

TEST(Ringing, AFitWithinBoundsIsNearerThanARepairAfterIt) {
    const LutRequest request = request_of("agx_blender", "davinci", "lin_rec2020", "rec1886", 17);
    const Lut sampled = sample_lut(request);
    const RayFit rays(sampled, request, LutInterpolation::tetrahedral, RayNodes::unused);
    int calls = 0;
    const Lut bound = fit_lut(request, sampled, 0.8, [&](Lut& lut) {
        ++calls;
        rays.fit(lut, {});
    });
    EXPECT_EQ(calls, 3);
    EXPECT_FALSE(rings(measure_ringing(bound, request)));
    Lut repaired = fit_lut(request, sampled, 0.8);
    rays.fit(repaired, {});
    EXPECT_LT(measure_lut(bound, request).photographs.p999,
              measure_lut(repaired, request).photographs.p999);
}

TEST(Photographs, ColorsOutsideTheInputAreLeftOut) {
    // Rec.709 with nothing above white holds less than Rec.2020 with a logarithm.
    const LutRequest narrow = request_of("agx_blender", "srgb", "lin_rec709", "srgb", 17);
    const LutRequest wide = request_of("agx_blender", "davinci", "lin_rec2020", "rec1886", 17);
    const double narrow_outside = measure_lut(sample_lut(narrow), narrow).photographs.outside;
    const double wide_outside = measure_lut(sample_lut(wide), wide).photographs.outside;
    double expected = 0;  // channels below 0 or above 1, in Rec.709
    const PhotographColors& colors = photograph_colors();
    for (std::size_t i = 0; i < colors.share.size(); ++i) {
        const float* rgb = &colors.rgb[3 * i];
        const auto [least, most] = std::minmax({rgb[0], rgb[1], rgb[2]});
        if (least < -1e-6F || most > 1) expected += colors.share[i];
    }
    EXPECT_NEAR(narrow_outside, expected, 1e-9);
    EXPECT_LT(wide_outside, narrow_outside / 4);
}

TEST(Photographs, TheirSharesAddUpToOne) {
    const PhotographColors& colors = photograph_colors();
    ASSERT_EQ(colors.rgb.size(), 3 * colors.share.size());
    double sum = 0;
    double median_side = 0;  // the share of pixels below mid gray
    double outside = 0;      // of Rec.709
    for (std::size_t i = 0; i < colors.share.size(); ++i) {
        const float* rgb = &colors.rgb[3 * i];
        sum += colors.share[i];
        const float largest = std::max({rgb[0], rgb[1], rgb[2]});
        EXPECT_GT(largest, 0);
        if (largest < 0.18F) median_side += colors.share[i];
        if (std::min({rgb[0], rgb[1], rgb[2]}) < 0) outside += colors.share[i];
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    // Scenes are exposed for mid gray, and few pixels are outside Rec.709.
    EXPECT_GT(median_side, 0.3);
    EXPECT_LT(median_side, 0.7);
    EXPECT_LT(outside, 0.02);
}

TEST(Photographs, AConstantErrorIsStated) {
    // Two codes more at every node.
    const LutRequest request = request_of("clamp", "log2", "lin_rec709", "srgb", 33);
    Lut lut = sample_lut(request);
    const PhotographError before = measure_lut(lut, request).photographs;
    for (float& v : lut.values)
        v += 2.0F / 255;
    const PhotographError error = measure_lut(lut, request).photographs;
    EXPECT_NEAR(error.p999, 2.0 / 255 + before.p999, before.p999 + 1e-6);
    EXPECT_NEAR(error.mean, 2.0 / 255, before.mean + 1e-6);
    EXPECT_GT(error.share, 0.95);
    // log2 ends at 2^6.5 times 0.18, 16.3.
    EXPECT_GT(error.outside, 0.001);
    EXPECT_LT(error.outside, 0.02);
    EXPECT_EQ(error.outside, before.outside);
}

TEST(Photographs, ErrorsAreStatedInCodes) {
    EXPECT_EQ(to_string(PhotographError{}),
              "99.9 % within 0 codes of 255, mean 0, no pixel more than one off");
    PhotographError error;
    error.p999 = 5.951 / 255;
    error.mean = 0.4301 / 255;
    error.share = 0.1074;
    error.outside = 0.00002;
    error.worst = "+0.7 stops, saturated red";
    EXPECT_EQ(
        to_string(error),
        "99.9 % within 6 codes of 255, mean 0.44, 11 % of the pixels more than one off, most at "
        "+0.7 stops, saturated red; less than 0.01 % are brighter or more saturated than the input "
        "holds");
}

TEST(Photographs, SmallErrorsHaveTwoDigits) {
    PhotographError error;
    error.p999 = 3.51e-05 / 255;
    error.mean = 2.81e-06 / 255;
    EXPECT_EQ(to_string(error),
              "99.9 % within 3.6e-05 codes of 255, mean 2.9e-06, no pixel more than one off");
    error.p999 = 138.4 / 255;
    error.mean = 0.0991 / 255;
    EXPECT_EQ(to_string(error),
              "99.9 % within 140 codes of 255, mean 0.1, no pixel more than one off");
}

TEST(Photographs, ErrorsHaveNoMoreThanAllCodes) {
    PhotographError error;
    error.p999 = 1;
    error.mean = 0.999;
    EXPECT_EQ(to_string(error),
              "99.9 % within 255 codes of 255, mean 255, no pixel more than one off");
    error.p999 = 12.5;
    error.mean = 0.0991 / 255;
    EXPECT_EQ(to_string(error),
              "0.1 % more than 255 codes of 255 off, mean 0.1, no pixel more than one off");
    error.mean = 1.5;
    EXPECT_EQ(to_string(error),
              "0.1 % more than 255 codes of 255 off, mean more than 255, no pixel more than one "
              "off");
}

TEST(Photographs, ColorsHaveNames) {
    EXPECT_EQ(description_of({0.18, 0.18, 0.18}), "+0.0 stops, gray");
    EXPECT_EQ(description_of({0.72, 0.01, 0.01}), "+2.0 stops, saturated red");
    EXPECT_EQ(description_of({0.09, 0.09, 0.05}), "-1.0 stops, yellow");
    EXPECT_EQ(description_of({0.05, 0.2, 0.36}), "+1.0 stops, saturated blue");
    EXPECT_EQ(description_of({0.36, 0.2, 0.36}), "+1.0 stops, magenta");
    EXPECT_EQ(description_of({0, 0, 0}), "black");
}

TEST(BakeLut, TheDefaultIsNearerOnPhotographsAndDoesNotRing) {
    for (const char* op : {"agx_blender", "aces_13"}) {
        if (op == std::string_view("aces_13") && !takes_full_counts()) continue;  // 8 seconds
        const LutRequest request = request_of(op, "davinci", "lin_rec2020", "rec1886", 17);
        const BakedLut baked = bake_lut(request);
        const PhotographError& own = baked.error.photographs;
        EXPECT_FALSE(rings(baked.ringing)) << op;
        const BakedLut smooth = bake_lut(request, LutNodes::smooth);
        const BakedLut sampled = bake_lut(request, LutNodes::sampled);
        EXPECT_LT(own.mean, smooth.error.photographs.mean) << op;
        EXPECT_LT(own.mean, sampled.error.photographs.mean) << op;
        EXPECT_LT(own.share, smooth.error.photographs.share) << op;
    }
}

TEST(BakeLut, TheGridOfAgxIsExact) {
    LutRequest request = request_of("agx_blender", "agx_log", "lin_egamut", "rec1886", 0);
    request.size.reset();
    EXPECT_EQ(sample_lut(request).size, 57);
    const BakedLut baked = bake_lut(request, LutNodes::sampled);
    // The rounding of 32-bit nodes and of the matrix to E-Gamut and back.
    EXPECT_LT(baked.error.max, 1e-6);
    EXPECT_LT(baked.error.photographs.p999, 1e-6);
    request.format = LutFormat::threedl;  // 17, 33 or 65
    EXPECT_EQ(sample_lut(request).size, 33);
}

TEST(Ringing, ATableOfOneDimensionHasNone) {
    LutRequest request = request_of("hable", "log2", "lin_rec709", "srgb", 33);
    request.dimension = LutDimension::one;
    EXPECT_EQ(measure_ringing(sample_lut(request), request).fall, 0);
}

TEST(MeasureLut, ItsMaximumHoldsForOtherColors) {
    // The request of a 3D LUT that stated 1.33e-2 and had 1.58e-2.
    const LutRequest request =
        request_of("agx_blender", "unity_logc", "lin_rec709", "linear", count_of(32, 17));
    const Lut lut = sample_lut(request);
    for (const auto interpolation : {LutInterpolation::tetrahedral, LutInterpolation::trilinear}) {
        const double stated = measure_lut(lut, request, interpolation).max;
        SampleRandom random(987);
        std::vector<double> code;
        for (std::size_t i = 0; i < 3 * count_of<std::size_t>(1000000, 100000); ++i)
            code.push_back(random.uniform(0, 1));
        const std::vector<float> light = light_of(request.encoding, code);
        const std::vector<double> input = table_input(lut, request, light);
        std::vector<double> wanted(light.size());
        ReferenceEngine(build_view(request.view))
            .run_rgb(light.data(), wanted.data(), light.size() / 3);
        double found = 0;
        for (std::size_t i = 0; i < light.size(); i += 3) {
            const Vector3 shown =
                interpolate(lut, {input[i], input[i + 1], input[i + 2]}, interpolation);
            for (std::size_t c = 0; c < 3; ++c)
                found = std::max(found, std::fabs(shown[c] - wanted[i + c]));
        }
        EXPECT_LE(found, stated);
        EXPECT_GT(found, stated / 2);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
