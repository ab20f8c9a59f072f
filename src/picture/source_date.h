// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// `DateTime` of pictures that have none: that of the environment variable SOURCE_DATE_EPOCH, UTC
/// (reproducible-builds.org/specs/source-date-epoch). Empty: it is not set.
/// @throws Error  it is not a number of seconds since 1970
[[nodiscard]] TONEWRIGHT_API std::string source_date();
/// A date in the form of `DateTime`, UTC.
[[nodiscard]] TONEWRIGHT_API std::string date_text(std::time_t seconds);

TONEWRIGHT_NAMESPACE_END
