// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The 32 bytes of SHA-256 (FIPS 180-4), with which a Content-Security-Policy names a script.
[[nodiscard]] std::string sha256(std::string_view bytes);

TONEWRIGHT_NAMESPACE_END
