// SPDX-License-Identifier: Apache-2.0
#include "picture/span_runner.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::TypeDesc;

PictureSpec spec_of(std::vector<std::string> names, int alpha = -1) {
    PictureSpec spec;
    spec.width = spec.height = 1;
    spec.nchannels = static_cast<int>(names.size());
    spec.channelnames = std::move(names);
    spec.alpha_channel = alpha;
    spec.format = TypeDesc::FLOAT;
    return spec;
}

/// Squares colors, so that a division by alpha before it shows.
PictureMap square() {
    return {.run =
                [](const auto& in, std::ptrdiff_t in_stride, const auto& out,
                   std::ptrdiff_t out_stride, std::size_t count) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(count); ++i) {
                            const float x = in[c][i * in_stride];
                            out[c][i * out_stride] = x * x;
                        }
                    }
                },
            .label = "square"};
}

/// Runs pixels of floats.
template <class To>
std::vector<To> run(const PictureMap& map, const ChannelPlan& plan, const std::vector<float>& from,
                    int channels, TypeDesc type, int result_channels) {
    SpanRunner runner(map, plan, {TypeDesc::FLOAT, channels}, {type, result_channels}, false);
    const std::size_t n = from.size() / static_cast<std::size_t>(channels);
    std::vector<To> to(n * static_cast<std::size_t>(result_channels));
    runner.run({reinterpret_cast<const std::byte*>(from.data()),
                channels * static_cast<std::ptrdiff_t>(sizeof(float))},
               0, reinterpret_cast<std::byte*>(to.data()),
               result_channels * static_cast<std::ptrdiff_t>(sizeof(To)), n);
    return to;
}

TEST(SpanRunner, ColorIsDividedByAlphaAndMultipliedAgain) {
    const PictureMap map = square();
    const PictureSpec spec = spec_of({"R", "G", "B", "A", "Z"}, 3);
    ChannelPlan plan = plan_channels(spec, map, 0);
    plan_copies(plan, 5, 5);
    EXPECT_EQ(plan.alpha, 3);
    // (0.25 / 0.5)^2 0.5; alpha 0 is taken as it is; other channels are copied.
    const std::vector<float> from = {0.25F, 0.5F, 0, 0.5F, 7, 0.5F, 0.25F, 2, 0, 8};
    const std::vector<float> expected = {0.125F, 0.5F, 0, 0.5F, 7, 0.25F, 0.0625F, 4, 0, 8};
    EXPECT_EQ(run<float>(map, plan, from, 5, TypeDesc::FLOAT, 5), expected);
    PictureMap plain = map;
    plain.unpremult = TonemapOptions::Unpremult::no;
    EXPECT_EQ(plan_channels(spec, plain, 0).alpha, -1);
}

TEST(SpanRunner, ResultsHaveAnyType) {
    const PictureMap map = square();
    ChannelPlan plan = plan_channels(spec_of({"R", "G", "B", "Z"}), map, 0);
    plan_copies(plan, 4, 4);
    // OpenImageIO rounds 255 x to the nearest; 1 and above are 255.
    EXPECT_EQ((run<std::uint8_t>(map, plan, {0.5F, 1, 2, 0.4F}, 4, TypeDesc::UINT8, 4)),
              (std::vector<std::uint8_t>{64, 255, 255, 102}));
    // Channels beyond those of the result are left out.
    ChannelPlan less = plan_channels(spec_of({"R", "G", "B", "Z"}), map, 3);
    plan_copies(less, 4, 3);
    EXPECT_EQ((run<float>(map, less, {0.5F, 1, 2, 0.4F}, 4, TypeDesc::FLOAT, 3)),
              (std::vector<float>{0.25F, 1, 4}));
}

TEST(SpanRunner, GrayPicturesStayGrayOrGetThreeChannels) {
    PictureMap map = square();
    const PictureSpec gray = spec_of({"Y", "A"}, 1);
    EXPECT_EQ(error_of([&] { (void)plan_channels(gray, map, 2); }),
              "destination has 2 channels; expected 3 or more: square shows this gray picture in "
              "color");
    ChannelPlan wide = plan_channels(gray, map, 0);
    EXPECT_TRUE(wide.widens());
    plan_copies(wide, 2, 4);
    EXPECT_EQ((run<float>(map, wide, {0.25F, 0.5F}, 2, TypeDesc::FLOAT, 4)),
              (std::vector<float>{0.125F, 0.125F, 0.125F, 0.5F}));
    const PictureSpec result = float_spec(gray, true);
    EXPECT_EQ(result.channelnames, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_EQ(result.alpha_channel, 3);
    map.keeps_gray = true;
    ChannelPlan one = plan_channels(gray, map, 0);
    EXPECT_FALSE(one.widens());
    plan_copies(one, 2, 2);
    EXPECT_EQ((run<float>(map, one, {0.25F, 0.5F}, 2, TypeDesc::FLOAT, 2)),
              (std::vector<float>{0.125F, 0.5F}));
}

TEST(SpanRunner, PixelsOutsideTheDataWindowAreBlack) {
    PictureMap map = square();
    map.run = [](const auto& in, std::ptrdiff_t, const auto& out, std::ptrdiff_t out_stride,
                 std::size_t count) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(count); ++i)
                out[c][i * out_stride] = in[c][i] + 1;
        }
    };
    ChannelPlan plan = plan_channels(spec_of({"R", "G", "B", "A"}, 3), map, 0);
    plan_copies(plan, 4, 4);
    SpanRunner runner(map, plan, {TypeDesc::FLOAT, 4}, {TypeDesc::FLOAT, 4}, false);
    std::array<float, 8> to = {9, 9, 9, 9, 9, 9, 9, 9};
    runner.run({nullptr, 0}, 0, reinterpret_cast<std::byte*>(to.data()), 4 * sizeof(float), 2);
    EXPECT_EQ(to, (std::array<float, 8>{1, 1, 1, 0, 1, 1, 1, 0}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
