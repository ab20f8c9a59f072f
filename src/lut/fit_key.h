// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Key for cached_numbers(): the double reference's results for 8192 colors identify a pipeline. A
/// different processor or math library may give a different key.
[[nodiscard]] TONEWRIGHT_API std::string key_of_pipeline(const Pipeline& pipeline);

/// The same for primaries.
[[nodiscard]] TONEWRIGHT_API std::string key_of_primaries(const Primaries& primaries);

TONEWRIGHT_NAMESPACE_END
