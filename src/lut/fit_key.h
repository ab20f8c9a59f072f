// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Key for cached_numbers(): the double reference's results for 8192 colors identify a pipeline. A
/// different processor or math library may give a different key.
[[nodiscard]] TONEWRIGHT_API std::string key_of_pipeline(const Pipeline& pipeline);

/// The same for primaries.
[[nodiscard]] TONEWRIGHT_API std::string key_of_primaries(const Primaries& primaries);

/// Numbers of a 3D LUT with so many nodes a side, for the check of cached_numbers().
[[nodiscard]] inline std::size_t cube_number_count(int edge) {
    const auto n = static_cast<std::size_t>(edge);
    return 3 * n * n * n;
}

TONEWRIGHT_NAMESPACE_END
