// SPDX-License-Identifier: Apache-2.0
#include "lut/in_parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(InParallel, RunsEachOnce) {
    for (const unsigned threads : {0U, 1U, 3U}) {
        std::vector<std::atomic<int>> runs(1000);
        in_parallel(runs.size(), threads, [&](std::size_t i) { ++runs[i]; });
        EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](const auto& n) { return n == 1; }))
            << threads;
    }
}

TEST(InParallel, NestedThreadsAreNoMoreThanCores) {
    const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    std::atomic<int> at_work = 0;
    std::atomic<int> most = 0;
    std::atomic<int> runs = 0;
    in_parallel(5, 0, [&](std::size_t) {
        in_parallel(8, 0, [&](std::size_t) {
            const int now = ++at_work;
            int known = most;
            while (now > known && !most.compare_exchange_weak(known, now)) {
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            --at_work;
            ++runs;
        });
    });
    EXPECT_EQ(runs, 5 * 8);
    EXPECT_LE(most, cores);
}

/// Each of two waits for the other, a fifth of a second.
bool meet() {
    std::atomic<int> waits = 0;
    std::atomic<bool> is_met = false;
    in_parallel(2, 0, [&](std::size_t) {
        if (++waits == 2) is_met = true;
        const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
        while (!is_met && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (!is_met) --waits;
    });
    return is_met;
}

bool meet_in_the_end() {
    for (int attempt = 0; attempt < 20; ++attempt) {
        if (meet()) return true;
    }
    return false;
}

TEST(InParallel, NestedCallsTakeACoreThatIsIdle) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
    bool is_taken = false;
    in_parallel(2, 0, [&](std::size_t i) {
        if (i == 0) return;  // its core is there for the other's
        is_taken = meet_in_the_end();
    });
    EXPECT_TRUE(is_taken);
}

TEST(InParallel, RethrowsAndCountsThreadsAfterwards) {
    for (int round = 0; round < 3; ++round) {
        EXPECT_THROW(in_parallel(100, 0, [](std::size_t) { throw Error("x: y is z"); }), Error);
    }
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
    EXPECT_TRUE(meet_in_the_end());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
