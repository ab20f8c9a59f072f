// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <future>
#include <iterator>
#include <list>
#include <memory>
#include <mutex>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Values that take long to make, by key. The cache keeps the most recently used keys.
///
/// Threads that need the same key share one computation. Threads that need other keys do not wait,
/// because no value is made under the lock. A value lives as long as its last user, also after the
/// cache has dropped it.
template <class Key, class Value, class Equal = std::equal_to<Key>>
class BoundedCache {
  public:
    using Pointer = std::shared_ptr<const Value>;

    /// @param capacity  largest number of keys, at least 1
    explicit BoundedCache(std::size_t capacity) : capacity_(capacity) {}

    /// The value of the key; make() computes it when the cache does not hold the key.
    ///
    /// @pre     make() does not ask this cache for the same key.
    /// @throws  the exception of make(). It reaches every thread that waits for this value, and is
    ///          not kept: the next call computes the value again.
    template <class Make>
    Pointer get(const Key& key, const Make& make) {
        std::promise<Pointer> promise;
        std::uint64_t id = 0;
        if (const std::shared_future<Pointer> known = find_or_add(key, promise, id); known.valid())
            return known.get();
        try {
            Pointer value(new Value(make()));
            promise.set_value(value);
            return value;
        } catch (...) {
            remove(id);
            promise.set_exception(std::current_exception());
            throw;
        }
    }

    [[nodiscard]] std::size_t size() const {
        const std::lock_guard lock(mutex_);
        return entries_.size();
    }

  private:
    struct Entry {
        Key key;
        std::shared_future<Pointer> value;
        std::uint64_t id;
    };
    using Entries = std::list<Entry>;  // used last first

    /// The value of a known key. Else adds the key with the promise's future, sets `id`, and
    /// returns an invalid future.
    std::shared_future<Pointer> find_or_add(const Key& key, std::promise<Pointer>& promise,
                                            std::uint64_t& id) {
        Entries dropped;  // outlives the lock: destroying a value may take long
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
            return Equal{}(entry.key, key);
        });
        if (found != entries_.end()) {
            entries_.splice(entries_.begin(), entries_, found);
            return found->value;
        }
        id = ++last_id_;
        entries_.push_front({key, promise.get_future().share(), id});
        if (entries_.size() > capacity_)
            dropped.splice(dropped.begin(), entries_, std::prev(entries_.end()));
        return {};
    }

    void remove(std::uint64_t id) {
        Entries dropped;
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(entries_.begin(), entries_.end(),
                                        [&](const Entry& entry) { return entry.id == id; });
        if (found != entries_.end()) dropped.splice(dropped.begin(), entries_, found);
    }

    const std::size_t capacity_;
    mutable std::mutex mutex_;
    Entries entries_;
    std::uint64_t last_id_ = 0;
};

TONEWRIGHT_NAMESPACE_END
