// SPDX-License-Identifier: Apache-2.0
#include "base/bounded_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <exception>
#include <latch>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(BoundedCache, ThreadsThatAskForOneKeyShareOneComputation) {
    BoundedCache<int, int> cache(4);
    std::atomic<int> made = 0;
    std::latch first_computes(1);
    std::latch others_asked(7);
    std::vector<int> seen(8);
    const auto ask = [&](std::size_t thread) {
        if (thread > 0) {
            first_computes.wait();
            others_asked.count_down();
        }
        seen[thread] = *cache.get(3, [&] {
            ++made;
            first_computes.count_down();
            others_asked.wait();  // all others are about to ask, or wait already
            return 30;
        });
    };
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < 8; ++i)
            threads.emplace_back(ask, i);
    }
    EXPECT_EQ(made, 1);
    EXPECT_EQ(seen, std::vector<int>(8, 30));
}

TEST(BoundedCache, AComputationDoesNotBlockOtherKeys) {
    // Under a lock, this would never end: each value is finished only when the other one has begun.
    BoundedCache<int, int> cache(2);
    std::latch both_compute(2);
    const auto ask = [&](int key) {
        return *cache.get(key, [&] {
            both_compute.arrive_and_wait();
            return 10 * key;
        });
    };
    int other = 0;
    {
        const std::jthread thread([&] { other = ask(2); });
        EXPECT_EQ(ask(1), 10);
    }
    EXPECT_EQ(other, 20);
}

TEST(BoundedCache, DropsTheLeastRecentlyUsedKey) {
    BoundedCache<std::string, std::string> cache(2);
    int made = 0;
    const auto ask = [&](const std::string& key) {
        return *cache.get(key, [&] {
            ++made;
            return key + key;
        });
    };
    EXPECT_EQ(ask("a"), "aa");
    EXPECT_EQ(ask("b"), "bb");
    EXPECT_EQ(ask("a"), "aa");
    EXPECT_EQ(made, 2);
    EXPECT_EQ(ask("c"), "cc");  // drops b
    EXPECT_EQ(cache.size(), 2U);
    EXPECT_EQ(ask("a"), "aa");
    EXPECT_EQ(made, 3) << "a was kept";
    EXPECT_EQ(ask("b"), "bb");
    EXPECT_EQ(made, 4) << "b was dropped";
    for (int i = 0; i < 100; ++i)
        (void)ask(std::to_string(i));
    EXPECT_EQ(cache.size(), 2U);
}

TEST(BoundedCache, AValueOutlivesItsEntry) {
    BoundedCache<int, std::string> cache(1);
    const auto first = cache.get(1, [] { return std::string("first"); });
    (void)cache.get(2, [] { return std::string("second"); });
    EXPECT_EQ(*first, "first");
    // Dropped while it is computed: the caller gets its value all the same.
    EXPECT_EQ(*cache.get(3,
                         [&] {
                             (void)cache.get(4, [] { return std::string("fourth"); });
                             return std::string("third");
                         }),
              "third");
    EXPECT_EQ(cache.size(), 1U);
}

TEST(BoundedCache, AnExceptionIsNotKept) {
    BoundedCache<int, int> cache(2);
    std::latch computes(1);
    std::latch waits(1);
    const auto fail = [&]() -> int {
        computes.count_down();
        waits.wait();
        throw std::runtime_error("no value");
    };
    // Both threads have the same exception. The thread sanitizer does not see libstdc++ count them,
    // so it has to live until they have joined.
    std::exception_ptr thrown;
    {
        const std::jthread other([&] {
            computes.wait();
            waits.count_down();
            // Either waits for the computation that fails, or computes the value itself.
            try {
                EXPECT_EQ(*cache.get(1, [] { return 7; }), 7);
            } catch (const std::runtime_error& e) {
                EXPECT_STREQ(e.what(), "no value");
            }
        });
        try {
            (void)cache.get(1, fail);
        } catch (const std::runtime_error&) {
            thrown = std::current_exception();
        }
    }
    EXPECT_TRUE(thrown);
    EXPECT_EQ(*cache.get(1, [] { return 7; }), 7) << "computed again";
    EXPECT_EQ(cache.size(), 1U);
}

TEST(BoundedCache, HoldsValuesThatCannotMove) {
    BoundedCache<int, std::atomic<int>> cache(1);
    EXPECT_EQ(cache.get(1, [] { return std::atomic<int>(5); })->load(), 5);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
