// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Options of tonemap() by name. @see set_tonemap_argument()
using Arguments = std::map<std::string, std::string>;

/// Result of a name such as "shot.exr.tonewright?op=hable".
struct Request {
    std::string picture;
    Arguments arguments;
};

/// @throws Error, FileError
[[nodiscard]] Request parse_request(const std::string& name);

TONEWRIGHT_NAMESPACE_END
