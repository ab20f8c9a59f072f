// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ocio/added_record.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A config by the name that a user gave, and the file that this name means.
///
/// OpenColorIO looks for tables beside the name that it opens. Tables therefore lie beside the
/// file, and a link in another folder needs a link to the folder of the tables beside it.
struct ConfigLocation {
    /// The file; the given name unless that is a symbolic link.
    std::string file;
    /// Symbolic links to the file, from the given name on.
    std::vector<std::string> links;
};

/// Follows symbolic links. A name that leads nowhere stays as it is, for the reader to refuse.
[[nodiscard]] ConfigLocation locate_config(const std::string& path);

/// The record of an earlier run, and the name of the config that it was written for.
struct FoundRecord {
    AddedRecord record;
    /// The file. Or a link, because an earlier release wrote the tables beside it.
    std::string config;
};

/// @throws FileError  if there is none, or if it is damaged
[[nodiscard]] FoundRecord read_record(const ConfigLocation& location, const std::string& text);

/// Folders beside the links that must become links to the folder of the tables.
/// @param moved  paths of files that will have been removed before
/// @throws FileError  if another file or folder is there
[[nodiscard]] std::vector<std::string> folders_to_link(const ConfigLocation& location,
                                                       const std::vector<std::string>& moved);

/// Existing links to the folder of the tables beside the links.
[[nodiscard]] std::vector<std::string> linked_folders(const ConfigLocation& location);

TONEWRIGHT_NAMESPACE_END
