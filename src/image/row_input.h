// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>

#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A reader of rows as one of OpenImageIO's readers. It is open.
/// @param format  OpenImageIO's name of the format, a literal
[[nodiscard]] std::unique_ptr<OIIO::ImageInput> row_input(std::unique_ptr<RowReader> rows,
                                                          const char* format);

TONEWRIGHT_NAMESPACE_END
