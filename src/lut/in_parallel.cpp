// SPDX-License-Identifier: Apache-2.0
#include "lut/in_parallel.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Threads that in_parallel() has started, minus those that wait for others.
std::atomic<int> helper_count = 0;

/// Changes the count during its lifetime.
class Counted {
  public:
    explicit Counted(int by) : by_(by) { helper_count += by_; }
    ~Counted() { helper_count -= by_; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;

  private:
    int by_;
};

/// Counts a thread until its work is done.
template <class Work>
std::future<void> start_helper(const Work& work) {
    auto counted = std::make_unique<Counted>(1);
    return std::async(std::launch::async, [&work, counted = std::move(counted)]() mutable {
        const auto until_done = std::move(counted);
        work();
    });
}

}  // namespace

void in_parallel(std::size_t count, unsigned thread_count,
                 const std::function<void(std::size_t)>& f) {
    const bool takes_idle = thread_count == 0;
    if (takes_idle) thread_count = std::max(1U, std::thread::hardware_concurrency());
    std::atomic<std::size_t> next = 0;
    const auto run = [&] {
        for (std::size_t i = next++; i < count; i = next++)
            f(i);
    };
    std::vector<std::future<void>> others;  // which wait for their threads when they are destroyed
    try {
        for (std::size_t t = 1; t < std::min<std::size_t>(thread_count, count); ++t) {
            if (takes_idle && helper_count + 1 >= static_cast<int>(thread_count)) break;
            others.push_back(start_helper(run));
        }
    } catch (const std::system_error&) {
        // No more threads are available: the existing ones do the work.
    }
    run();
    const Counted waits(others.empty() ? 0 : -1);
    for (std::future<void>& other : others)
        other.get();
}

TONEWRIGHT_NAMESPACE_END
