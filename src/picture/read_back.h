// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "picture/picture_spec.h"

/// Words for a written file that is read again.
TONEWRIGHT_NAMESPACE_BEGIN

template <class Found, class Expected>
[[nodiscard]] std::string reads_back_with(std::string_view what, const Found& found,
                                          const Expected& expected) {
    return fmt::format("what was written reads back with {} {}; expected {}", what, found,
                       expected);
}

/// The difference in size or channels; empty if there is none.
[[nodiscard]] inline std::string fault_of_shape(int width, int height, int channels,
                                                const PictureSpec& expected) {
    if (width != expected.width || height != expected.height) {
        return reads_back_with("size", fmt::format("{} x {}", width, height),
                               fmt::format("{} x {}", expected.width, expected.height));
    }
    return channels == expected.nchannels
               ? ""
               : reads_back_with("channels", channels, expected.nchannels);
}

TONEWRIGHT_NAMESPACE_END
