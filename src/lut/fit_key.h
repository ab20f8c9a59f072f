// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// For the keys of cached_numbers(): what the double reference makes of 8192 colors, which tells
/// one pipeline from another. Another processor or library of mathematical functions may give
/// another key.
[[nodiscard]] TONEWRIGHT_API std::string key_of_pipeline(const Pipeline& pipeline);

/// The same for primaries.
[[nodiscard]] TONEWRIGHT_API std::string key_of_primaries(const Primaries& primaries);

TONEWRIGHT_NAMESPACE_END
