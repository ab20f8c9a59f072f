// SPDX-License-Identifier: Apache-2.0
#include "measure/error_metric.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Summary, OfKnownErrors) {
    // 0..1000 in a mixed order (10 and 1001 have no common factor): 99.9 % are at most 999.
    std::vector<double> errors;
    for (int i = 0; i < 1001; ++i)
        errors.push_back(i * 10 % 1001);
    const ErrorStats s = summarise(errors);
    EXPECT_EQ(s.count, 1001U);
    EXPECT_EQ(s.max, 1000);
    EXPECT_EQ(s.p999, 999);
    EXPECT_EQ(s.mean, 500);
    EXPECT_EQ(errors[s.worst], 1000);
}

TEST(Summary, OfFewErrors) {
    const ErrorStats none = summarise({});
    EXPECT_EQ(none.count, 0U);
    EXPECT_EQ(none.max, 0);
    EXPECT_EQ(none.mean, 0);
    const std::vector<double> one = {0.25};
    EXPECT_EQ(summarise(one).p999, 0.25);
    EXPECT_EQ(summarise(one).mean, 0.25);
    // One outlier in 2000 is beyond the 99.9 % figure, three are not.
    std::vector<double> errors(2000, 1.0);
    errors[70] = 9;
    EXPECT_EQ(summarise(errors).p999, 1);
    EXPECT_EQ(summarise(errors).worst, 70U);
    errors[71] = errors[72] = 9;
    EXPECT_EQ(summarise(errors).p999, 9);
}

TEST(Summary, NotANumberIsInfinitelyWrong) {
    const std::vector<double> errors = {1, kNan, 2};
    const ErrorStats s = summarise(errors);
    EXPECT_EQ(s.max, kInfinity);
    EXPECT_EQ(s.worst, 1U);
}

TEST(Summary, ChannelErrorTakesTheWorst) {
    const Vector3 truth = {0.5, 0.25, 1};
    const std::array<float, 3> candidate = {0.5F, 0.75F, 0.75F};
    EXPECT_EQ(channel_error(truth.data(), candidate.data()), 0.5);
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<float, 3> broken = {0.5F, 0.25F, 1};
        broken[c] = std::numeric_limits<float>::quiet_NaN();
        const std::array<double, 1> error = {channel_error(truth.data(), broken.data())};
        EXPECT_EQ(summarise(error).max, kInfinity) << "NaN in channel " << c;
        broken[c] = std::numeric_limits<float>::infinity();
        EXPECT_EQ(channel_error(truth.data(), broken.data()), kInfinity);
    }
}

/// ICtCp -> display light of BT.2020 primaries in cd/m2, in plain double: the inverse of what is
/// under test (ITU-R BT.2100-2, table 7; SMPTE ST 2084).
Vector3 rec2020_nits_of(const Vector3& ictcp) {
    const Matrix3 to_lms = {{{1688, 2146, 262}, {683, 2951, 462}, {99, 309, 3688}}};
    const Matrix3 to_ictcp = {{{2048, 2048, 0}, {6610, -13613, 7003}, {17933, -17390, -543}}};
    Vector3 lms = multiply(inverse(scale(to_ictcp, 1.0 / 4096)), ictcp);
    for (double& v : lms) {
        const double m1 = 2610.0 / 16384;
        const double m2 = 2523.0 / 4096 * 128;
        const double c1 = 3424.0 / 4096;
        const double c2 = 2413.0 / 4096 * 32;
        const double c3 = 2392.0 / 4096 * 32;
        const double p = std::pow(v, 1 / m2);
        v = 10000 * std::pow(std::max(p - c1, 0.0) / (c2 - c3 * p), 1 / m1);
    }
    return multiply(inverse(scale(to_lms, 1.0 / 4096)), lms);
}

