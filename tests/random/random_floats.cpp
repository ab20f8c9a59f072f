// SPDX-License-Identifier: Apache-2.0
//
// Runs random floats of all bit patterns (denormals, infinities and NaN, too) through the SIMD
// engine and through the reference, and compares their difference with the operator's bound.
//
//   tonewright_random COLORS SEED OPERATOR...
//
// Half of the colors have three random bit patterns: exponents are uniform, and most colors are
// outside of all gamuts. The other half is between 2^-20 and 2^16, without sign. The same seed
// gives the same colors on every machine, whatever the number of threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

using namespace tonewright;  // NOLINT(google-build-using-namespace): this is a program
namespace {

constexpr std::size_t kBlock = 4096;

struct Findings {
    double worst = 0;
    std::array<float, 3> color{};
    std::uint64_t above_bound = 0;
    std::uint64_t not_finite = 0;  // where the reference is
    std::uint64_t compared = 0;    // channels

    void add(const Findings& other) {
        if (other.worst > worst) {
            worst = other.worst;
            color = other.color;
        }
        above_bound += other.above_bound;
        not_finite += other.not_finite;
        compared += other.compared;
    }
};

std::vector<float> colors_of(std::uint64_t seed, std::uint64_t block) {
    SampleRandom random(seed * 0x9E3779B97F4A7C15ULL + block);
    std::vector<float> rgb(3 * kBlock);
    for (std::size_t i = 0; i < kBlock; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint64_t bits = random.bits();
            // From the exponent of 2^-20 on, 36 octaves.
            const auto inside = static_cast<std::uint32_t>((127ULL - 20) << 23) +
                                static_cast<std::uint32_t>((bits >> 32) * (36ULL << 23) >> 32);
            rgb[3 * i + c] =
                std::bit_cast<float>(i % 2 ? static_cast<std::uint32_t>(bits) : inside);
        }
    }
    return rgb;
}

Findings compare(const std::vector<float>& in, const std::vector<float>& out,
                 const std::vector<double>& expected, double bound) {
    Findings found;
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (!std::isfinite(expected[i])) continue;
        ++found.compared;
        const auto actual = static_cast<double>(out[i]);
        if (!std::isfinite(actual)) {
            ++found.not_finite;
            continue;
        }
        const double error =
            std::fabs(actual - expected[i]) / std::max(1.0, std::fabs(expected[i]));
        if (error > bound) ++found.above_bound;
        if (error > found.worst) {
            found.worst = error;
            std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(i / 3 * 3), 3,
                        found.color.begin());
        }
    }
    return found;
}

Findings run(const View& view, std::uint64_t blocks, std::uint64_t seed) {
    const Pipeline pipeline = build_view(view);
    const SimdEngine engine(pipeline, view.op.op->bounds.simd_goal);
    const ReferenceEngine reference(pipeline);
    Findings all;
    std::mutex mutex;
    std::atomic<std::uint64_t> next = 0;
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t) {
        threads.emplace_back([&] {
            std::vector<float> out(3 * kBlock);
            std::vector<double> expected(3 * kBlock);
            Findings own;
            for (std::uint64_t block = next++; block < blocks; block = next++) {
                const std::vector<float> in = colors_of(seed, block);
                engine.run_rgb(in.data(), out.data(), kBlock);
                reference.run_rgb(in.data(), expected.data(), kBlock);
                own.add(compare(in, out, expected, view.op.op->bounds.simd));
            }
            const std::lock_guard lock(mutex);
            all.add(own);
        });
    }
    for (std::thread& thread : threads)
        thread.join();
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        std::fprintf(stderr, "usage: tonewright_random COLORS SEED OPERATOR...\n");
        return 2;
    }
    bool is_within = true;
    try {
        const auto blocks = (static_cast<std::uint64_t>(std::stod(argv[1])) + kBlock - 1) / kBlock;
        const std::uint64_t seed = std::stoull(argv[2]);
        for (int i = 3; i < argc; ++i) {
            const View view = make_view(resolve_operator(argv[i]), "lin_rec709", 0, "srgb");
            const auto begin = std::chrono::steady_clock::now();
            const Findings found = run(view, blocks, seed);
            const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
            std::printf(
                "%s: %llu colors, largest error %.2g (bound %.2g) at %a %a %a; "
                "%llu above it, %llu not finite; %.0f s\n",
                argv[i], static_cast<unsigned long long>(found.compared / 3), found.worst,
                view.op.op->bounds.simd, static_cast<double>(found.color[0]),
                static_cast<double>(found.color[1]), static_cast<double>(found.color[2]),
                static_cast<unsigned long long>(found.above_bound),
                static_cast<unsigned long long>(found.not_finite), time.count());
            std::fflush(stdout);
            is_within = is_within && found.above_bound == 0 && found.not_finite == 0 &&
                        found.compared == 3 * blocks * kBlock;
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 2;
    }
    return is_within ? 0 : 1;
}
