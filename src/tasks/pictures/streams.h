// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Copies a picture from a stream into a file, because readers seek.
/// @param base        path of the file without its extension, which follows from the contents
/// @param max_pixels  limits the length of the picture
/// @returns  the path of the file
/// @throws FileError  nothing to read, too much for the pixels, an unknown format; cannot write
[[nodiscard]] std::string save_stream(std::FILE* stream, const std::string& base,
                                      double max_pixels);

/// @throws FileError  there is no such file, or the stream cannot be written
void copy_to_stream(const std::string& path, std::FILE* stream);

TONEWRIGHT_NAMESPACE_END