TEST(DeltaEItp, AgreesWithPublishedPairs) {
    // Pairs of ICtCp triplets and their difference by ITU-R BT.2124 as the tests of the
    // colour-science package have them (made with another program): dark skin, and 100 % white.
    struct Pair {
        Vector3 a;
        Vector3 b;
        double difference;
    };
    const std::vector<Pair> pairs = {{{0.4885468072, -0.04739350675, 0.07475401302},
                                      {0.4899203231, -0.04567508203, 0.07361341775},
                                      1.426572247},
                                     {{0.7538438727, 0, -6.25e-16},
                                      {0.7538912244, 0.001930922514, -0.0003599955951},
                                      0.7426668055}};
    const Display& display = find_display("rec2020");
    constexpr double kPeak = 10000;
    std::vector<double> a;
    std::vector<double> b;
    for (const Pair& pair : pairs) {
        const Vector3 nits_a = rec2020_nits_of(pair.a);
        const Vector3 nits_b = rec2020_nits_of(pair.b);
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GT(nits_a[c], 0);
            ASSERT_GT(nits_b[c], 0);
            a.push_back(std::pow(nits_a[c] / kPeak, 1 / 2.4));  // BT.1886
            b.push_back(std::pow(nits_b[c] / kPeak, 1 / 2.4));
        }
    }
    const std::vector<double> differences = delta_e_itp(display, a, b, kPeak);
    ASSERT_EQ(differences.size(), pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        // Ten printed digits of coordinates of 0.5, times 720.
        EXPECT_NEAR(differences[i], pairs[i].difference, 720 * 1e-9);
    }
}

TEST(DeltaEItp, OfGraysIsTheDifferenceOfPq) {
    // R = G = B gives L = M = S = Y, so I = PQ(Y) and T = P = 0. SMPTE ST 2084: PQ(100 cd/m2) is
    // 0.508078421517 and PQ(1 cd/m2) 0.149945732100; 1 % of sRGB's light is code 0.099852...
    const double code = 1.055 * std::pow(0.01, 1 / 2.4) - 0.055;
    const std::vector<double> white = {1, 1, 1};
    const std::vector<double> gray = {code, code, code};
    const double expected = 720 * (0.508078421517 - 0.149945732100);
    for (const char* display : {"srgb", "display_p3"}) {
        const auto d = delta_e_itp(find_display(display), white, gray, 100);
        ASSERT_EQ(d.size(), 1U);
        EXPECT_NEAR(d[0], expected, 1e-8) << display << ": twelve digits, times 720";
        EXPECT_EQ(delta_e_itp(find_display(display), gray, white, 100), d) << "symmetric";
        EXPECT_EQ(delta_e_itp(find_display(display), white, white, 100)[0], 0);
    }
    // Ten times the light: PQ(1000) and PQ(10).
    EXPECT_NEAR(delta_e_itp(find_display("srgb"), white, gray, 1000)[0],
                720 * (0.751827096247 - 0.299699092421), 1e-8);
}

TEST(DeltaEItp, IsOfLightNotOfCodes) {
    // The same light on an sRGB and on a BT.2020 display, by ITU-R BT.2087's matrix and the two
    // curves, is the same color: differences to black agree.
    const Vector3 light = {0.5, 0.2, 0.05};
    const Vector3 wide = {0.6274 * 0.5 + 0.3293 * 0.2 + 0.0433 * 0.05,
                          0.0691 * 0.5 + 0.9195 * 0.2 + 0.0114 * 0.05,
                          0.0164 * 0.5 + 0.0880 * 0.2 + 0.8956 * 0.05};
    std::vector<double> srgb;
    std::vector<double> rec2020;
    for (std::size_t c = 0; c < 3; ++c) {
        srgb.push_back(1.055 * std::pow(light[c], 1 / 2.4) - 0.055);
        rec2020.push_back(std::pow(wide[c], 1 / 2.4));
    }
    const std::vector<double> black(3, 0.0);
    // Four printed decimals of light are 3e-4 of the darkest channel; PQ rises by about 0.1 a stop.
    EXPECT_NEAR(delta_e_itp(find_display("srgb"), srgb, black)[0],
                delta_e_itp(find_display("rec2020"), rec2020, black)[0], 720 * 0.1 * 2e-3);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
