// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One file of a generated set, such as a config with its tables.
struct GeneratedFile {
    std::string path;  // relative to the set's folder
    std::string contents;
};

/// Writes a set into a folder (created if missing), the file named `last` at the end, and then
/// removes the files that the folder's previous MANIFEST.csv named and the new set no longer has.
/// Each file is replaced as a whole.
/// @throws FileError  naming the path and the reason.
TONEWRIGHT_API void write_generated_files(const std::string& folder,
                                          const std::vector<GeneratedFile>& files,
                                          std::string_view last);

TONEWRIGHT_NAMESPACE_END
