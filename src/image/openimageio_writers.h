// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/file_writer.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Writers of this program, and OpenImageIO's for all other formats and pictures.
[[nodiscard]] const FormatWriters& all_writers();

TONEWRIGHT_NAMESPACE_END
