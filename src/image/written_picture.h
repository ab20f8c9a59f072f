// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "picture/file_writer.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Reads the file again.
/// @returns  the difference from what was to be written; empty if there is none
[[nodiscard]] std::string fault_of(const WrittenFile& written);

TONEWRIGHT_NAMESPACE_END
