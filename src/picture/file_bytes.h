// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Passes all bytes to the system.
/// @throws FileError  with the system's reason and its number
void write_all(int file, const void* bytes, std::size_t count);

TONEWRIGHT_NAMESPACE_END
