// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A view of contiguous elements: the subset of std::span that C++17 programs need here.
template <class T>
class Span {
  public:
    constexpr Span() noexcept = default;
    constexpr Span(T* data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N>
    constexpr Span(T (&array)[N]) noexcept  // NOLINT(google-explicit-constructor): a view
        : data_(array), size_(N) {}
    /// Views a vector, an array or a std::span.
    template <class Container, class = std::enable_if_t<std::is_convertible_v<
                                   decltype(std::declval<const Container&>().data()), T*>>>
    constexpr Span(const Container& c) noexcept  // NOLINT(google-explicit-constructor): a view
        : data_(c.data()), size_(c.size()) {}

    [[nodiscard]] constexpr T* data() const noexcept { return data_; }
    [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
    [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
    [[nodiscard]] constexpr T* begin() const noexcept { return data_; }
    [[nodiscard]] constexpr T* end() const noexcept { return data_ + size_; }
    [[nodiscard]] constexpr T& operator[](std::size_t i) const noexcept { return data_[i]; }

  private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

TONEWRIGHT_NAMESPACE_END
