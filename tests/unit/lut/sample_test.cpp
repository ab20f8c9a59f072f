// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "unit/errors.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(SampleLut, NodesAreValuesOfTheView) {
    // A Rec.709 view of `clamp` on a log2 encoding, by hand: light 0.18 * 2^(16.5 n - 10), limited
    // to 1, then IEC 61966-2-1.
    const Lut lut = sample_lut(request_for("clamp", "log2", LutFormat::spi3d, 17));
    ASSERT_EQ(lut.dimension, 3);
    ASSERT_EQ(lut.size, 17);
    ASSERT_EQ(lut.values.size(), 3U * 17 * 17 * 17);
    const auto code = [](std::size_t node) {
        const double light =
            std::min(1.0, 0.18 * std::exp2(16.5 * static_cast<double>(node) / 16 - 10));
        return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    };
    for (std::size_t b = 0; b < 17; ++b) {
        for (std::size_t g = 0; g < 17; ++g) {
            for (std::size_t r = 0; r < 17; ++r) {
                const float* v = &lut.values[3 * ((b * 17 + g) * 17 + r)];
                ASSERT_NEAR(static_cast<double>(v[0]), code(r), 0x1p-24) << "float rounding";
                ASSERT_NEAR(static_cast<double>(v[1]), code(g), 0x1p-24);
                ASSERT_NEAR(static_cast<double>(v[2]), code(b), 0x1p-24);
            }
        }
    }
}

TEST(SampleLut, DimensionFollowsTheView) {
    EXPECT_EQ(sample_lut(request_for("hable", "log2")).dimension, 1);
    EXPECT_EQ(sample_lut(request_for("hable", "log2")).size, 4096);
    EXPECT_EQ(sample_lut(request_for("agx_sobotka", "log2")).dimension, 3);
    EXPECT_EQ(sample_lut(request_for("agx_sobotka", "log2")).size, 33);
    EXPECT_EQ(sample_lut(request_for("hable", "acescct")).dimension, 3)
        << "AP1 to Rec.709 mixes channels";
    LutRequest three = request_for("hable", "log2");
    three.dimension = LutDimension::three;
    EXPECT_EQ(sample_lut(three).dimension, 3);
    const Lut half = sample_lut(request_for("hable", "linear", LutFormat::clf));
    EXPECT_TRUE(half.is_half_domain);
    EXPECT_EQ(half.values.size(), 65536U);
}

TEST(SampleLut, TakesSizesOf17To129) {
    for (const int size : {17, 18, 33, 65, 129}) {
        const Lut lut = sample_lut(request_for("agx_sobotka", "acescct", LutFormat::cube, size));
        EXPECT_EQ(lut.size, size);
        EXPECT_EQ(lut.values.size(), 3 * static_cast<std::size_t>(size) *
                                         static_cast<std::size_t>(size) *
                                         static_cast<std::size_t>(size));
    }
    for (const int size : {2, 4096, 65536})
        EXPECT_EQ(sample_lut(request_for("hable", "log2", LutFormat::spi1d, size)).size, size);
}

TEST(SampleLut, RefusesLutsThatApplicationsShowWrong) {
    const auto error = [](const LutRequest& r) { return error_of([&] { (void)sample_lut(r); }); };
    LutRequest r = request_for("agx_sobotka", "linear");
    EXPECT_EQ(error(r).rfind("input encoding is linear:0:1; expected another for a 3D "
                             "table",
                             0),
              0U)
        << error(r);
    r = request_for("agx_sobotka", "log2");
    r.dimension = LutDimension::one;
    EXPECT_EQ(error(r).rfind("agx_sobotka mixes channels", 0), 0U) << error(r);
    EXPECT_EQ(error(request_for("agx_sobotka", "log2", LutFormat::spi1d))
                  .rfind("agx_sobotka mixes channels", 0),
              0U);
    r = request_for("hable", "log2", LutFormat::spi1d);
    r.dimension = LutDimension::three;
    EXPECT_EQ(error(r),
              "format is spi1d; expected a 3D format (cube, clf, ctf, spi3d, csp, "
              "resolve_cube, 3dl, lut, icc, hald, strip, strip_up, raw) with dimension=3d");
    r = request_for("hable", "log2", LutFormat::spi3d);
    r.dimension = LutDimension::one;
    EXPECT_EQ(error(r),
              "format is spi3d; expected a 1D format (cube, clf, ctf, spi1d) with dimension=1d");
    for (const int size : {-1, 0, 16, 130}) {
        EXPECT_EQ(error(request_for("agx_sobotka", "log2", LutFormat::cube, size)),
                  "size is " + std::to_string(size) + "; expected [17, 129]");
    }
    for (const int size : {-1, 0, 1, 65537}) {
        EXPECT_EQ(error(request_for("hable", "log2", LutFormat::cube, size)),
                  "size is " + std::to_string(size) + "; expected [2, 65536]");
    }
    EXPECT_EQ(error(request_for("hable", "linear", LutFormat::clf, 4096)),
              "size is 4096; expected none, a half-domain clf has 65536 entries");
}

