// SPDX-License-Identifier: Apache-2.0
#include "picture/pixel_access.h"

#include <OpenImageIO/fmath.h>
#include <OpenImageIO/half.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "picture/half_float.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Numbers of all magnitudes, and halfway between two halves.
std::vector<float> floats() {
    std::vector<float> x;
    for (std::uint64_t bits = 0; bits < 0x100000000; bits += 65521)
        x.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    for (std::uint32_t i = 0; i < 0x7C00; ++i) {
        half a, b;
        a.setBits(static_cast<std::uint16_t>(i));
        b.setBits(static_cast<std::uint16_t>(i + 1));
        const float middle = (static_cast<float>(a) + static_cast<float>(b)) / 2;
        for (const float y : {std::nextafter(middle, 0.0F), middle, std::nextafter(middle, 1e9F)}) {
            x.push_back(y);
            x.push_back(-y);
        }
    }
    return x;
}

/// Calls run() with runs of 1 to 70 numbers, from places that are no multiples of anything.
template <class Run>
void in_runs(std::size_t count, Run run) {
    for (std::size_t begin = 0, n = 1; begin < count; begin += n, n = n % 70 + 1)
        run(begin, std::min(n, count - begin));
}

TEST(PixelAccess, RunsOfHalvesAreThoseOfOpenImageIO) {
    const PixelAccess& access = *pixel_access(OIIO::TypeHalf);
    std::vector<std::uint16_t> halves(65536);
    for (std::size_t i = 0; i < halves.size(); ++i)
        halves[i] = static_cast<std::uint16_t>(i);
    const std::vector<float> x = floats();
    // Ways of a picture's pixels: the usual one, its fallback, and every instruction set.
    struct Way {
        std::string name;
        std::function<bool(const std::uint16_t*, float*, std::size_t)> to_float;
        std::function<bool(const float*, std::uint16_t*, std::size_t)> to_half;
    };
    const auto bytes = [](const auto* p) { return reinterpret_cast<const std::byte*>(p); };
    const auto to_bytes = [](auto* p) { return reinterpret_cast<std::byte*>(p); };
    std::vector<Way> ways = {{"runs",
                              [&](const std::uint16_t* from, float* to, std::size_t n) {
                                  access.run_to_float(bytes(from), to, n);
                                  return true;
                              },
                              [&](const float* from, std::uint16_t* to, std::size_t n) {
                                  access.run_from_float(from, to_bytes(to), n);
                                  return true;
                              }},
                             {"one by one",
                              [&](const std::uint16_t* from, float* to, std::size_t n) {
                                  access.load_float(bytes(from), sizeof(half), to, n);
                                  return true;
                              },
                              [&](const float* from, std::uint16_t* to, std::size_t n) {
                                  access.store_float(from, to_bytes(to), sizeof(half), n);
                                  return true;
                              }}};
    for (const HalfKernels& kernels : half_kernels()) {
        ways.push_back({kernels.name,
                        [&](const std::uint16_t* from, float* to, std::size_t n) {
                            return half_to_float(from, to, n, kernels);
                        },
                        [&](const float* from, std::uint16_t* to, std::size_t n) {
                            return float_to_half(from, to, n, kernels);
                        }});
    }
    for (const Way& way : ways) {
        std::vector<float> result(halves.size(), -7.0F);
        std::vector<std::uint16_t> back(x.size(), 0xFFFF);
        bool is_done = true;
        in_runs(halves.size(), [&](std::size_t begin, std::size_t n) {
            is_done = way.to_float(&halves[begin], &result[begin], n);
        });
        in_runs(x.size(), [&](std::size_t begin, std::size_t n) {
            EXPECT_EQ(way.to_half(&x[begin], &back[begin], n), is_done) << way.name;
        });
        if (!is_done) {
            EXPECT_EQ(result, std::vector<float>(halves.size(), -7.0F)) << way.name;
            EXPECT_EQ(back, std::vector<std::uint16_t>(x.size(), 0xFFFF)) << way.name;
            continue;
        }
        for (std::size_t i = 0; i < halves.size(); ++i) {
            half h;
            h.setBits(halves[i]);
            const auto expected = static_cast<float>(h);
            ASSERT_TRUE(result[i] == expected || (std::isnan(result[i]) && std::isnan(expected)))
                << i << ", " << way.name;
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            const half expected(x[i]);
            half h;
            h.setBits(back[i]);
            ASSERT_TRUE(h.bits() == expected.bits() || (h.isNan() && expected.isNan()))
                << x[i] << ", " << way.name;
        }
    }
}

TEST(PixelAccess, RunsOfIntegersAreTheSameAsOneByOne) {
    const std::vector<float> x = floats();
    for (const OIIO::TypeDesc& type : {OIIO::TypeUInt8, OIIO::TypeUInt16}) {
        const PixelAccess& access = *pixel_access(type);
        std::vector<std::byte> run(x.size() * type.size()), single(run.size());
        access.run_from_float(x.data(), run.data(), x.size());
        access.store_float(x.data(), single.data(), static_cast<std::ptrdiff_t>(type.size()),
                           x.size());
        EXPECT_EQ(run, single) << type.c_str();
        std::vector<float> a(x.size()), b(x.size());
        access.run_to_float(run.data(), a.data(), x.size());
        access.load_float(run.data(), static_cast<std::ptrdiff_t>(type.size()), b.data(), x.size());
        EXPECT_EQ(a, b) << type.c_str();
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
