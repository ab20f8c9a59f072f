// SPDX-License-Identifier: Apache-2.0
#include "picture/png_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "unit/noise.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Bytes = std::vector<std::uint8_t>;

/// W3C PNG (third edition), 9.2: a filter's prediction of a byte from its neighbors.
int predicted(int filter, int left, int above, int above_left) {
    if (filter == 0) return 0;
    if (filter == 1) return left;
    if (filter == 2) return above;
    if (filter == 3) return (left + above) / 2;
    const int p = left + above - above_left;
    const std::array<int, 3> distances = {std::abs(p - left), std::abs(p - above),
                                          std::abs(p - above_left)};
    if (distances[0] <= distances[1] && distances[0] <= distances[2]) return left;
    return distances[1] <= distances[2] ? above : above_left;
}

Bytes filtered(const Bytes& row, const Bytes& above, std::size_t pixel_bytes) {
    Bytes best;
    int least = std::numeric_limits<int>::max();
    for (int filter = 0; filter < 5; ++filter) {
        Bytes result = {static_cast<std::uint8_t>(filter)};
        int sum = 0;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const bool is_first = i < pixel_bytes;
            const int left = is_first ? 0 : row[i - pixel_bytes];
            const int above_left = is_first ? 0 : above[i - pixel_bytes];
            const auto byte =
                static_cast<std::uint8_t>(row[i] - predicted(filter, left, above[i], above_left));
            result.push_back(byte);
            sum += byte < 128 ? byte : 256 - byte;
        }
        if (sum >= least) continue;
        least = sum;
        best = result;
    }
    return best;
}

/// With zeros before it, and other bytes behind it.
Bytes surrounded(const Bytes& row) {
    Bytes all(kPngLead + row.size() + kPngSlack, 0xA5);
    std::fill_n(all.begin(), kPngLead, std::uint8_t{0});
    std::copy(row.begin(), row.end(), all.begin() + kPngLead);
    return all;
}

std::uint8_t noise_byte(std::size_t i) {
    return static_cast<std::uint8_t>(255 * noise(static_cast<std::uint32_t>(i)));
}

TEST(PngKernels, FilterHasTheLeastSumOfDifferences) {
    // From constant rows over smooth ones to noise, so that each filter is the best one somewhere.
    std::array<int, 5> counts{};
    for (const PngKernels& kernels : png_kernels()) {
        for (std::size_t round = 0; round < 400; ++round) {
            const std::size_t bytes = 1 + round * 37 % 331;
            const std::size_t pixel_bytes = std::array{1U, 2U, 3U, 4U, 6U, 8U}[round % 6];
            Bytes row(bytes);
            Bytes above(bytes);
            for (std::size_t i = 0; i < bytes; ++i) {
                const std::size_t at = 1000 * round + i;
                const int range = 1 + static_cast<int>(round * 7 % 255);
                const int slope = static_cast<int>(i * (round % 5));
                above[i] = static_cast<std::uint8_t>(slope + noise_byte(at) % range);
                const int base =
                    std::array<int, 4>{0, above[i], slope, i > 8 ? row[i - 8] : 9}[round / 6 % 4];
                row[i] = static_cast<std::uint8_t>(base + noise_byte(at + 500) % (1 + range / 8));
            }
            const Bytes padded_row = surrounded(row);
            const Bytes padded_above = surrounded(above);
            Bytes result(bytes + 1);
            kernels.filter(&padded_row[kPngLead], &padded_above[kPngLead], bytes, pixel_bytes,
                           result.data());
            ASSERT_EQ(result, filtered(row, above, pixel_bytes))
                << kernels.name << ", " << bytes << " bytes, " << pixel_bytes << " a pixel";
            ++counts.at(result[0]);
        }
    }
    for (const int count : counts)
        EXPECT_GT(count, 0);
}

TEST(PngKernels, CodesAreTheNearest) {
    std::vector<float> values = {0,     1,    -1, 2, 0.5F, std::nanf(""), 0x1.fffffep-2F / 255,
                                 1e30F, -0.0F};
    for (int code = 0; code < 255; ++code) {
        const float middle = (static_cast<float>(code) + 0.5F) / 255;
        values.insert(values.end(),
                      {middle, std::nextafter(middle, 0.0F), std::nextafter(middle, 1.0F)});
    }
    for (std::uint32_t i = 0; i < 1000; ++i)
        values.push_back(noise(i));
    for (const PngKernels& kernels : png_kernels()) {
        Bytes bytes(values.size());
        Bytes pairs(2 * values.size());
        kernels.to_codes_8(values.data(), bytes.data(), values.size());
        kernels.to_codes_16(values.data(), pairs.data(), values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            // The product is rounded to a float, as in OpenImageIO; std::round() takes ties up.
            const auto code = [&](float most) {
                const float scaled = values[i] * most;
                return std::isnan(scaled)
                           ? 0
                           : static_cast<int>(std::round(std::fmin(std::fmax(scaled, 0.0F), most)));
            };
            ASSERT_EQ(bytes[i], code(255)) << kernels.name << " " << values[i];
            ASSERT_EQ(256 * pairs[2 * i] + pairs[2 * i + 1], code(65535))
                << kernels.name << " " << values[i];
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
