// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string_view>

namespace tonewright {

/// True if `./run test --all` runs the tests, with full sample sets.
inline bool takes_full_counts() {
    const char* value = std::getenv("TONEWRIGHT_TEST_ALL");
    return value && std::string_view(value) == "1";
}

/// Number of samples that a test takes: `full` with `./run test --all`, `quick` otherwise.
template <class Count>
Count count_of(Count full, Count quick) {
    return takes_full_counts() ? full : quick;
}

}  // namespace tonewright
