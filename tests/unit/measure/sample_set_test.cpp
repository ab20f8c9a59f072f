// SPDX-License-Identifier: Apache-2.0
#include "measure/sample_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/random.h"
#include "engine/tape.h"
#include "full_counts.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::size_t count_of(const SampleSet& set, SampleKind kind) {
    return static_cast<std::size_t>(std::count(set.kind.begin(), set.kind.end(), kind));
}

/// Bit patterns, so that NaN equals NaN.
std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
    std::vector<std::uint32_t> bits;
    for (const float x : values)
        bits.push_back(std::bit_cast<std::uint32_t>(x));
    return bits;
}

TEST(Probes, AreTheSameOnEveryCall) {
    const InputSpace& input = find_input_space("lin_ap1");
    const SampleSet a = make_sample_set(input, {5, 3000});
    const SampleSet b = make_sample_set(input, {5, 3000});
    EXPECT_EQ(bits_of(a.rgb), bits_of(b.rgb));
    EXPECT_EQ(a.kind, b.kind);
}

TEST(Probes, CountsAreAsAsked) {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {7, 2000});
    EXPECT_EQ(set.rgb.size(), 3 * set.size());
    EXPECT_EQ(count_of(set, SampleKind::grid), 3U * 5 * 7 * 7 * 7) << "3 gamuts, 5 exposures";
    EXPECT_EQ(count_of(set, SampleKind::random), 2000U);
    EXPECT_EQ(count_of(set, SampleKind::picture), 0U);
    for (const SampleKind kind :
         {SampleKind::gray, SampleKind::near_black, SampleKind::negative, SampleKind::special}) {
        EXPECT_GT(count_of(set, kind), 20U) << static_cast<int>(kind);
    }
    const SampleSet standard = make_sample_set(find_input_space("lin_rec709"));
    EXPECT_EQ(count_of(standard, SampleKind::grid), 3U * 5 * 33 * 33 * 33);
    EXPECT_EQ(count_of(standard, SampleKind::random), 100000U);
}

TEST(Probes, KindsAreWhatTheyAreCalled) {
    const SampleSet set = make_sample_set(find_input_space("lin_rec2020"), {9, 20000});
    double gray_lo = 1;
    double gray_hi = 0;
    double random_lo = 1;
    double random_hi = 0;
    double smallest = 1;
    std::size_t with_zero = 0;
    bool has_black = false;
    bool has_mixed_thousands = false;
    std::array<std::size_t, 4> negatives{};
    bool has_nan = false;
    bool has_infinity = false;
    bool has_largest = false;
    for (std::size_t i = 0; i < set.size(); ++i) {
        const float* rgb = &set.rgb[3 * i];
        const auto [lo, hi] = std::minmax({rgb[0], rgb[1], rgb[2]});
        const auto below = std::count_if(rgb, rgb + 3, [](float x) { return x < 0; });
        switch (set.kind[i]) {
            case SampleKind::gray:
                ASSERT_EQ(lo, hi);
                has_black = has_black || hi == 0;
                if (hi > 0) gray_lo = std::min(gray_lo, static_cast<double>(lo));
                gray_hi = std::max(gray_hi, static_cast<double>(hi));
                break;
            case SampleKind::random:
                ASSERT_TRUE(set.is_non_negative(i));
                with_zero += lo == 0 ? 1 : 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    if (rgb[c] > 0) random_lo = std::min(random_lo, static_cast<double>(rgb[c]));
                }
                random_hi = std::max(random_hi, static_cast<double>(hi));
                break;
            case SampleKind::near_black:
                ASSERT_TRUE(set.is_non_negative(i));
                ASSERT_LE(hi, 0x1p-10F);
                if (hi > 0) smallest = std::min(smallest, static_cast<double>(lo));
                break;
            case SampleKind::negative:
                ASSERT_FALSE(set.is_non_negative(i));
                ++negatives[static_cast<std::size_t>(below)];
                has_mixed_thousands = has_mixed_thousands || (lo < -1000 && hi > 1000);
                break;
            case SampleKind::special:
                for (std::size_t c = 0; c < 3; ++c) {
                    has_nan = has_nan || std::isnan(rgb[c]);
                    has_infinity = has_infinity || std::isinf(rgb[c]);
                    has_largest = has_largest || rgb[c] == std::numeric_limits<float>::max();
                }
                break;
            default:
                break;
        }
    }
    // Float rounding of 0.18 * 2^+-12.
    EXPECT_NEAR(gray_lo / (0.18 / 4096), 1, 1e-7);
    EXPECT_NEAR(gray_hi / (0.18 * 4096), 1, 1e-7);
    EXPECT_TRUE(has_black);
    // 60000 draws over 28 stops: the extreme ones are within 0.01 stops of the ends, all but
    // surely.
    EXPECT_NEAR(std::log2(random_lo), -16, 0.01);
    EXPECT_NEAR(std::log2(random_hi), 12, 0.01);
    EXPECT_EQ(with_zero, 2000U) << "a tenth";
    EXPECT_LT(smallest, 1.2e-38) << "down to denormals";
    EXPECT_EQ(negatives[0], 0U);
    EXPECT_GT(negatives[1], 1000U);
    EXPECT_GT(negatives[2], 1000U);
    EXPECT_EQ(negatives[3], 0U) << "one or two channels";
    EXPECT_TRUE(has_mixed_thousands);
    EXPECT_TRUE(has_nan && has_infinity && has_largest);
}

