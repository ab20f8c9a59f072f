// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <future>
#include <vector>

namespace tonewright {

/// Runs f(0) ... f(count - 1) on threads; what they throw is thrown.
template <class F>
void in_parallel(std::size_t count, unsigned thread_count, const F& f) {
    const auto run = [&](std::size_t first) {
        for (std::size_t i = first; i < count; i += thread_count)
            f(i);
    };
    std::vector<std::future<void>> others;
    for (std::size_t first = 1; first < std::min<std::size_t>(thread_count, count); ++first)
        others.push_back(std::async(std::launch::async, run, first));
    run(0);
    for (std::future<void>& other : others)
        other.get();
}

}  // namespace tonewright
