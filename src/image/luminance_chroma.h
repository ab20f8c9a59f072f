// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "picture/row_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Opens an OpenEXR file of luminance and chroma (Y, RY, BY), which OpenImageIO refuses, by
/// OpenEXR's own reader: R, G, B and alpha as half floats, associated.
/// @returns  null for other files
/// @throws FileError  damaged: the reason, without the name of the file
[[nodiscard]] std::unique_ptr<RowReader> open_luminance_chroma(const std::string& path);

TONEWRIGHT_NAMESPACE_END
