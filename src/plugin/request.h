// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

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

/// The error of an operator's file, without its contents: the query may come from one who cannot
/// read the file, and name any file that the host can read. The path and the line stay. The command
/// line shows the reader's own message.
/// @param message  the reader's, `[<operation>: ]<path>[:<line>]: <fault>`
/// @param named    texts of the query, of which one has the path
[[nodiscard]] std::string without_contents(std::string_view message,
                                           const std::vector<std::string>& named);

TONEWRIGHT_NAMESPACE_END
