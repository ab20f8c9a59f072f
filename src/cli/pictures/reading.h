// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>
#include <string_view>

#include "cli/picture_options.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// read_picture() of the tasks, which prints its messages.
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path, const PictureChoice& choice = {},
                                          std::string_view input = kAutoInput);

TONEWRIGHT_NAMESPACE_END
