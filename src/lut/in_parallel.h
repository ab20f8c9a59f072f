// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <thread>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Runs f(0) ... f(count - 1), each once, on threads that take the next one when they are free.
/// What one throws is thrown when all threads have ended.
/// @param thread_count  0: as many as there are cores
template <class F>
void in_parallel(std::size_t count, unsigned thread_count, const F& f) {
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
