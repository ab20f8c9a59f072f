// SPDX-License-Identifier: Apache-2.0
//
// Metering sums in the same order on every instruction set: all of them give the bits of the best
// one, which meter_test.cpp holds to plain loops.
#include "image/metering_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Colors of 24 octaves, some negative, and alpha of all kinds.
/// @param is_plain  finite numbers, and alpha 1
std::vector<float> pixels_of(int channels, std::size_t count, bool is_plain) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInf = std::numeric_limits<float>::infinity();
    SampleRandom random(count);
    std::vector<float> pixels;
    for (std::size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c) {
            auto x = static_cast<float>(std::exp2(random.uniform(-12, 12)));
            if (random.bits() % 8 == 0) x = random.bits() % 2 ? -x : 0.0F;
            if (!is_plain && random.bits() % 64 == 0) x = random.bits() % 2 ? kNan : -kInf;
            pixels.push_back(x);
        }
        if (channels == 3) continue;
        const float alphas[] = {0.0F, 0.5F, 1.0F, kNan, kInf, 1.0F, 1.0F, 1.0F};
        pixels.push_back(is_plain ? 1.0F : alphas[random.bits() % 8]);
    }
    return pixels;
}

/// Everything that the kernels say about a span, as bytes.
std::string bytes_of(const light::Kernels& kernels, int channels, std::size_t count,
                     bool is_plain) {
    std::string bytes;
    const auto add = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const auto add_sums = [&](const light::SpanLight& light) {
        for (const light::CompensatedSum& sum : light.rgb) {
            add(sum.sum);
            add(sum.lost);
        }
        add(light.maximum_rgb);
        add(light.maximum);
        add(light.minimum_lit);
        add(light.lit_count);
        for (const light::Product& product : {light.lit, light.with_delta}) {
            add(product.mantissa);
            add(product.exponent);
        }
    };
    const std::vector<float> pixels = pixels_of(channels, count, is_plain);
    const bool has_alpha = channels == 4;
    add(light::are_plain(pixels.data(), channels, count, has_alpha, kernels));
    const auto planes = std::make_unique<light::Planes>();
    light::split(pixels.data(), channels, count, *planes, kernels);
    const light::Kinds kinds = light::kinds(*planes, count, has_alpha, kernels);
    add(kinds.all_finite);
    add(kinds.all_cover);
    add(kinds.all_opaque);
    if (has_alpha) light::divide_by_alpha(*planes, count, 16, kernels);
    for (int c = 0; c < channels; ++c) {
        const std::array<double, light::kSpan>& plane = (*planes)[static_cast<std::size_t>(c)];
        for (std::size_t i = 0; i < count; ++i)
            add(std::isnan(plane[i]) ? std::numeric_limits<double>::quiet_NaN() : plane[i]);
    }
    if (!is_plain) return bytes;
    const Matrix3 matrix = {{{0.6, 0.3, 0.1}, {0.2, 0.7, 0.1}, {0.05, 0.05, 0.9}}};
    std::array<double, light::kSpan> luminance{};
    for (const Matrix3* to_rec709 : {static_cast<const Matrix3*>(nullptr), &matrix}) {
        const light::Weighing weighing = {to_rec709, 1e-3};
        add_sums(light::add_up(pixels.data(), channels, count, weighing, luminance, kernels));
        add_sums(light::add_up(*planes, count, weighing, luminance, kernels));
        for (std::size_t i = 0; i < count; ++i)
            add(luminance[i]);
    }
    return bytes;
}

TEST(MeteringKernels, GiveTheSameBitsOnEveryInstructionSet) {
    const light::Kernels& best = light::kernels().front();
    for (const light::Kernels& kernels : light::kernels()) {
        for (const int channels : {3, 4}) {
            for (const std::size_t count : {1, 3, 7, 8, 63, 64, 65, 200, 511, 512}) {
                for (const bool is_plain : {true, false}) {
                    EXPECT_EQ(bytes_of(kernels, channels, count, is_plain) ==
                                  bytes_of(best, channels, count, is_plain),
                              true)
                        << kernels.name << ", " << channels << " channels, " << count
                        << (is_plain ? " plain pixels" : " pixels");
                }
            }
        }
    }
}

TEST(MeteringKernels, SeeEveryPixelThatIsNotPlain) {
    for (const light::Kernels& kernels : light::kernels()) {
        for (const int channels : {3, 4}) {
            constexpr std::size_t kCount = 70;
            const std::vector<float> plain = pixels_of(channels, kCount, true);
            EXPECT_TRUE(light::are_plain(plain.data(), channels, kCount, true, kernels));
            for (std::size_t i = 0; i < plain.size(); ++i) {
                const bool is_alpha = channels == 4 && i % 4 == 3;
                std::vector<float> pixels = plain;
                pixels[i] = is_alpha ? 0.5F : std::numeric_limits<float>::infinity();
                EXPECT_FALSE(light::are_plain(pixels.data(), channels, kCount, true, kernels))
                    << kernels.name << ", number " << i;
                EXPECT_EQ(light::are_plain(pixels.data(), channels, kCount, false, kernels),
                          is_alpha)
                    << kernels.name << ", number " << i;
            }
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
