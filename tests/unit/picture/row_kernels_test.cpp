// SPDX-License-Identifier: Apache-2.0
#include "picture/row_kernels.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes noise(std::size_t count) {
    std::mt19937 random(static_cast<unsigned>(count));
    Bytes bytes(count);
    for (std::uint8_t& byte : bytes)
        byte = static_cast<std::uint8_t>(random());
    return bytes;
}

constexpr std::size_t kMost = 200;  // three times the widest vectors, and a rest

/// OpenEXR File Layout, "Predictor": each byte minus the one before it, plus 128.
TEST(RowKernels, DifferencesAreThoseOfOpenExr) {
    for (const RowKernels& kernels : row_kernels()) {
        SCOPED_TRACE(kernels.name);
        for (std::size_t count = 0; count < kMost; ++count) {
            const Bytes bytes = noise(count);
            Bytes expected = bytes;
            for (std::size_t i = 1; i < count; ++i)
                expected[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - 1] + 128);
            Bytes changed = bytes;
            kernels.differences(changed.data(), count);
            ASSERT_EQ(changed, expected) << count;
            kernels.undo_differences(changed.data(), count);
            ASSERT_EQ(changed, bytes) << count;
        }
    }
}

TEST(RowKernels, PairsOfBytesAreSplitAndJoined) {
    for (const RowKernels& kernels : row_kernels()) {
        SCOPED_TRACE(kernels.name);
        for (std::size_t pairs = 0; pairs < kMost; ++pairs) {
            const Bytes bytes = noise(2 * pairs);
            Bytes first(pairs);
            Bytes second(pairs);
            kernels.split_bytes(bytes.data(), pairs, first.data(), second.data());
            for (std::size_t i = 0; i < pairs; ++i) {
                ASSERT_EQ(first[i], bytes[2 * i]) << pairs;
                ASSERT_EQ(second[i], bytes[2 * i + 1]) << pairs;
            }
            Bytes joined(2 * pairs);
            kernels.join_bytes(first.data(), second.data(), pairs, joined.data());
            ASSERT_EQ(joined, bytes) << pairs;
        }
    }
}

TEST(RowKernels, ChannelsAreInterleavedAndSeparated) {
    for (const RowKernels& kernels : row_kernels()) {
        SCOPED_TRACE(kernels.name);
        for (const std::size_t size : {std::size_t{2}, std::size_t{4}}) {
            for (std::size_t channels = 1; channels <= 6; ++channels) {
                for (std::size_t width = 1; width < kMost; width += width < 40 ? 1 : 31) {
                    const Bytes pixels = noise(width * channels * size);
                    std::vector<Bytes> planes(channels, Bytes(width * size));
                    std::vector<std::uint8_t*> to;
                    for (Bytes& plane : planes)
                        to.push_back(plane.data());
                    (size == 2 ? kernels.separate_16 : kernels.separate_32)(pixels.data(), channels,
                                                                            width, to.data());
                    for (std::size_t c = 0; c < channels; ++c) {
                        for (std::size_t x = 0; x < width; ++x) {
                            ASSERT_EQ(std::memcmp(&planes[c][x * size],
                                                  &pixels[(x * channels + c) * size], size),
                                      0)
                                << channels << " " << width;
                        }
                    }
                    const std::vector<const std::uint8_t*> from(to.begin(), to.end());
                    Bytes again(pixels.size());
                    (size == 2 ? kernels.interleave_16 : kernels.interleave_32)(
                        from.data(), channels, width, again.data());
                    ASSERT_EQ(again, pixels) << channels << " " << width;
                }
            }
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