TEST(MeasureLut, IsNeverBelowTheErrorOfTheSamples) {
    for (const LutRequest& r : {request_for("agx_sobotka", "acescct", LutFormat::cube, 17),
                                request_for("hable", "log2", LutFormat::spi1d, 256),
                                request_for("hable", "linear", LutFormat::clf)}) {
        const Lut lut = sample_lut(r);
        const LutError measured = measure_lut(lut, r);
        const SampleSet samples = make_sample_set(find_input_space(r.view.input), {17, 2000});
        std::vector<double> truth(samples.rgb.size());
        ReferenceEngine(build_view(r.view))
            .run_rgb(samples.rgb.data(), truth.data(), samples.size());
        std::vector<double> code(samples.rgb.begin(), samples.rgb.end());
        if (!lut.is_half_domain) {
            ReferenceEngine({curve_stage(r.encoding.encode)})
                .run_rgb(samples.rgb.data(), code.data(), samples.size());
        }
        double worst = 0;
        int inside = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            // The grids and grays are the same whatever the number of random colors.
            if (samples.kind[i] != SampleKind::grid && samples.kind[i] != SampleKind::gray)
                continue;
            const float* v = &samples.rgb[3 * i];
            const bool is_inside =
                lut.is_half_domain || std::all_of(v, v + 3, [&](float x) {
                    const auto scene = static_cast<double>(x);
                    return scene >= r.encoding.scene_lo && scene <= r.encoding.scene_hi;
                });
            if (!is_inside) continue;
            ++inside;
            const Vector3 out = interpolate(lut, {code[3 * i], code[3 * i + 1], code[3 * i + 2]});
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::fabs(out[c] - truth[3 * i + c]));
        }
        EXPECT_GT(inside, 1000) << r.encoding.id;
        EXPECT_GE(measured.max, worst) << r.encoding.id;
        EXPECT_GE(measured.max, measured.p999);
        EXPECT_GE(measured.p999, measured.mean);
        EXPECT_GT(measured.delta_e_max, 0);
    }
}

TEST(MeasureLut, FindsAWrongTable) {
    const LutRequest r = request_for("hable", "log2", LutFormat::spi1d, 4096);
    Lut lut = sample_lut(r);
    const LutError clean = measure_lut(lut, r);
    for (float& y : lut.values)
        y += 0.01F;
    const LutError shifted = measure_lut(lut, r);
    EXPECT_NEAR(shifted.mean, 0.01, clean.max + 1e-8);
    EXPECT_NEAR(shifted.max, 0.01, clean.max + 1e-8);
    EXPECT_EQ(shifted.interpolation, "linear");
}

TEST(MeasureLut, FindsSwappedAxes) {
    const LutRequest r = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    const Lut lut = sample_lut(r);
    Lut swapped = lut;
    for (std::size_t b = 0; b < 17; ++b) {
        for (std::size_t g = 0; g < 17; ++g) {
            for (std::size_t red = 0; red < 17; ++red) {
                for (std::size_t c = 0; c < 3; ++c) {
                    swapped.values[3 * ((b * 17 + g) * 17 + red) + c] =
                        lut.values[3 * ((red * 17 + g) * 17 + b) + c];
                }
            }
        }
    }
    EXPECT_LT(measure_lut(lut, r).mean, 0.01);
    EXPECT_GT(measure_lut(swapped, r).mean, 0.1) << "blue fastest instead of red";
}

TEST(MeasureLut, NamesTheInterpolation) {
    const LutRequest r = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    const Lut lut = sample_lut(r);
    EXPECT_EQ(measure_lut(lut, r).interpolation, "tetrahedral");
    EXPECT_EQ(measure_lut(lut, r, LutInterpolation::trilinear).interpolation, "trilinear");
}

TEST(MeasureLut, LargerLutsAreBetter) {
    // Chords of a smooth function: a quarter of the error for twice the nodes. The operator's
    // clamps keep the worst color from it, the mean shows it.
    const LutRequest small = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    const LutRequest large = request_for("agx_sobotka", "acescct", LutFormat::cube, 65);
    EXPECT_LT(measure_lut(sample_lut(large), large).mean,
              measure_lut(sample_lut(small), small).mean / 4);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
