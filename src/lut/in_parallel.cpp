// SPDX-License-Identifier: Apache-2.0
#include "lut/in_parallel.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN

void in_parallel(std::size_t count, unsigned thread_count,
                 const std::function<void(std::size_t)>& f) {
    if (thread_count == 0) thread_count = std::max(1U, std::thread::hardware_concurrency());
    std::atomic<std::size_t> next = 0;
    const auto run = [&] {
        for (std::size_t i = next++; i < count; i = next++)
            f(i);
    };
    std::vector<std::future<void>> others;  // which wait for their threads when they are destroyed
    for (std::size_t t = 1; t < std::min<std::size_t>(thread_count, count); ++t)
        others.push_back(std::async(std::launch::async, run));
    run();
    for (std::future<void>& other : others)
        other.get();
}

TONEWRIGHT_NAMESPACE_END
