// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Hands things from one thread to another, in order.
template <class T>
class BatchQueue {
  public:
    void push(T thing) {
        {
            const std::lock_guard lock(mutex_);
            if (canceled_) return;
            things_.push_back(std::move(thing));
        }
        changed_.notify_one();
    }
    /// Waits for a thing. @returns  nothing when the queue is closed and empty, or canceled.
    std::optional<T> pop() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return closed_ || !things_.empty(); });
        if (things_.empty()) return {};
        T thing = std::move(things_.front());
        things_.pop_front();
        return thing;
    }
    /// Nothing will be pushed any more.
    void close() {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
        }
        changed_.notify_all();
    }
    /// Discards the contents, and everything that comes later.
    void cancel() {
        {
            const std::lock_guard lock(mutex_);
            things_.clear();
            closed_ = true;
            canceled_ = true;
        }
        changed_.notify_all();
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<T> things_;
    bool closed_ = false;
    bool canceled_ = false;
};

TONEWRIGHT_NAMESPACE_END
