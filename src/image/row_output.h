// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>

#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A writer of rows as one of OpenImageIO's writers. It is open, and takes rows from the first to
/// the last.
/// @param format  OpenImageIO's name of the format, a literal
[[nodiscard]] std::unique_ptr<OIIO::ImageOutput> row_output(std::unique_ptr<RowWriter> rows,
                                                            const char* format);

TONEWRIGHT_NAMESPACE_END