TEST(Probes, GridsReachTheCornersOfTheirGamuts) {
    // In Rec.2020 the red corner of Rec.2020 is (g, 0, 0) at each of five exposures, and that of
    // Rec.709 is g times BT.2087's first column.
    const SampleSet set = make_sample_set(find_input_space("lin_rec2020"), {3, 10});
    for (const double gain : {1.0 / 64, 0.25, 1.0, 8.0, 64.0}) {
        for (const Vector3& corner : {Vector3{1, 0, 0}, {0.6274, 0.0691, 0.0164}}) {
            bool found = false;
            for (std::size_t i = 0; i < set.size(); ++i) {
                if (set.kind[i] != SampleKind::grid) continue;
                double away = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    away = std::max(away, std::fabs(static_cast<double>(set.rgb[3 * i + c]) -
                                                    gain * corner[c]));
                }
                found = found || away < 6e-5 * gain;  // BT.2087 prints four decimals
            }
            EXPECT_TRUE(found) << gain << " x " << corner[0];
        }
    }
}

TEST(Probes, NonNegativeMeansFiniteToo) {
    SampleSet set;
    for (const double x : {0.0, -0.0, 1.0, -1e-30, kNan, kInfinity}) {
        set.add(x, 1, 1, SampleKind::picture);
        set.add(1, x, 1, SampleKind::picture);
        set.add(1, 1, x, SampleKind::picture);
    }
    ASSERT_EQ(set.size(), 18U);
    for (std::size_t i = 0; i < 18; ++i)
        EXPECT_EQ(set.is_non_negative(i), i < 9) << i;
}

TEST(Probes, RandomIsSplitMix64) {
    // The published outputs for seed 1234567 (Vigna's splitmix64.c; Rosetta Code).
    SampleRandom random(1234567);
    for (const unsigned long long expected :
         {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
          4593380528125082431ULL, 16408922859458223821ULL}) {
        EXPECT_EQ(random.bits(), expected);
    }
    double mean = 0;
    for (int i = 0; i < 10000; ++i) {
        const double x = random.uniform(-2, 6);
        ASSERT_GE(x, -2);
        ASSERT_LT(x, 6);
        mean += x / 10000;
    }
    EXPECT_NEAR(mean, 2, 0.1) << "four standard errors of 8/sqrt(12 * 10000) each";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
